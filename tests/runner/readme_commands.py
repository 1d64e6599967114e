#!/usr/bin/env python3
"""Runs the pages' commands: every line "$ jnd ..." of a page's console blocks, in order, in an empty folder per page.

The lines that the page shows below a command must be in its output, in that order; a line "..." stands for any lines.
A command that ends with "# exit N" must end with that code. Lines that begin with "> " go on with a command.

Usage: readme_commands.py JND PAGE|FOLDER...   of a folder every page (.md) that has such blocks
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
        elif inside and line.startswith("> ") and found and not found[-1][3]:
            number, command, code, shown = found[-1]
            found[-1] = (number, f"{command}\n{line[2:]}", code, shown)
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


def pages(arguments):
    """The pages named, and those of the folders named, builds and hidden folders left out."""
    for argument in arguments:
        if not os.path.isdir(argument):
            yield argument
            continue
        for folder, folders, files in os.walk(argument):
            folders[:] = sorted(name for name in folders if name != "build" and not name.startswith("."))
            for name in sorted(files):
                path = os.path.join(folder, name)
                if name.endswith(".md") and commands(open(path, encoding="utf-8").read()):
                    yield path


def run_page(jnd, page):
    """(commands run, commands failed) of a page."""
    # In a build tree jnd-virtual-device is in another folder than jnd; installed, it is beside it.
    programs = [os.path.dirname(jnd), os.path.join(os.path.dirname(jnd), "..", "devices")]
    environment = dict(os.environ, PATH=os.pathsep.join([*programs, os.environ["PATH"]]), LC_ALL="C.UTF-8")
    failures = ran = 0
    with tempfile.TemporaryDirectory() as folder:
        for number, command, code, shown in commands(open(page, encoding="utf-8").read()):
            if shlex.split(command)[0] in ("git", "cd", "cmake", "runner/demo.sh", "tests/run.sh"):
                continue  # the set-up itself; .ci/run runs the two scripts
            done = subprocess.run(command, shell=True, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            ran += 1
            # A bell is heard, not shown.
            actual = [line.rstrip() for line in done.stdout.replace("\a", "").splitlines()]
            wrong = mismatch(shown, actual)
            if done.returncode != code or wrong is not None:
                failures += 1
                print(f"{page}:{number}: $ {command}\n  exit {done.returncode}, expected {code}")
                if wrong is not None:
                    print(f"  not in the output (or not there): {wrong!r}\n  the output was:\n{done.stdout}")
    return ran, failures


def main():
    jnd = os.path.abspath(sys.argv[1])
    ran = failed = 0
    for page in pages(sys.argv[2:]):
        counts = run_page(jnd, os.path.abspath(page))
        print(f"{page}: {counts[0]} commands run, {counts[1]} failed", flush=True)
        ran, failed = ran + counts[0], failed + counts[1]
    sys.exit(1 if failed or ran == 0 else 0)


if __name__ == "__main__":
    main()
