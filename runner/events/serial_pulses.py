#!/usr/bin/env python3
"""Pulses on a serial line from the events of a session (README.md beside this file): a byte for each kind of event, and zero again after some
milliseconds, as trigger boxes expect them.

Start it first; it ends with the session:
    python3 serial_pulses.py pulses.sock /dev/ttyUSB0 --width-ms 5
    jnd run my-study.json --study study.sqlite --participant P01 --events pulses.sock
The codes are those of CODES; what is not in it gives no pulse. On standard output it says for each pulse how late it was.
"""
import argparse
import json
import os
import socket
import stat
import sys
import termios
import time
import tty

CODES = {("interval.began", 1): 1, ("interval.began", 2): 2, ("interval.ended", 1): 3, ("interval.ended", 2): 4, ("question", None): 5,
         ("answered", None): 6, ("trial.voided", None): 7, ("trial.began", None): 8, ("session.began", None): 9, ("session.ended", None): 10,
         ("stopped", None): 11}
SPEEDS = {9600: termios.B9600, 57600: termios.B57600, 115200: termios.B115200}


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


def open_line(path, baud):
    line = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(line)
    attributes = termios.tcgetattr(line)
    attributes[4] = attributes[5] = SPEEDS[baud]
    termios.tcsetattr(line, termios.TCSANOW, attributes)
    return line


def main():
    parser = argparse.ArgumentParser(description="pulses on a serial line from the events of jnd run --events")
    parser.add_argument("where", help="the socket to listen on, or - for standard input")
    parser.add_argument("line", help="the serial line, such as /dev/ttyUSB0")
    parser.add_argument("--width-ms", type=float, default=5, help="length of a pulse (default: 5)")
    parser.add_argument("--baud", type=int, choices=sorted(SPEEDS), default=115200)
    options = parser.parse_args()
    line = open_line(options.line, options.baud)
    for text in lines_of(options.where):
        event = json.loads(text)
        code = CODES.get((event["event"], event.get("interval")))
        if code is None:
            continue
        os.write(line, bytes([code]))
        late_ms = 1e3 * (time.monotonic() - event["time_s"])
        time.sleep(1e-3 * options.width_ms)
        os.write(line, bytes([0]))
        print(f"{code} {event['event']} {late_ms:.3f} ms after it", flush=True)
    os.close(line)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(0)
