"""Starts the program that is tested, for all tests in Python: `python3 SOME_test.py JND [OTHER PROGRAMS] [OPTIONS OF UNITTEST]`.

A test waits for what happens: the end of a program, a text on a terminal, a state. GUARD_S ends only what hangs."""
import csv
import fcntl
import functools
import json
import os
import pathlib
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

GUARD_S = 600  # per wait
FOUND, USAGE, INVALID, DEVICE, STORAGE, STOPPED = 1, 2, 3, 4, 5, 130  # exit statuses, as in runner/terminal/exit_code.h
ROOT = pathlib.Path(__file__).resolve().parents[1]


def argument():
    """Takes the next argument of the test, the path of a program. None: there are no more."""
    return os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else None


JND = argument()
main = unittest.main


def campaign(cases):
    """The number of random cases: JND_CAMPAIGN is a factor, 1 in the gate and larger in tests/long.sh."""
    return max(1, round(cases * float(os.environ.get("JND_CAMPAIGN") or 1)))


def parse(text):
    """Reads JSON; NaN and infinity fail."""
    def refuse(name):
        raise AssertionError(f"{name} stands in {text[:2000]}")
    return json.loads(text, parse_constant=refuse)


class Done(subprocess.CompletedProcess):
    json = property(lambda self: parse(self.stdout))
    lines = property(lambda self: [parse(line) for line in self.stdout.splitlines()])
    said = property(lambda self: self.stdout + self.stderr)


def start(*arguments, program=None, folder=None, env=None, **options):
    """Starts a program and goes on. env: variables beside those of the test; what the program prints comes through pipes."""
    words = [program or JND, *(one if isinstance(one, bytes) else str(one) for one in arguments)]
    given = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "encoding": "utf-8"}
    return subprocess.Popen(words, cwd=folder, env=os.environ | (env or {}), **(given | options))


def run(*arguments, code=0, input=None, **options):
    """Runs a program to its end. code: its exit status, one of several, or None for any; input: text, bytes (its output is bytes, too) or lines."""
    if isinstance(input, (list, tuple)):
        input = "".join(f"{line}\n" for line in input)
    given = {} if input is None else {"stdin": subprocess.PIPE, "encoding": None if isinstance(input, bytes) else "utf-8"}
    with start(*arguments, **(given | options)) as process:
        try:
            out, err = process.communicate(input, GUARD_S)
        except BaseException:
            process.kill()
            raise
    allowed = code if isinstance(code, tuple) else (code,)
    assert code is None or process.returncode in allowed, f"{process.args} ended with {process.returncode}: {out}{err}"
    return Done(process.args, process.returncode, out, err)


def short_protocol(name, path, **sections):
    """Writes a shipped protocol with short trials, which cost the models of devices less; sections: members to change in each."""
    run("new", path, "--from", name)
    protocol = json.loads(pathlib.Path(path).read_text())
    for section in ("assumed", "checklist"):
        protocol.pop(section, None)
    for section, members in {"trial": {"explore_s": 0.5, "gap_s": 0.1, "between_trials_s": 0.1}, **sections}.items():
        protocol[section].update(members)
    pathlib.Path(path).write_text(json.dumps(protocol, indent=1))
    return path


def at_priority(priority, *command):
    """A command at the priority of hardware, where this login may: a device keeps time whatever else the machine does."""
    may = subprocess.run(["chrt", "-f", str(priority), "true"], capture_output=True).returncode == 0
    return ["chrt", "-f", str(priority), *command] if may else [*command]


def until(reached, what="what was waited for", process=None):
    """Waits for a state that nothing announces; fails if the process has ended before."""
    end = time.monotonic() + GUARD_S
    while not reached():
        assert time.monotonic() < end and not (process and process.poll() is not None), f"{what} did not come"
        time.sleep(0.01)


def until_it_handles(number, process):
    """Waits until a program has a handler for a signal."""
    status = pathlib.Path(f"/proc/{process.pid}/status")
    until(lambda: int(re.search(r"SigCgt:\s*(\w+)", status.read_text())[1], 16) >> (number - 1) & 1, f"signal {number}", process)


def kill_within(process, seconds):
    """Kills a program that runs longer; no assertion may rest on how far it has come. Returns whether it was killed, and what it printed."""
    try:
        return False, process.communicate(timeout=seconds)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        return True, process.communicate()[0]


class Terminal:
    """A program on a pseudo-terminal. `text` is all that it has shown."""

    def __init__(self, *arguments, rows=24, columns=80, **options):
        self.file, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.process = start(*arguments, stdin=theirs, stdout=theirs, stderr=theirs, encoding=None, start_new_session=True,
                             preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0), **options)
        os.close(theirs)
        self.shown, self.text = b"", ""

    def until(self, wanted):
        """Reads until a text or a pattern comes, or to the end if that is None. Returns all that was shown."""
        end = time.monotonic() + GUARD_S
        while wanted is None or not (wanted in self.text if isinstance(wanted, str) else wanted.search(self.text)):
            assert select.select([self.file], [], [], max(0, end - time.monotonic()))[0], f"no {wanted!r}: {self.text[-2000:]!r}"
            try:
                data = os.read(self.file, 65536)
            except OSError:  # so a terminal says that the program is gone
                data = b""
            if not data:
                assert wanted is None, f"it ended without {wanted!r}: {self.text[-2000:]!r}"
                return self.text
            self.shown += data
            self.text = self.shown.decode(errors="replace")
        return self.text

    def type(self, text):
        os.write(self.file, text.encode())

    def ends(self, code=0):
        """Reads to the end and checks the exit status. Returns all that was shown."""
        self.until(None)
        os.close(self.file)
        assert self.process.wait(GUARD_S) == code, f"it ended with {self.process.returncode}: {self.text[-2000:]!r}"
        return self.text


def is_memory(folder):
    """Whether a folder is gone when the machine stops."""
    return run("-f", "-c", "%T", folder, program="stat").stdout.strip() in ("tmpfs", "ramfs")


class Case(unittest.TestCase):
    """Each test has an empty folder, in which its programs run."""

    on_disk = False  # for real sessions, which are refused in memory

    def skipTest(self, reason):
        print(f"SKIPPED: {self.id()}: {reason}", file=sys.stderr)
        super().skipTest(reason)

    @functools.cached_property
    def folder(self):
        places = (tempfile.gettempdir(), os.getcwd(), "/var/tmp")
        place = next((place for place in places if not self.on_disk or not is_memory(place)), None)
        if place is None:
            self.skipTest("there is no folder on a disk, and real sessions are refused in memory")
        made = tempfile.TemporaryDirectory(dir=place)
        self.addCleanup(made.cleanup)
        return pathlib.Path(made.name).resolve()

    def jnd(self, *arguments, **options):
        return run(*arguments, **({"folder": self.folder} | options))

    def started(self, *arguments, **options):
        process = start(*arguments, **({"folder": self.folder} | options))
        self.addCleanup(process.__exit__, None, None, None)
        self.addCleanup(process.kill)
        return process

    def read(self, *names):
        return self.folder.joinpath(*names).read_text(encoding="utf-8")

    def write(self, name, content):
        """Writes text, bytes, or an object as JSON. Returns the path."""
        content = content if isinstance(content, (str, bytes, bytearray)) else json.dumps(content)
        (self.folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
        return self.folder / name

    def rows(self, *names):
        """Reads a CSV file: a dictionary per row."""
        return list(csv.DictReader(self.read(*names).splitlines(keepends=True)))

    def says(self, text, *parts):
        for part in parts:
            self.assertIn(part, text)

    def refused(self, done, *parts):
        """Asserts that a program printed a message with these parts and nothing else."""
        self.assertEqual(done.stdout, "")
        self.says(done.stderr, *parts)


class Shared(Case):
    """All tests of the class have one folder, which setUpClass() may fill."""
    jnd, read, write, rows = map(classmethod, (Case.jnd, Case.read, Case.write, Case.rows))

    @classmethod
    def setUpClass(cls):
        made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(made.cleanup)
        cls.folder = pathlib.Path(made.name).resolve()
