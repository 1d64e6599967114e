#!/usr/bin/env python3
"""PROTOCOL.md against itself, vectors.txt and jnd_report.h: what the page says in two places is the same.

Usage: vectors_test.py
"""
import io
import re
import sys
import unittest
import zlib
from contextlib import redirect_stdout
from unittest import mock

sys.dont_write_bytecode = True

import make_vectors
from protocol_tables import PAGE, REPORT_SIZE, code_blocks, read_tables

TEXT = PAGE.read_text()
HEADER = re.sub(r"/\*.*?\*/", "", (PAGE.parent / "firmware/jnd_report.h").read_text(), flags=re.S)


def bytes_of(lines):
    return bytes.fromhex("".join(re.match(r"(?:[0-9A-F]{2} ?)+", line)[0] for line in lines))


def enumerators(prefix):
    """NAME: value, of the header's enumerators JND_<prefix>_NAME."""
    found = {}
    for name, value, shift in re.findall(rf"JND_{prefix}_(\w+) = (\w+)(?: << (\d+))?", HEADER):
        if name not in ("BITS", "SIZE"):
            found[name] = int(value, 0) << int(shift or 0)
    return found


def report_sizes(descriptor):
    """A reader of HID report descriptors as far as ours go: (usage page, usage), {(kind, id): bytes}."""
    page = usage = size = count = report = None
    top, sizes, depth, at = None, {}, 0, 0
    while at < len(descriptor):
        prefix = descriptor[at]
        length = (0, 1, 2, 4)[prefix & 3]
        value = int.from_bytes(descriptor[at + 1 : at + 1 + length], "little")
        tag = prefix & 0xFC
        if tag == 0x04:
            page = value
        elif tag == 0x08:
            usage = value
        elif tag == 0x74:
            size = value
        elif tag == 0x94:
            count = value
        elif tag == 0x84:
            report = value
        elif tag == 0xA0:
            depth, top = depth + 1, (page, usage)
        elif tag == 0xC0:
            depth -= 1
        elif tag in (0x80, 0x90):
            key = ("in" if tag == 0x80 else "out", report)
            sizes[key] = sizes.get(key, 0) + size * count // 8
        elif tag not in (0x14, 0x24):
            raise ValueError(f"item 0x{prefix:02X} at {at}")
        at += 1 + length
    if depth != 0 or at != len(descriptor):
        raise ValueError("the descriptor does not end where it should")
    return top, sizes


class Vectors(unittest.TestCase):
    def test_the_file_is_what_the_tables_give(self):
        out = io.StringIO()
        with redirect_stdout(out), mock.patch.object(sys, "argv", ["make_vectors.py", "-"]):
            make_vectors.main()
        kept = (PAGE.parent / "vectors.txt").read_text(encoding="ascii").splitlines()
        made = out.getvalue().splitlines()
        for i, (left, right) in enumerate(zip(kept, made), start=1):
            self.assertEqual(left, right, f"line {i}: run tests/devices/hid/firmware/make_vectors.py and look at what changed")
        self.assertEqual(len(kept), len(made))
        self.assertGreater(len(made), 400)

    def test_every_refused_report_differs_from_every_right_one(self):
        right, wrong = set(), set()
        for line in make_vectors.lines():
            words = line.split()
            if words[:1] == ["refuse"]:
                wrong.add((words[4].partition("=")[2], words[3]))
            elif words:
                right.add((words[0], words[2]))
        self.assertFalse(right & wrong)

    def test_tables_that_do_not_fit_are_found(self):
        for old, new in [("| 4 | 4 | u32 | sequence | | any | | one", "| 5 | 4 | u32 | sequence | | any | | one"),
                         ("| 20 | 12 | i32[3] | normal |", "| 20 | 12 | i32[2] | normal |"),
                         ("| 59 | 1 | zero |", "| 59 | 2 | zero |")]:
            self.assertIn(old, TEXT)
            with self.assertRaises(ValueError):
                read_tables(TEXT.replace(old, new))


class Page(unittest.TestCase):
    def test_the_worked_example(self):
        (lines,) = code_blocks("example")
        example = bytes_of(lines)
        layout = read_tables()["command"]
        record = {member: [0] * field.count if field.is_array() else 0 for member, field in layout.members()}
        self.assertEqual(layout.encode({**record, "sequence": 1}), example)
        self.assertEqual(len(example), REPORT_SIZE)
        printed = re.search(r"with its CRC `([0-9A-F]{8})`", TEXT)[1]
        self.assertEqual(int(printed, 16), zlib.crc32(example[:60]))
        digits = re.search(r"`123456789` it is `([0-9A-F]{8})`", TEXT)[1]
        self.assertEqual(int(digits, 16), zlib.crc32(b"123456789"))

    def test_the_descriptors_are_of_the_reports(self):
        ids = {kind: layout.report_id for kind, layout in read_tables().items() if layout.report_id}
        expected = {"fingertip": (1, {"out": ["command", "request"], "in": ["telemetry", "answer"]}),
                    "tracker": (2, {"out": ["request"], "in": ["answer", "pose"]})}
        for name, (usage, reports) in expected.items():
            (lines,) = code_blocks(f"descriptor {name}")
            top, sizes = report_sizes(bytes_of(lines))
            self.assertEqual(top, (0xFF4A, usage))
            wanted = {(way, ids[kind]): REPORT_SIZE - 1 for way, kinds in reports.items() for kind in kinds}
            self.assertEqual(sizes, wanted)

    def test_the_bits_are_those_of_the_header(self):
        for word, prefix in (("faults", "FAULT"), ("limits", "LIMIT")):
            body = re.search(rf"^\| bit of `{word}` \|.*?\n\n", TEXT, flags=re.M | re.S)[0]
            bits = {name: 1 << int(bit) for bit, name in re.findall(r"^\| (\d+) \| ([A-Z_]+) \|", body, flags=re.M)}
            self.assertEqual(bits, enumerators(prefix))
            (field,) = [one for one in read_tables()["telemetry"].fields if one.names == [word]]
            self.assertEqual(field.pieces(), [(0, sum(bits.values()))])

    def test_the_numbers_are_those_of_the_header(self):
        for words, prefix in (("0 rest, 1 wrench, 2 pd, 3 pd_literal", "MODE"), ("0 REST, 1 ACTIVE, 2 STOPPED", "STATE"),
                              ("0 identity, 1 limits, 2 geometry, 3 force_table, 4 certificate", "PAGE")):
            pairs = {name.upper(): int(number) for number, name in re.findall(r"(\d) (\w+)", words)}
            if prefix == "PAGE":
                for name, number in pairs.items():
                    self.assertRegex(TEXT, rf"\| {number} \| {name.lower().replace('_', ' ')} \|")
                    self.assertRegex(TEXT, rf"(?m)^### {name.lower()}: page {number}$")
                    self.assertRegex(HEADER, rf"JND_PAGE_{name} = {number}\b")
            else:
                self.assertIn(words, TEXT)
                self.assertEqual(pairs, enumerators(prefix))
        ids = {int(value, 16) for value in re.findall(r"JND_REPORT_\w+ = (0x\w\w)", HEADER)}
        self.assertEqual(ids, {layout.report_id for layout in read_tables().values() if layout.report_id})
        self.assertIn("JND_USAGE_PAGE = 0xFF4A", HEADER)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
