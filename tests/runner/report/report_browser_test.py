#!/usr/bin/env python3
"""The report in a real browser: headless Chromium shows it without a word on the console, light, dark and on paper.

Usage: report_browser_test.py JND [FOLDER]
With FOLDER the report, its pictures and the PDF stay there, to be looked at. Exits with 77 if there is no Chromium or no pdftoppm."""
import contextlib
import os
import re
import shutil
import sqlite3
import struct
import sys
import tempfile
import xml.etree.ElementTree
import zlib

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
         "--enable-logging=stderr", "--v=0", "--virtual-time-budget=5000", "--force-device-scale-factor=1"]
# Blink's numbers for what a person prefers: 0 dark, 1 light.
DARK, LIGHT = "--blink-settings=preferredColorScheme=0", "--blink-settings=preferredColorScheme=1"
SIZE = (1100, 2400)


def pixels(path):
    """(width, height, rows of RGB or RGBA bytes, bytes a pixel) of a PNG with 8 bits a channel."""
    data = open(path, "rb").read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a PNG"
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour = header[:4]
    assert depth == 8 and colour in (2, 6) and header[6] == 0, f"unexpected PNG {header}"
    step = 3 if colour == 2 else 4
    raw, rows, above = zlib.decompress(packed), [], bytearray(width * step)
    for y in range(height):
        begin = y * (width * step + 1)
        rows.append(unfiltered(raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step]), above, step))
        above = rows[-1]
    return width, height, rows, step


def unfiltered(kind, row, above, step):
    """One row of a PNG: filters 0 none, 1 left, 2 above, 3 mean of both, 4 Paeth."""
    if kind == 2:
        return bytearray((a + b) & 255 for a, b in zip(row, above))
    for i in range(len(row)) if kind else ():
        left, corner = (row[i - step], above[i - step]) if i >= step else (0, 0)
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + above[i]) // 2
        else:
            near = left + above[i] - corner
            guess = min((abs(near - left), 0, left), (abs(near - above[i]), 1, above[i]), (abs(near - corner), 2, corner))[2]
        row[i] = (row[i] + guess) & 255
    return row


def brightness(path):
    """(mean brightness 0..255, number of colours) over every fourth pixel of every fourth row."""
    width, height, rows, step = pixels(path)
    assert (width, height) == SIZE, f"{path}: {width} x {height}"
    colours, total, count = set(), 0, 0
    for row in rows[::4]:
        for at in range(0, len(row), 4 * step):
            colour = bytes(row[at:at + 3])
            colours.add(colour)
            total += sum(colour)
            count += 3
    return total / count, len(colours)


class Report:
    def __init__(self, browser, folder):
        self.browser, self.folder = browser, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def jnd(self, *arguments, **options):
        return program.run(*arguments, folder=self.folder, **options)

    def browse(self, *flags, page="s-report.html", size=SIZE):
        """What the browser printed; its console must have stayed silent."""
        with tempfile.TemporaryDirectory() as profile:
            done = self.jnd(*FLAGS, f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}", *flags,
                            "file://" + self.path(page), program=self.browser)
        said = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
        assert not said, "\n".join(said)
        return done.stdout

    def make(self):
        # The published design, with short trials; what three participants felt is recorded, which is enough to be drawn.
        program.short_protocol("chinello2017", self.path("short.json"))
        for participants, record in ((3, ("--record", "full")), (18, ())):
            self.jnd("simulate", "short.json", "--participants", participants, "--study", "s.sqlite", "--seed", 1, *record)
        self.jnd("report", "s.sqlite")
        first = open(self.path("s-report.html"), "rb").read()
        assert "--replace" in self.jnd("report", "s.sqlite", code=program.STORAGE).stderr
        self.jnd("report", "s.sqlite", "--replace")
        assert open(self.path("s-report.html"), "rb").read() == first, "the same study made another page"

    def check_files(self):
        names = sorted(os.listdir(self.path("s-report-figures")))
        assert names == ["behaviour.svg", "combination.svg", "contrasts.svg", "jnd.svg", "people.svg", "predictive.svg", "presses.svg", "raster.svg", "rating-1.svg",
                         "ratings.svg", "ratios.svg", "roc.svg", "sensitivity.svg", "slopes.svg", "time.svg"], names
        for name in names:
            root = xml.etree.ElementTree.parse(os.path.join(self.path("s-report-figures"), name)).getroot()
            assert root.tag == "{http://www.w3.org/2000/svg}svg", root.tag
            for element in root.iter():
                for key, value in element.attrib.items():
                    assert not re.search(r"\b(nan|inf)\b", value), f"{name}: {key}={value}"
        slopes = open(self.path("s-report-figures/slopes.svg"), encoding="utf-8").read()
        for number in range(1, 19):
            assert f">P{number:02}<" in slopes, f"P{number:02} has no panel"

    def check_presses(self):
        """Trials that are asked for have a panel each; one whose force was not kept is refused before anything is made."""
        self.jnd("report", "s.sqlite", "--to", "chosen.html", "--press", "P02:100", "--press", "3:101")
        svg = open(self.path("chosen-figures/presses.svg"), encoding="utf-8").read()
        assert re.search(r">P02, [^<]*, trial 100[<,]", svg) and re.search(r">P03, [^<]*, trial 101[<,]", svg)
        for wrong, said in (("P02:9999", "no force was kept"), ("P02", "such as P01:12"), ("P02:1x", "such as P01:12")):
            assert said in self.jnd("report", "s.sqlite", "--to", "wrong.html", "--press", wrong, code=program.USAGE).stderr
            assert not os.path.exists(self.path("wrong.html"))

    def check_other_tasks(self):
        """Every answer of the other tasks stands in their raster too; where the PSE is compared, the JND stands beside it."""
        for protocol, figures in (("leib2015", {"raster", "parameter", "parameter-jnd", "curves"}), ("adaptive-posterior", {"raster", "tracks"})):
            self.jnd("simulate", protocol, "--participants", "4", "--study", "other.sqlite", "--seed", "1")
            self.jnd("report", "other.sqlite", "--replace")
            names = {os.path.splitext(name)[0] for name in os.listdir(self.path("other-report-figures"))}
            assert figures <= names, names
            with contextlib.closing(sqlite3.connect(self.path("other.sqlite"))) as study:
                right, answers = study.execute("SELECT sum(correct), count(correct) FROM trials WHERE practice = 0 AND participant = 'P03'").fetchone()
            raster = open(self.path("other-report-figures/raster.svg"), encoding="utf-8").read()
            assert f"P03: {right} of {answers} right." in raster, (right, answers)
            os.remove(self.path("other.sqlite"))

    def check_document(self):
        document = self.browse("--dump-dom")
        for part in ('<figure id="fig-jnd">', '<figure id="fig-slopes">', '<figure id="fig-time">', '<figure id="fig-rating-1">',
                     '<figure id="fig-sensitivity">', 'id="table-estimates"', 'id="table-group"', 'id="methods"',
                     'id="provenance"', "Cautions"):
            assert part in document, f"{part} is not in the page as the browser understood it"
        assert document.count("<svg") == 22 and document.count("</svg>") == 22  # 15, seven of them for phones too
        assert "<script" not in document
        # Of 18 participants there are 162 cells, more than a page should show at once; the 54 rows of participants stay open.
        folded = re.findall(r'id="table-([a-z-]+)">\s*<details>\s*<summary>[^<]*<span class="note">(\d+) rows', document)
        assert folded == [("cells", "162")], folded

    def check_screens(self):
        seen = {}
        for name, flag in (("light", LIGHT), ("dark", DARK)):
            self.browse(flag, "--screenshot=" + self.path(name + ".png"))
            seen[name] = brightness(self.path(name + ".png"))
            assert seen[name][1] > 30, f"{name}: only {seen[name][1]} colours: is the page blank?"
        assert seen["light"][0] > 200 and seen["dark"][0] < 80, f"brightness and colours: {seen}"

    def check_widths(self):
        """Nothing is wider than the window, and of two forms of a figure one is shown."""
        page = open(self.path("s-report.html"), encoding="utf-8").read()
        page = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page, count=1)
        measure = ("<script>addEventListener('load', () => { const shown = [...document.querySelectorAll('svg')].filter(e => e.getClientRects().length);"
                   "parent.postMessage([innerWidth, document.documentElement.scrollWidth, shown.length].join(' '), '*'); });</script>")
        with open(self.path("measured.html"), "w", encoding="utf-8") as file:
            file.write(page.replace("</body>", measure + "</body>"))
        widths = (500, 800, 1280)  # each a window of its own within one
        with open(self.path("windows.html"), "w", encoding="utf-8") as file:
            file.write("<script>const told = []; addEventListener('message', e => { told.push(e.data); document.title = told.join('; '); });</script>" +
                       "".join(f'<iframe src="measured.html" width="{wide}" height="900" style="border: 0"></iframe>' for wide in widths))
        told = re.search(r"<title>([\d ;]+)</title>", self.browse("--dump-dom", page="windows.html", size=(3000, 1000)))[1]
        measured = sorted(tuple(map(int, one.split())) for one in told.split("; "))
        for wide, (inner, scroll, shown) in zip(widths, measured, strict=True):
            assert inner == wide and scroll <= inner, f"at {wide} px the page is {scroll} px wide"
            assert shown == 15, f"at {wide} px {shown} figures are shown"

    def check_paper(self):
        # Paper is white whatever the person prefers on the screen.
        self.browse(DARK, "--no-pdf-header-footer", "--print-to-pdf=" + self.path("report.pdf"))
        pdf = open(self.path("report.pdf"), "rb").read()
        assert pdf.startswith(b"%PDF-") and pdf.rstrip().endswith(b"%%EOF"), "no whole PDF"
        pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
        assert 3 <= pages <= 20, f"{pages} pages"
        filled = self.filled()
        assert len(filled) == pages and min(filled[:-1]) >= 50, f"of the height of each page is used, in %: {filled}"
        return pages

    def filled(self):
        """How far down each printed page goes, in % of its height."""
        self.jnd("-r", "20", "-gray", "report.pdf", "paper", program="pdftoppm")
        filled = []
        for name in sorted(name for name in os.listdir(self.folder) if name.startswith("paper-")):
            data = open(self.path(name), "rb").read()
            wide, high = map(int, re.match(rb"P5\s+(\d+)\s+(\d+)\s+255\s", data).groups())
            rows = [data[len(data) - wide * (high - y):len(data) - wide * (high - y - 1)] for y in range(high)]
            filled.append(max(100 * (y + 1) // high for y, row in enumerate(rows) if min(row) < 200))
        return filled


def main():
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    with tempfile.TemporaryDirectory() as temporary:
        folder = program.argument() or temporary
        os.makedirs(folder, exist_ok=True)
        report = Report(browser, folder)
        report.make()
        report.check_files()
        report.check_presses()
        report.check_other_tasks()
        if browser is None or shutil.which("pdftoppm") is None:
            print("SKIPPED: no Chromium or no pdftoppm here (Debian: apt-get install chromium poppler-utils); nobody has looked at the report's page")
            return 77
        report.check_document()
        report.check_screens()
        report.check_widths()
        pages = report.check_paper()
    print(f"the report has 15 figures, {pages} printed pages, a light and a dark screen, and a silent console")
    return 0


if __name__ == "__main__":
    sys.exit(main())
