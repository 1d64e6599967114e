#!/usr/bin/env python3
"""Commands that take longer than a second say so on a terminal, and nowhere else. The work that takes long here is reading
a protocol from a pipe whose writer waits, and measuring the machine.

Usage: work_line_test.py JND
"""
import os
import pty
import re
import select
import subprocess
import sys
import time

JND = os.path.abspath(sys.argv[1])


def read_until(terminal, wanted, text=""):
    """Until wanted matches twice; to the end where it is None."""
    end = time.monotonic() + 60
    while wanted is None or len(wanted.findall(text)) < 2:
        assert select.select([terminal], [], [], max(0, end - time.monotonic()))[0], f"{wanted!r} did not come: {text!r}"
        try:
            text += os.read(terminal, 4096).decode()
        except OSError:  # the program is gone
            break
    return text


def on_a_terminal():
    reader, writer = os.pipe()
    os.set_inheritable(reader, True)
    child, terminal = pty.fork()
    if child == 0:
        os.close(writer)
        os.execv(JND, ["jnd", "check", f"/dev/fd/{reader}"])
    name = f"checking /dev/fd/{reader}"
    counted = re.compile(rf"\r{re.escape(name)}: (\d+) s \.\.\.\x1b\[K")
    text = read_until(terminal, counted)
    first, second = counted.findall(text)[:2]
    assert int(first) < int(second), text
    os.write(writer, b"{}")
    os.close(writer)
    text = read_until(terminal, None, text)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 3
    # The line is ended, with how long it took, before the results begin.
    last, _, results = text.partition("\x1b[K\r\n")
    assert last.split("\r")[-1].startswith(f"{name}: ") and not last.endswith("..."), text
    assert results.startswith("error: ") and name not in results, text


def doctor():
    """Its measurements are told one by one, and Ctrl-C ends them."""
    child, terminal = pty.fork()
    if child == 0:
        os.execv(JND, ["jnd", "doctor", "--seconds", "4"])
    text = read_until(terminal, re.compile(r"\rrehearsing for 4 s on a simulated rig: \d+ s \.\.\."))
    assert "measuring for 4 s how late a loop of 1 ms wakes: " in text, text
    os.write(terminal, b"\x03")
    text = read_until(terminal, None, text)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 130, text
    assert "fit" not in text, text


def elsewhere():
    reader, writer = os.pipe()
    with subprocess.Popen([JND, "check", f"/dev/fd/{reader}"], pass_fds=[reader], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
        os.close(reader)
        time.sleep(1.5)  # no assertion rests on it: whatever it did, nothing may be said
        os.write(writer, b"{}")
        os.close(writer)
        out, err = program.communicate()
    assert program.returncode == 3 and b"checking" not in out and err == b"", (out, err)


if __name__ == "__main__":
    on_a_terminal()
    doctor()
    elsewhere()
    print("long work is told on a terminal, and nowhere else")
