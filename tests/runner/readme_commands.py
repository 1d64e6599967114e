#!/usr/bin/env python3
"""Runs the README's commands: every line "$ jnd ..." of its console blocks, in order, in an empty folder.

The lines that the README shows below a command must be in its output, in that order; a line "..." stands for any lines.
A command whose block says "(exit N)" behind it must end with that code.

Usage: readme_commands.py JND README
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile


def commands(text, fence="```console"):
    """(line number, command, expected exit code, shown output lines) of every console block. Blocks "console virtual"
    need virtual devices: the kernel tests run them."""
    found, inside = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            inside = line == fence
        elif inside and line.startswith("$ "):
            match = re.match(r"\$ (.*?)(?:\s+# exit (\d+))?$", line)
            found.append((number, match[1], int(match[2] or 0), []))
        elif inside and found:
            found[-1][3].append(line.rstrip())
    return found


def mismatch(shown, actual):
    """The first shown line that is not in the output after the ones before it, or None."""
    position, anywhere = 0, False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        while anywhere and position < len(actual) and actual[position] != line:
            position += 1
        if position >= len(actual) or actual[position] != line:
            return line
        position, anywhere = position + 1, False
    return None


def main():
    jnd, readme = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    environment = dict(os.environ, PATH=os.path.dirname(jnd) + os.pathsep + os.environ["PATH"], LC_ALL="C.UTF-8")
    failures = ran = 0
    with tempfile.TemporaryDirectory() as folder:
        for number, command, code, shown in commands(open(readme, encoding="utf-8").read()):
            if shlex.split(command)[0] in ("git", "cd", "runner/demo.sh", "tests/run.sh"):
                continue  # the set-up itself; continuous integration runs these two scripts
            done = subprocess.run(command, shell=True, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            ran += 1
            actual = [line.rstrip() for line in done.stdout.splitlines()]
            wrong = mismatch(shown, actual)
            if done.returncode != code or wrong is not None:
                failures += 1
                print(f"README line {number}: $ {command}\n  exit {done.returncode}, expected {code}")
                if wrong is not None:
                    print(f"  not in the output (or not there): {wrong!r}\n  the output was:\n{done.stdout}")
    print(f"{ran} commands of the README run, {failures} failed")
    sys.exit(1 if failures or ran == 0 else 0)


if __name__ == "__main__":
    main()
