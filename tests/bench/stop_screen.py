#!/usr/bin/env python3
"""How long a stop takes from its key to the screen: a session on simulated devices in a pseudo-terminal, stopped in
every part of its trials. Prints the milliseconds from the write of the key to the moment at which the red block has been
read and stands on the screen, and beside them those of a letter that is typed and seen, which is what the terminal, the
machine and this script take of it. Asserts nothing.

Usage: stop_screen.py JND [--stops 40]   (Debian: python3-pyte)
"""
import argparse
import json
import os
import pty
import random
import select
import statistics
import subprocess
import sys
import tempfile
import time

import pyte

ROWS, COLUMNS = 24, 80
PARTS = {"announced": None, "presenting": "work: ", "gap": " GAP ", "question": "same   ", "between trials": " NEXT TRIAL "}


class Session:
    def __init__(self, jnd, folder):
        self.screen = pyte.Screen(COLUMNS, ROWS)
        self.stream = pyte.ByteStream(self.screen)
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.environ.update(TERM="linux", LC_ALL="C.UTF-8", LINES=str(ROWS), COLUMNS=str(COLUMNS))
            os.chdir(folder)
            os.execv(jnd, [jnd, "run", "short.json", "--study", "s.sqlite", "--participant", "P01", "--seed", "1", "--bell"])

    def shows(self, text):
        return any(text in line for line in self.screen.display)

    def wait_for(self, text, seconds=10.0):
        """The time at which it is on the screen."""
        end = time.monotonic() + seconds
        while not self.shows(text):
            if time.monotonic() > end:
                sys.exit(f"waited in vain for '{text}'; the screen is\n" + "\n".join(self.screen.display))
            if select.select([self.terminal], [], [], 0.01)[0]:
                self.stream.feed(os.read(self.terminal, 65536))
        return time.monotonic()

    def rest(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.005)[0]:
                self.stream.feed(os.read(self.terminal, 65536))

    def press(self, key):
        began = time.monotonic()
        os.write(self.terminal, key)
        return began


def short_protocol(jnd, folder):
    """The tutorial without what comes before its trials, and with a second for every part of them."""
    path = os.path.join(folder, "short.json")
    subprocess.run([jnd, "new", path, "--from", "tutorial"], check=True, stdout=subprocess.DEVNULL)
    with open(path, encoding="utf-8") as file:
        protocol = json.load(file)
    for key in ("checklist", "instructions", "consent", "practice", "questions", "breaks", "translations"):
        protocol.pop(key, None)
    protocol["trial"].update(explore_s=1, gap_s=1, between_trials_s=1, max_attempts=10)
    protocol["design"].update(trials_per_cell=80)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(protocol, file)


def begin(session):
    """To the first trial's announcement, past what was found about the machine."""
    session.wait_for("STOP")
    while not session.shows("participant is ready"):
        session.rest(1.3)
        session.press(b" ")
        session.rest(0.3)


def stop_in(session, part, chance):
    """Seconds from the key to the screen."""
    session.rest(1.3)  # so that no key counts as held down
    if part != "announced":
        session.press(b" ")
        if part == "between trials":
            session.wait_for("same   ")
            session.press(b"s")
        session.wait_for(PARTS[part])
    session.rest(chance.uniform(0.02, 0.4))
    began = session.press(b"x")
    return session.wait_for("STOPPED (key)") - began


def clear(session):
    """Seconds from a letter of the reason to the screen."""
    session.rest(0.3)
    session.press(b"c")
    session.wait_for("the matter")
    session.rest(1.3)
    began = session.press(b"w")
    seconds = session.wait_for("> w") - began if session.shows("> ") else session.wait_for(": w") - began
    session.press(b"\r")
    session.wait_for("participant is ready")
    return seconds


def summary(values):
    ordered = sorted(values)
    high = ordered[min(len(ordered) - 1, round(0.95 * (len(ordered) - 1)))]
    return (f"median {1000 * statistics.median(ordered):6.1f} ms   95 % {1000 * high:6.1f} ms   "
            f"longest {1000 * ordered[-1]:6.1f} ms   of {len(ordered)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("jnd")
    parser.add_argument("--stops", type=int, default=40)
    options = parser.parse_args()
    jnd, chance = os.path.abspath(options.jnd), random.Random(1)
    times, letters = {}, []
    with tempfile.TemporaryDirectory() as folder:
        short_protocol(jnd, folder)
        session = Session(jnd, folder)
        begin(session)
        for number in range(options.stops):
            part = list(PARTS)[number % len(PARTS)]
            times.setdefault(part, []).append(stop_in(session, part, chance))
            letters.append(clear(session))
        os.kill(session.pid, 15)
        os.waitpid(session.pid, 0)
    for part, values in times.items():
        print(f"stop, {part:<15} {summary(values)}")
    stops = [value for values in times.values() for value in values]
    print(f"stop, anywhere        {summary(stops)}")
    print(f"a letter that is typed {summary(letters)}")
    print(f"medians, stop by letter: {statistics.median(stops) / statistics.median(letters):.1f}")


if __name__ == "__main__":
    main()
