#!/usr/bin/env python3
"""The commands that PAGE shows in its blocks "console virtual", a line each; the kernel tests run them on virtual devices.

As a module: (command, lines shown below it) of each.
"""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/runner"))
import readme_commands as plain  # noqa: E402

PAGE = ROOT / "devices/hid/README.md"


def commands():
    text = PAGE.read_text(encoding="utf-8")
    return [(command, shown) for _, command, _, shown in plain.commands(text, "```console virtual")]


if __name__ == "__main__":
    for command, _ in commands():
        print(command)
