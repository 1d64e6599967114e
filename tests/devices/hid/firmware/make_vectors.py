#!/usr/bin/env python3
"""Writes devices/hid/vectors.txt from the tables of devices/hid/PROTOCOL.md and the records of vector_records.py.

Usage: make_vectors.py [FILE]     FILE: default devices/hid/vectors.txt; - for the terminal
"""
import struct
import sys

from protocol_tables import CRC_AT, PAGE, VERSION, read_tables
from vector_records import ONE, OTHERS, TYPICAL, WRONG, settle

HEAD = """\
# Test vectors of the report protocol, version 1; PROTOCOL.md, "Testing a firmware", says how they are read.
# Written by tests/devices/hid/firmware/make_vectors.py: change that, or the tables of PROTOCOL.md, never this file.
#
# KIND NAME HEX key=value ...
# refuse REASON NAME HEX kind=KIND
"""
MOST_NAMED_VALUES = 16  # a field of no more values gets a vector for each of them
LENGTHS = (1, 8, 63, 65)
OTHER_VERSIONS = (0, 2, 255)


def shown(field, value):
    if field.is_array():
        return ",".join(str(element) for element in value)
    return str(value)


def accepted(layout, name, record):
    keys = " ".join(f"{member}={shown(field, record[member])}" for member, field in layout.members())
    return f"{layout.kind} {name} {layout.encode(record).hex()} {keys}"


def refused(layout, reason, name, data):
    return f"refuse {reason} {layout.kind}_{name} {bytes(data).hex()} kind={layout.kind}"


def filled(layout, end):
    """Every number, text and date at its lowest (end 0) or highest (-1), as far as the rules between fields let it."""
    record = dict(TYPICAL[layout.kind])
    for member, field in layout.members():
        if field.kind == "bits":
            record[member] = -end
        elif field.kind == "text":
            record[member] = "~" * field.size if end else "!" * int(field.allowed[0])
        elif field.pieces() is None:
            record[member] = 99991231 if end else 0
        elif field.pieces() is not None:
            value = field.pieces()[end][end]
            record[member] = [value] * field.count if field.is_array() else value
    if layout.kind == "pose":
        record["seen"], record["has_flexion"], record["orientation"] = 1, 1, [0, (-1 - 2 * end) * ONE, 0, 0]
    if layout.kind == "force_table":
        record = dict(record, **OTHERS["force_table"]["six" if end else "none"])
    return record


def single_values(layout):
    """Each number of few values at each of them, each set of bits bit by bit, every other one at its ends."""
    for member, field in layout.members():
        pieces = field.pieces()
        if pieces is None or field.kind == "bits" or layout.kind == "force_table":
            continue
        values = {value for piece in pieces for value in piece}
        if sum(high - low + 1 for low, high in pieces) <= MOST_NAMED_VALUES:
            values = {value for low, high in pieces for value in range(low, high + 1)}
        if member in ("faults", "limits", "buttons", "capabilities"):
            values |= {1 << bit for bit in range(pieces[0][1].bit_length())}
        for value in sorted(values):
            if field.is_array():
                if member in ("data", "orientation"):
                    continue
                for place in range(field.count):
                    changed = list(TYPICAL[layout.kind][member])
                    changed[place] = value
                    yield f"{member}_{place}_{value}", {**TYPICAL[layout.kind], member: changed}
            else:
                yield f"{member}_{value}", settle(layout.kind, {**TYPICAL[layout.kind], member: value}, member)


def bit_sets(layout):
    for field in layout.fields:
        if field.kind == "bits" and layout.kind != "pose":
            for value in range(2 ** len(field.names)):
                bits = {name: value >> bit & 1 for bit, name in enumerate(field.names)}
                yield "_".join([field.names[0], str(value)]), {**TYPICAL[layout.kind], **bits}


def right_ones(layout):
    yield "typical", TYPICAL[layout.kind]
    for name, changes in OTHERS[layout.kind].items():
        yield name, {**TYPICAL[layout.kind], **changes}
    yield "lowest", filled(layout, 0)
    yield "highest", filled(layout, -1)
    yield from bit_sets(layout)
    yield from single_values(layout)


def outside(field):
    """Values of the type just outside the allowed pieces, and the farthest."""
    low, high = field.span()
    pieces = field.pieces()
    candidates = {low, high} | {value for piece in pieces for value in (piece[0] - 1, piece[1] + 1)}
    inside = lambda value: any(first <= value <= last for first, last in pieces)
    return sorted(value for value in candidates if low <= value <= high and not inside(value))


def out_of_range(layout):
    """The bytes of a typical one with one field, or one byte that should be zero, outside its range."""
    typical = layout.encode(TYPICAL[layout.kind])
    for field in layout.fields:
        data = bytearray(typical)
        if field.kind == "zero":
            for place in sorted({0, field.size // 2, field.size - 1}):
                data = bytearray(typical)
                data[field.at + place] = 1 if place else 0x80
                yield f"byte_{field.at + place}", layout.seal(data)
        elif field.kind == "bits":
            for bit in range(len(field.names), 8):
                data[field.at] = typical[field.at] | 1 << bit
                yield f"{field.names[0]}_bit_{bit}", layout.seal(data)
        elif field.pieces() is not None and not field.is_array():
            for value in outside(field):
                struct.pack_into("<" + {1: "B", 2: "H", 4: "I", 8: "Q"}[field.size], data, field.at, value)
                yield f"{field.names[0]}_{value}", layout.seal(data)
    for name, changes in WRONG.get(layout.kind, {}).items():
        yield name, layout.encode({**TYPICAL[layout.kind], **changes})


def broken(layout, layouts):
    """Reports that are none of their kind, by reason. Pages have only ranges."""
    if layout.report_id is None:
        return
    whole = layout.encode(TYPICAL[layout.kind])
    for length in LENGTHS:
        yield "length", f"of_{length}", (whole + b"\0")[:length]
    for other in sorted({one.report_id for one in layouts.values() if one.report_id} | {0, 255}):
        if other != layout.report_id:
            yield "id", f"as_{other:02x}", layout.seal(whole, report_id=other)
    for version in OTHER_VERSIONS:
        yield "version", f"of_version_{version}", layout.seal(whole, version=version)
    yield "version", "of_version_9_without_crc", whole[:1] + b"\x09" + whole[2:]
    crc = whole[CRC_AT:]
    yield "crc", "without_crc", whole[:CRC_AT] + b"\0" * 4
    yield "crc", "big_endian_crc", whole[:CRC_AT] + crc[::-1]
    yield "crc", "not_inverted_crc", whole[:CRC_AT] + bytes(255 - byte for byte in crc)
    yield "crc", "one_bit", whole[:40] + bytes([whole[40] ^ 1]) + whole[41:]
    # A field out of range and a wrong CRC: the CRC is looked at first.
    yield "crc", "all_wrong", whole[:2] + b"\xff" * 58 + b"\0" * 4


def lines():
    layouts = read_tables()
    for layout in layouts.values():
        yield ""
        seen = set()
        for name, record in right_ones(layout):
            data = layout.encode(record)
            if data not in seen:
                yield accepted(layout, name, record)
            seen.add(data)
        for reason, name, data in broken(layout, layouts):
            yield refused(layout, reason, name, data)
        for name, data in out_of_range(layout):
            yield refused(layout, "range", name, data)


def main():
    if VERSION != 1 or len(sys.argv) > 2:
        sys.exit(__doc__)
    text = HEAD + "\n".join(lines()) + "\n"
    target = sys.argv[1] if len(sys.argv) == 2 else PAGE.parent / "vectors.txt"
    if target == "-":
        sys.stdout.write(text)
    else:
        with open(target, "w", encoding="ascii") as file:
            file.write(text)


if __name__ == "__main__":
    main()
