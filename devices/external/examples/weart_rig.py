#!/usr/bin/env python3
"""A WEART TouchDIVER as a rig: a force on one fingertip, through the WEART middleware (text over TCP, port 13031, as the
maker's SDK speaks it: values apart by ":", messages ended by "~"). The middleware takes forces from 0 to 1, and does not
say what they are in newtons, nor what was given. So a certificate of your own is needed: forces that you measured, on this
thimble, and nothing is presented without one.

    {"format": 1, "serial": "TD-0012", "hand": "right", "finger": "index", "calibrated": "2026-03-01",
     "points": [[0, 0], [0.25, 0.9], [0.5, 2.1], [1, 4.3]]}        command, N; both rising

    {"external": {"command": ["python3", "weart_rig.py", "--certificate", "td-0012.json"]}}"""
import argparse
import json
import socket
import sys

from plain_rig import Device, serve


def certificate_from(path):
    """Ends with what is wrong with it."""
    try:
        with open(path, encoding="utf-8") as file:
            certificate = json.load(file)
        points = certificate["points"]
        if certificate["format"] != 1 or certificate["hand"] not in ("left", "right") or \
                certificate["finger"] not in ("thumb", "index", "middle") or not certificate["calibrated"] or \
                not certificate["serial"] or len(points) < 3:
            raise ValueError("format, serial, hand, finger, calibrated and at least three points")
        rising = all(a[0] < b[0] and a[1] < b[1] for a, b in zip(points, points[1:]))
        if not rising or points[0] != [0, 0] or points[-1][0] > 1:
            raise ValueError("points rise from [0, 0] to a command of at most 1")
        return certificate
    except (OSError, KeyError, TypeError, IndexError, ValueError) as error:
        sys.exit(f"no certificate of calibration in {path}: {error}")


class WeartDevice(Device):
    def __init__(self, host, port, certificate):
        self.points = certificate["points"]
        self.place = f"{certificate['hand'].upper()}:{certificate['finger'].upper()}"
        try:
            self.middleware = socket.create_connection((host, port), timeout=5)
        except OSError as error:
            sys.exit(f"the WEART middleware cannot be reached: {error}")
        self.middleware.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.middleware.setblocking(False)
        self.say("StartFromClient")
        self.off()

    def say(self, message):
        self.middleware.sendall(message.encode() + b"~")

    def command_for(self, force_n):
        """Straight between the certificate's points."""
        for (low, low_n), (high, high_n) in zip(self.points, self.points[1:]):
            if low_n <= force_n <= high_n:
                return low + (high - low) * (force_n - low_n) / (high_n - low_n)
        raise ValueError(f"{force_n} N is out of the certificate")

    def begin(self, request):
        self.say(f"force:{self.command_for(request['value']):.6f}:0.000000:0.000000:{self.place}")

    def step(self, elapsed_s):
        """The thimble presses from the beginning to the end: that is the contact. Nothing is measured."""
        try:
            if not self.middleware.recv(65536):  # its tracking, which is not used
                sys.exit("the WEART middleware has closed the connection")
        except BlockingIOError:
            pass
        return True, {}

    def delivered(self, peaks):
        return None  # the middleware does not say

    def off(self):
        self.say(f"stopForce:{self.place}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--certificate", required=True)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=13031)
    parser.add_argument("--model", action="store_true", help="what is behind the middleware is a model")
    options = parser.parse_args()
    certificate = certificate_from(options.certificate)
    serve({"protocol": 1, "name": "WEART TouchDIVER", "version": "1.0", "serial": certificate["serial"],
           "model": options.model, "answers": False,
           "quantities": [{"name": "force", "unit": "N", "min": 0, "max": certificate["points"][-1][1]}],
           "parameters": [], "measures": []}, WeartDevice(options.host, options.port, certificate))


if __name__ == "__main__":
    main()
