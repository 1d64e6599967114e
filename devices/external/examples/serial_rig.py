#!/usr/bin/env python3
"""A rig behind a serial line: a microcontroller that closes the loop itself, and jnd. Start from this with an Arduino or the
like; the firmware needs no more than three lines of text:

    to it      r 500        render a stiffness of 500 N/m
               0            no force
    from it    d F X Y      at least 50 times a second: depth X (m) and force Y (N) as measured; F is 1 while it renders

    {"external": {"command": ["python3", "serial_rig.py", "/dev/ttyACM0", "--max", "800"]}}"""
import argparse
import os
import select
import termios
import threading
import time
import tty

from plain_rig import Device, serve

SILENCE_S = 0.1  # of the firmware, which is then at fault


class SerialDevice(Device):
    def __init__(self, path, speed):
        self.file = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file)
        settings = termios.tcgetattr(self.file)
        settings[4] = settings[5] = getattr(termios, f"B{speed}")
        termios.tcsetattr(self.file, termios.TCSANOW, settings)
        self.newest, self.heard = (0.0, 0.0), None
        self.off()
        threading.Thread(target=self.listen, daemon=True).start()
        while self.heard is None:  # hello is said when the firmware is there
            time.sleep(0.01)

    def listen(self):
        text = b""
        while True:
            select.select([self.file], [], [])
            *lines, text = (text + os.read(self.file, 4096)).split(b"\n")
            for line in lines:
                words = line.split()
                if len(words) == 4 and words[0] == b"d":
                    self.newest, self.heard = (float(words[2]), float(words[3])), time.monotonic()

    def begin(self, request):
        os.write(self.file, f"r {request['value']:.3f}\n".encode())

    def step(self, elapsed_s):
        if time.monotonic() - self.heard > SILENCE_S:
            self.off()
            raise SystemExit("the firmware has fallen silent")
        depth, force = self.newest
        return depth > 0, {"depth": depth, "force": force}

    def delivered(self, peaks):
        return peaks["force"] / peaks["depth"]

    def off(self):
        os.write(self.file, b"0\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("path")
    parser.add_argument("--speed", type=int, default=115200)
    parser.add_argument("--min", type=float, default=100, help="of the stiffness, N/m")
    parser.add_argument("--max", type=float, default=1000)
    parser.add_argument("--serial", default="none", help="serial number of the device")
    parser.add_argument("--model", action="store_true", help="what is behind the line is a model")
    options = parser.parse_args()
    serve({"protocol": 1, "name": "Serial rig", "version": "1.0", "serial": options.serial, "model": options.model,
           "answers": False, "quantities": [{"name": "stiffness", "unit": "N/m", "min": options.min, "max": options.max}],
           "parameters": [], "measures": [{"name": "force", "unit": "N"}, {"name": "depth", "unit": "m"}]},
          SerialDevice(options.path, options.speed))


if __name__ == "__main__":
    main()
