"""The tables of devices/hid/PROTOCOL.md, read as an encoder: what the page says is what is encoded.

An independent second opinion on the codec in C: nothing here was written from it. Standard library only.
"""
import pathlib
import re
import struct
import zlib

PAGE = pathlib.Path(__file__).resolve().parents[4] / "devices/hid/PROTOCOL.md"
REPORT_SIZE, PAGE_SIZE, CRC_AT, VERSION = 64, 52, 60, 1
INTEGERS = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i", "u64": "Q", "i64": "q"}


def span_of(integer):
    bits = int(integer[1:])
    return (0, 2**bits - 1) if integer[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


class Field:
    """A row of a table: one or more members of the same type at one place."""

    def __init__(self, at, size, kind, names, allowed):
        self.at, self.size, self.kind, self.allowed = at, size, kind, allowed
        self.names = names
        pairs = re.fullmatch(r"(\d+) x \((\w+), \2\)", kind)
        row = re.fullmatch(r"([ui]\d+)(?:\[(\d+)\])?", kind)
        self.integer, self.count, self.interleaved = None, 1, False
        if pairs:
            self.integer, self.count, self.interleaved = pairs[2], int(pairs[1]), True
        elif row:
            self.integer, self.count = row[1], int(row[2] or 1)
        elif kind not in ("bits", "zero", "text"):
            raise ValueError(f"type {kind}")
        if self.integer and struct.calcsize("<" + INTEGERS[self.integer]) * self.count * len(names) != size:
            raise ValueError(f"{names}: {kind} does not take {size} bytes")

    def is_array(self):
        return self.integer is not None and self.count > 1

    def span(self):
        """Lowest and highest value that the type holds."""
        return (0, 2**8 - 1) if self.kind == "bits" else span_of(self.integer)

    def pieces(self):
        """The allowed values, as pairs of lowest and highest; None for text, dates and zeros."""
        if self.kind in ("text", "zero") or "yyyymmdd" in self.allowed:
            return None
        if self.allowed == "any":
            return [self.span()]
        ends = [piece.split("..") for piece in self.allowed.split(", ")]
        return [(int(end[0]), int(end[-1])) for end in ends]

    def put(self, record, data):
        if self.kind == "zero":
            return
        if self.kind == "bits":
            data[self.at] = sum(int(record[name]) << bit for bit, name in enumerate(self.names))
        elif self.kind == "text":
            data[self.at : self.at + self.size] = record[self.names[0]].encode("ascii").ljust(self.size, b"\0")
        else:
            columns = [record[name] if self.count > 1 else [record[name]] for name in self.names]
            values = [value for row in zip(*columns) for value in row]
            struct.pack_into(f"<{len(values)}{INTEGERS[self.integer]}", data, self.at, *values)


class Layout:
    """A report or the contents of a page."""

    def __init__(self, kind, report_id, fields):
        self.kind, self.report_id, self.fields = kind, report_id, fields
        self.size = REPORT_SIZE if report_id is not None else PAGE_SIZE
        first, end = (2, CRC_AT) if report_id is not None else (0, PAGE_SIZE)
        for field in fields:
            if field.at != first:
                raise ValueError(f"{kind}: {field.names} stands at {field.at}, not at {first}")
            first += field.size
        if first != end:
            raise ValueError(f"{kind}: ends at {first}, not at {end}")

    def members(self):
        return [(name, field) for field in self.fields if field.kind != "zero" for name in field.names]

    def encode(self, record):
        data = bytearray(self.size)
        for field in self.fields:
            field.put(record, data)
        return self.seal(data)

    def seal(self, data, report_id=None, version=VERSION):
        """Id, version and CRC about the fields; a page has none of them."""
        data = bytearray(data)
        if self.report_id is not None:
            data[0] = self.report_id if report_id is None else report_id
            data[1] = version
            struct.pack_into("<I", data, CRC_AT, zlib.crc32(bytes(data[:CRC_AT])))
        return bytes(data)


def _cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def _layout(kind, where, lines):
    head = _cells(lines[0])
    fields = []
    for line in lines[2:]:
        row = dict(zip(head, _cells(line), strict=True))
        names = row["name"].split(", ") if row["name"] else []
        fields.append(Field(int(row["at"]), int(row["size"]), row["type"], names, row["range"]))
    report = re.fullmatch(r"report (0x\w\w)", where)
    return Layout(kind, int(report[1], 16) if report else None, fields)


def read_tables(text=None):
    """By kind, in the order of the page."""
    text = PAGE.read_text() if text is None else text
    layouts = {}
    for part in re.split(r"^### ", text, flags=re.M)[1:]:
        heading, _, body = part.partition("\n")
        kind, where = heading.split(": ")
        lines = [line for line in body.split("\n## ")[0].splitlines() if line.startswith("|")]
        table = [line for i, line in enumerate(lines) if i < 2 or re.match(r"\| \d+ \| \d+ \| ", line)]
        layouts[kind] = _layout(kind, where, table)
    return layouts


def code_blocks(label, text=None):
    """The fenced blocks of that label, as lists of lines."""
    text = PAGE.read_text() if text is None else text
    blocks = re.findall(r"^```" + re.escape(label) + r"\n(.*?)^```$", text, flags=re.M | re.S)
    return [block.splitlines() for block in blocks]
