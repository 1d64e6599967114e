#!/usr/bin/env python3
"""Markers of the Lab Streaming Layer from the events of a session (README.md beside this file).

Start it first; it ends with the session:
    python3 lsl_markers.py markers.sock --file markers.csv
    jnd run my-study.json --study study.sqlite --participant P01 --events markers.sock
The next session's markers come behind these, unless they get a file of their own. With pylsl installed the markers are a stream of type "Markers"
too; without it, only the file is written. A marker is the event's name with what tells it apart: "trial.began:5", "interval.began:1".
"""
import argparse
import json
import os
import socket
import stat
import sys

try:
    import pylsl
except ImportError:
    pylsl = None

HEADER = "time_s,marker\n"


def remove_socket(where):
    """Takes away what a run before has left there, and never anything else."""
    try:
        if not stat.S_ISSOCK(os.lstat(where).st_mode):
            sys.exit(f"{where}: is there already, and is no socket: give another name")
        os.unlink(where)
    except FileNotFoundError:
        pass


def lines_of(where):
    """The lines of one session, from its connection to a socket that is made here; "-": from standard input."""
    if where == "-":
        yield from sys.stdin
        return
    remove_socket(where)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listening:
        listening.bind(where)
        os.chmod(where, 0o600)
        listening.listen(1)
        print(f"waits at {where}", flush=True)
        host, _ = listening.accept()
        remove_socket(where)
    with host, host.makefile("r", encoding="utf-8") as lines:
        yield from lines


def marker_of(event):
    detail = event.get("trial", event.get("interval"))
    return event["event"] if detail is None else f"{event['event']}:{detail}"


def markers_file(path):
    """Open at its end: a new file, or one of markers. A line of it at once: what was marked is there whatever happens."""
    file = open(path, "a+", encoding="utf-8", errors="replace", buffering=1)
    file.seek(0)
    header = file.readline(len(HEADER))
    if header not in ("", HEADER):
        sys.exit(f"{path}: is there already, and holds no markers: give another --file")
    if not header:
        file.write(HEADER)
    return file


def main():
    parser = argparse.ArgumentParser(description="LSL markers from the events of jnd run --events")
    parser.add_argument("where", help="the socket to listen on, or - for standard input")
    parser.add_argument("--file", default="markers.csv", help="the CSV file of all markers (default: markers.csv)")
    parser.add_argument("--name", default="jnd", help="of the stream (default: jnd)")
    options = parser.parse_args()
    outlet = None
    if pylsl is not None:
        outlet = pylsl.StreamOutlet(pylsl.StreamInfo(options.name, "Markers", 1, 0, "string", f"{options.name}-{os.getpid()}"))
    with markers_file(options.file) as file:
        for line in lines_of(options.where):
            event = json.loads(line)
            marker = marker_of(event)
            file.write(f"{event['time_s']:.9f},{marker}\n")
            if outlet is not None:  # whose clock, pylsl.local_clock(), is CLOCK_MONOTONIC on Linux, too
                outlet.push_sample([marker], event["time_s"])


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(0)
