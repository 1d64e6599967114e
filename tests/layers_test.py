#!/usr/bin/env python3
"""The house: rooms, their wings, and which wing may include which. Fails on an include that is not in the table, on a file
in no wing, on a folder of too many files, on tests that stand in no wing of what they test, on two headers with a type
of the same name (where the linker meets both it keeps the code of one), and on committed files that belong nowhere.

Usage: layers_test.py [SOURCE-FOLDER]"""
import pathlib
import re
import subprocess
import sys

MOST_FILES = 30  # in a folder, of those that are compiled

# A room includes those that stand before it; data and devices do not know each other.
ROOMS = {"analysis": [], "protocols": ["analysis"], "data": ["analysis", "protocols"],
         "devices": ["analysis", "protocols"], "runner": ["analysis", "protocols", "data", "devices"]}

# The wings of each room, every one with those of its room that it may include. "." is the room's own folder, its face.
WINGS = {
    "analysis": {
        "numerics": "",
        "procedures": "numerics",
        "detection": "numerics",
        "choice": "detection numerics",
        "ratings": "numerics",
        "psychometric": "numerics",
        "thresholds": "detection numerics",
        "behaviour": "detection numerics thresholds",
        "group": "numerics scaling thresholds",
        "lattice": "numerics",
        "hierarchical": "lattice numerics",
        "precision": "detection numerics thresholds",
        "scaling": "numerics",
        "selftest": "choice detection group hierarchical numerics procedures psychometric ratings scaling thresholds",
    },
    "protocols": {
        ".": "",
        "input": "",
        "tasks": ". input",
        "planning": ". input tasks",
        "course": ". planning tasks",
        "reading": ". input planning course tasks",
        "rigs": ". input reading tasks",
    },
    "data": {
        "log": "",
        "files": "log",
        "study": "files log",
        "verify": "files log study",
        "task_results": "log study",
        "copies": "files log study verify",
        "raw_trials": "log study",
        "fields": "study",
        "results": "fields log raw_trials study task_results verify",
        "methods": "fields log results study task_results verify",
        "blocks": "fields results study task_results",
        "export": "blocks fields files log methods results study task_results",
    },
    "devices": {
        ".": "",
        "contact": "",
        "hid/firmware": "",
        "hid/firmware/arm": "hid/firmware",
        "loop": ". contact",
        "machine": ". loop",
        "mckibben": ". loop",
        "rrs3": ". loop",
        "hid": ". hid/firmware machine",
        "participants": ". loop mckibben",
        "self_test": ". loop mckibben rrs3",
        "hid/bench": ". hid hid/firmware loop",
        "hid/buttons": ". hid",
        "hid/virtual": ". hid/firmware hid/socket participants rrs3",
        "external": ". machine",
        "external/examples": "",
        "trackers": ". loop machine mckibben participants",
        "hid/calibration": ". hid hid/bench hid/firmware",
        "rigs": ". contact external loop mckibben participants rrs3 trackers",
        "hid/link": ". hid hid/buttons hid/firmware hid/socket loop machine participants rigs trackers",
        "hid/socket": ". hid hid/firmware machine",
    },
    "runner": {
        "terminal": "",
        "words": "",
        "results": "terminal",
        "calc": "results terminal",
        "calc_hierarchical": "calc terminal",
        "cluster": "keys terminal",
        "keys": "terminal",
        "help": "keys terminal",
        "precision": "terminal",
        "power": "drawing keys opening session shards terminal",
        "session": "keys terminal",
        "shards": "opening session terminal",
        "console": "keys session terminal words",
        "screen": "console keys session terminal words",
        "events": "session",
        "sound": "session terminal",
        "drawing": "terminal",
        "figures": "drawing results terminal",
        "opening": "keys session terminal words",
        "device_commands": "keys opening sound terminal",
        "report": "drawing figures keys results",
        "study_commands": "keys opening terminal",
        "commands": "console events keys opening power precision report results screen session shards sound study_commands terminal words",
        ".": "calc cluster commands device_commands help keys study_commands terminal",
    },
}

# One component in C each, with its corpus of vectors or pages beside it: as long as it is.
ANY_LENGTH = {"devices/hid/firmware"}

SOURCE = (".h", ".cpp", ".c")

# What git keeps at the top level, beside names that begin with a dot.
TOP_LEVEL = {"CMakeLists.txt", "CMakePresets.json", "README.md", "LICENSE", "CITATION.cff", "CHANGELOG.md", "debian", "tests", *ROOMS}
# Folders, or single files, that git may keep though they are no UTF-8 text.
BINARY = ("runner/pictures/", "tests/fuzz/corpus/")


def wing_of(path):
    """"devices/hid/link/x.h" -> ("devices", "hid/link")."""
    room, *folders = pathlib.PurePosixPath(path).parent.parts
    return room, "/".join(folders) or "."


def includes(root, path):
    text = (root / path).read_text(encoding="utf-8")
    for number, line in enumerate(text.splitlines(), 1):
        found = re.match(r'#include "([^"]+)"', line)
        if found is None:
            continue
        target = pathlib.PurePosixPath(found[1])
        beside = pathlib.PurePosixPath(path).parent / target
        if ".." in target.parts or len(target.parts) == 1:  # the firmware's C includes what lies beside it
            parts = []
            for part in beside.parts:
                if part == "..":
                    parts.pop()
                else:
                    parts.append(part)
            target = pathlib.PurePosixPath(*parts)
        yield number, str(target)


def types(root, path):
    """The types that a header defines outside every other one, templates left out."""
    for line in (root / path).read_text(encoding="utf-8").splitlines():
        found = re.match(r"(?:struct|class|enum class|enum) (\w+)(?: final)?(?: :.*)? \{", line)
        if found is not None:
            yield found[1]


def problems(root):
    files = sorted(str(path.relative_to(root)) for room in [*ROOMS, "tests"]
                   for path in (root / room).rglob("*") if path.suffix in SOURCE)
    counts = {}
    for path in files:
        folder = str(pathlib.PurePosixPath(path).parent)
        counts[folder] = counts.get(folder, 0) + 1
        room, wing = wing_of(path)
        if room == "tests":
            tested, _, rest = wing.partition("/")
            if tested in ROOMS and rest and not any(rest == one or rest.startswith(one + "/") for one in WINGS[tested]):
                yield f"{path}: tests/{wing} is no wing of {tested}"
            continue
        if wing not in WINGS[room]:
            yield f"{path}: {room} has no wing {wing} (the table is in tests/layers_test.py)"
            continue
        allowed = WINGS[room][wing].split() + [wing]
        for line, target in includes(root, path):
            other, into = wing_of(target)
            if other not in ROOMS:
                yield f"{path}:{line}: {target} is in no room"
            elif other == room and into not in allowed:
                yield f"{path}:{line}: {room}/{wing} may not include {room}/{into} (only: {' '.join(allowed)})"
            elif other != room and other not in ROOMS[room]:
                yield f"{path}:{line}: {room} may not include {other}"
    defined = {}
    for path in files:
        room, _ = wing_of(path)
        if room not in ROOMS or not path.endswith(".h") or any(path.startswith(one + "/") for one in ANY_LENGTH):
            continue
        for name in types(root, path):
            if name in defined:
                yield f"{path}: the type {name} is also in {defined[name]}: one of them needs another name"
            defined[name] = path
    for folder, count in sorted(counts.items()):
        if count > MOST_FILES and folder not in ANY_LENGTH:
            yield f"{folder}: {count} files, more than {MOST_FILES}: give some of them a wing of their own, or merge them"
    for room, wings in WINGS.items():
        for wing in wings:
            if f"{room}/{wing}".removesuffix("/.") not in counts:
                yield f"{room}/{wing} is in the table and not in the house"
        order = set()
        left = dict(wings)
        while left:
            free = [wing for wing, into in left.items() if set(into.split()) <= order]
            if not free:
                yield f"{room}: the arrows of {', '.join(left)} go round in a circle"
                break
            for wing in free:
                order.add(wing)
                del left[wing]


def strays(root):
    """Files that git keeps in the wrong place; programs and other binaries."""
    try:
        listed = subprocess.run(["git", "-C", root, "ls-files", "-z"], capture_output=True, text=True)
    except FileNotFoundError:
        listed = None
    if listed is None or listed.returncode or not (root / ".git").exists():
        print("SKIPPED: this folder is no git checkout: nobody looks for stray files")
        return
    for top in sorted({path.split("/")[0] for path in listed.stdout.split("\0") if path} - TOP_LEVEL):
        if not top.startswith("."):
            yield f"{top}: does not belong at the top level (the list is in tests/layers_test.py)"
    for path in listed.stdout.split("\0"):
        if not (root / path).is_file() or path.startswith(BINARY):
            continue
        data = (root / path).read_bytes()
        try:
            data.decode()
        except UnicodeDecodeError:
            data = b"\0"
        if b"\0" in data:
            yield f"{path}: is no text; binaries stand only in {', '.join(BINARY)}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    found = [*problems(root), *strays(root)]
    print("\n".join(found) or "every include follows the table")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
