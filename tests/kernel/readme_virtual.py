#!/usr/bin/env python3
"""readme_virtual.py README: the commands of its blocks "console virtual", a line each; they run on virtual devices.

As a module: (command, lines shown below it) of each.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "runner"))
import readme_commands as plain  # noqa: E402


def commands(text):
    return [(command, shown) for _, command, _, shown in plain.commands(text, "```console virtual")]


if __name__ == "__main__":
    for command, _ in commands(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")):
        print(command)
