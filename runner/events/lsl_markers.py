#!/usr/bin/env python3
"""Markers of the Lab Streaming Layer from the events of a session (README.md beside this file).

Start it first; it ends with the session:
    python3 lsl_markers.py markers.sock --file markers.csv
    jnd run my-study.json --study study.sqlite --participant P01 --events markers.sock
With pylsl installed the markers are a stream of type "Markers" too; without it, only the file is written. A marker is the event's name with
what tells it apart: "trial.began:5", "interval.began:1".
"""
import argparse
import json
import os
import socket
import sys

try:
    import pylsl
except ImportError:
    pylsl = None


def lines_of(where):
    """The lines of one session, from its connection to a socket that is made here; "-": from standard input."""
    if where == "-":
        yield from sys.stdin
        return
    if os.path.exists(where):
        os.unlink(where)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listening:
        listening.bind(where)
        os.chmod(where, 0o600)
        listening.listen(1)
        print(f"waits at {where}", flush=True)
        host, _ = listening.accept()
        os.unlink(where)
    with host, host.makefile("r", encoding="utf-8") as lines:
        yield from lines


def marker_of(event):
    detail = event.get("trial", event.get("interval"))
    return event["event"] if detail is None else f"{event['event']}:{detail}"


def main():
    parser = argparse.ArgumentParser(description="LSL markers from the events of jnd run --events")
    parser.add_argument("where", help="the socket to listen on, or - for standard input")
    parser.add_argument("--file", default="markers.csv", help="the CSV file of all markers (default: markers.csv)")
    parser.add_argument("--name", default="jnd", help="of the stream (default: jnd)")
    options = parser.parse_args()
    outlet = None
    if pylsl is not None:
        outlet = pylsl.StreamOutlet(pylsl.StreamInfo(options.name, "Markers", 1, 0, "string", f"{options.name}-{os.getpid()}"))
    # A line of the file at once: what was marked is there whatever happens.
    with open(options.file, "w", encoding="utf-8", buffering=1) as file:
        file.write("time_s,marker\n")
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
