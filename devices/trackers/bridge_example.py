#!/usr/bin/env python3
"""Tells jnd where the fingers are: the example to start from with a vendor's tracking SDK.

Put your SDK's calls in place of `Sdk`, and name this program in the rig file:
    "tracker": {"command": ["python3", "bridge_example.py"]}
The format is in README.md beside this file. Try it alone first: python3 bridge_example.py | head
"""
import math
import sys
import time


class Sdk:
    """Stands for the vendor's: two fingertips that press a ball of 40 mm radius about once a second, at 200 Hz."""

    def frames(self):
        while True:
            now = time.monotonic()
            reach = 0.043 + 0.008 * math.cos(2 * math.pi * now)  # m from the origin
            half = math.sqrt(0.5)  # a quarter turn about y: the device's z axis, out of the nail, along x
            yield now, {"thumb": ((-reach, 0, 0), (half, 0, -half, 0)), "index": ((reach, 0, 0), (half, 0, half, 0))}
            time.sleep(0.005)


def main():
    # clock=monotonic: time.monotonic() of this very machine, read when the frame was taken. Where the SDK stamps frames
    # with a clock of its own, write clock=source and its seconds; jnd then takes the shortest delay for none.
    print("jnd-poses 1 units=m clock=monotonic", flush=True)
    number = 0
    for when, fingers in Sdk().frames():
        for finger in ("thumb", "index"):
            pose = fingers.get(finger)
            if pose is None:  # not seen: say so, rather than repeating the last pose
                print(f"{finger} {when:.6f} lost n={number}")
            else:
                (x, y, z), (qw, qx, qy, qz) = pose
                print(f"{finger} {when:.6f} {x:.6f} {y:.6f} {z:.6f} {qw:.8f} {qx:.8f} {qy:.8f} {qz:.8f} n={number}")
            number = (number + 1) % 2**32
        sys.stdout.flush()  # every frame, at once: a pose in a buffer grows old


if __name__ == "__main__":
    try:
        main()
    except (BrokenPipeError, KeyboardInterrupt):
        sys.exit(0)
