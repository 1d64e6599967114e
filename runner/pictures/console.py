#!/usr/bin/env python3
"""The picture of the operator's console: a real rehearsal of the tutorial on simulated devices, in a pseudo-terminal.

Checklist, questions and practice of the tutorial are left out and its first trials answered; the screen while the second
sphere of one is felt becomes an SVG file.

Usage: console.py JND OUT.svg   (Debian: python3-pyte)
"""
import fcntl
import html
import json
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time

import pyte

COLUMNS, ROWS = 100, 30
SHOWN = ("Trial 5 of 16", " SECOND ", ": contact")
COLOURS = {"default": "#d8dee9", "black": "#20242c", "red": "#ff7b72", "green": "#7ee787", "brown": "#e3b341",
           "blue": "#79c0ff", "magenta": "#d2a8ff", "cyan": "#76e3ea", "white": "#f0f3f6"}
BACKGROUND = "#161b22"
BLOCKS = {"█": (0, 1, 1), "▀": (0, 0.5, 1), "▄": (0.5, 0.5, 1), "░": (0, 1, 0.25)}  # top, height, how dense
CELL_WIDTH, CELL_HEIGHT, EDGE = 8.4, 18, 14


class Screen(pyte.Screen):
    """With what pyte leaves out of xterm: scrolling by several lines, and the colour of what moves in."""

    def scroll(self, move, edge, lines):
        at = self.cursor.y
        for _ in range(lines or 1):
            self.cursor.y = edge
            move()
        self.cursor.y = at

    def scroll_up(self, lines=1):
        self.scroll(self.index, self.margins.bottom if self.margins else self.lines - 1, lines)

    def scroll_down(self, lines=1):
        self.scroll(self.reverse_index, self.margins.top if self.margins else 0, lines)


    def delete_characters(self, count=None):
        """What moves in at the right has the colour of the cursor, as on xterm."""
        super().delete_characters(count)
        for column in range(self.columns - (count or 1), self.columns):
            self.buffer[self.cursor.y][column] = self.cursor.attrs._replace(data=" ")


class Stream(pyte.ByteStream):
    csi = dict(pyte.ByteStream.csi, S="scroll_up", T="scroll_down")
    events = pyte.ByteStream.events | {"scroll_up", "scroll_down"}


class Session:
    def __init__(self, arguments):
        self.screen = Screen(COLUMNS, ROWS)
        self.stream = Stream(self.screen)
        self.child, self.terminal = pty.fork()
        if self.child == 0:
            os.environ.update(TERM="xterm-256color", LC_ALL="C.UTF-8")
            os.execv(arguments[0], arguments)
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))

    def read(self, seconds):
        """Shows what the program writes for so long; false where it has ended."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if select.select([self.terminal], [], [], 0.02)[0]:
                try:
                    self.stream.feed(os.read(self.terminal, 65536))
                except OSError:
                    return False
        return True

    def text(self):
        return "\n".join(self.screen.display)

    def key(self, typed):
        """A key, and long enough without one that the next counts as another press."""
        os.write(self.terminal, typed.encode())
        return self.read(1.0)

    def go_on(self):
        """Answers whatever is asked now."""
        keys = "".join(self.screen.display[-3:])
        if "[space]" in keys:
            self.key(" ")
        elif "[s]" in keys:
            self.read(0.7)
            self.key("d")
        else:
            self.read(0.1)

    def go_on_until(self, reached, seconds):
        until = time.monotonic() + seconds
        while not reached(self.text()):
            if time.monotonic() > until or not self.read(0.05):
                sys.exit(f"the session did not get there; its screen:\n{self.text()}")
            self.go_on()

    def close(self):
        os.kill(self.child, signal.SIGTERM)
        while self.read(1):
            pass
        os.close(self.terminal)
        os.waitpid(self.child, 0)


def colour(name):
    """Of a colour as pyte has it: a name, or six hexadecimal digits."""
    if len(name) == 6 and all(digit in "0123456789abcdef" for digit in name.lower()) and name not in COLOURS:
        return "#" + name
    return COLOURS.get(name)


def blocks(text, x, y, ink):
    """Block characters as rectangles, so that they touch whatever the font."""
    shapes = []
    for place, letter in enumerate(text):
        if letter in BLOCKS:
            top, high, opacity = BLOCKS[letter]
            shapes.append(f'<rect x="{x + place * CELL_WIDTH:.1f}" y="{y + top * CELL_HEIGHT:.1f}" width="{CELL_WIDTH + 0.1:.1f}" '
                          f'height="{high * CELL_HEIGHT:.1f}" fill="{ink}" fill-opacity="{opacity}"/>')
    return shapes


def svg(screen):
    width, height = COLUMNS * CELL_WIDTH + 2 * EDGE, ROWS * CELL_HEIGHT + 2 * EDGE
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
           f'font-family="DejaVu Sans Mono, Menlo, Consolas, monospace" font-size="14" role="img">',
           "<title>The operator's console during a trial</title>",
           f'<rect width="100%" height="100%" rx="6" fill="{BACKGROUND}"/>']
    for row in range(ROWS):
        line, column = screen.buffer[row], 0
        while column < COLUMNS:
            look, begin = line[column]._replace(data=""), column
            while column < COLUMNS and line[column]._replace(data="") == look:
                column += 1
            text = "".join(line[at].data for at in range(begin, column))
            ink = colour(look.fg) or COLOURS["default"]
            paper = colour(look.bg) if look.bg != "default" else None
            if look.reverse:
                ink, paper = paper or BACKGROUND, ink
            x, y = EDGE + begin * CELL_WIDTH, EDGE + row * CELL_HEIGHT
            if paper:
                out.append(f'<rect x="{x:.1f}" y="{y}" width="{(column - begin) * CELL_WIDTH:.1f}" height="{CELL_HEIGHT}" '
                           f'fill="{paper}"/>')
            out += blocks(text, x, y, ink)
            text = "".join(" " if letter in BLOCKS else letter for letter in text)
            if text.strip():
                weight = ' font-weight="bold"' if look.bold else ""
                length = (column - begin) * CELL_WIDTH
                out.append(f'<text x="{x:.1f}" y="{y + 13}" fill="{ink}"{weight} xml:space="preserve" textLength="{length:.1f}" '
                           f'lengthAdjust="spacingAndGlyphs">{html.escape(text)}</text>')
    return "\n".join(out + ["</svg>", ""])


def main():
    jnd, picture = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([jnd, "new", "short.json", "--from", "tutorial"], check=True, stdout=subprocess.DEVNULL)
        with open("short.json", encoding="utf-8") as file:
            protocol = json.load(file)
        for section in ("checklist", "instructions", "consent", "questions", "practice", "translations"):
            protocol.pop(section, None)
        protocol["assumed"] = []
        with open("short.json", "w", encoding="utf-8") as file:
            json.dump(protocol, file)
        shown = Session([jnd, "run", "short.json", "--study", "rehearsal.sqlite", "--participant", "P01", "--seed", "1"])
        shown.go_on_until(lambda text: all(part in text for part in SHOWN), 300)
        print(shown.text())
        with open(picture, "w", encoding="utf-8") as file:
            file.write(svg(shown.screen))
        shown.close()


if __name__ == "__main__":
    main()
