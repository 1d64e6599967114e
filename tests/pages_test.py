#!/usr/bin/env python3
"""The pages say what is there: every wing of tests/layers_test.py has a row in its room's README, and every relative link
(with its heading) and every back-quoted path of a page exists; and every script that begins with #! can be started.

A back-quoted path is a name with a folder of this repository in front ("devices/loop/governor.h"), or the name of a source,
script or page ("governor.h"), to be found beside the page or anywhere in its room. "*", {a,b} and NAME stand for several.

Usage: pages_test.py [SOURCE-FOLDER]
"""
import os
import pathlib
import re
import sys

import layers_test

ENDINGS = (".h", ".cpp", ".c", ".h.in", ".py", ".sh", ".md", ".rules", ".*")
# Files that commands on the pages write, or that a reader makes.
MADE = {"methods.md", "job.sh", "loop.sh"}


def files_of(root):
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if name not in ("build", ".git", "demo-results")]
        found += [str(pathlib.Path(folder, name).relative_to(root)) for name in names + folders]
    return found


def alternatives(name):
    """"a_{b,c}.h" -> "a_b.h", "a_c.h"."""
    found = re.search(r"\{([^{}]*)\}", name)
    if found is None:
        return [name]
    return [one for part in found[1].split(",") for one in alternatives(name[:found.start()] + part + name[found.end():])]


def is_path(name, tops):
    if not re.fullmatch(r"[\w./*{},+-]+", name) or name.startswith("/") or name in MADE or "..." in name:
        return False
    first = name.split("/")[0]
    return ("/" in name and first in tops) or (name.endswith(ENDINGS) and re.match(r"\w", name) is not None)


def exists(name, page, files):
    """As a path from the root, from the page's folder, or the end of a path in the page's room."""
    folder = pathlib.PurePosixPath(page).parent
    room = folder.parts[0] + "/" if folder.parts else ""
    for one in alternatives(name.rstrip("/")):
        one = one.replace("NAME", "*")
        normal = os.path.normpath(one)
        beside = os.path.normpath(str(folder / one))
        glob = re.escape(normal).replace(r"\*", "[^/]*")
        if not any(path == beside or re.fullmatch(glob, path) or
                   (path.startswith(room) and re.fullmatch(r"(?:.*/)?" + glob, path)) for path in files):
            return False
    return True


def headings(page):
    """The headings of a page as links name them: "Where to read on" -> "where-to-read-on"."""
    lines = (line for _, line in without_blocks(page.read_text(encoding="utf-8")))
    return {re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower()).replace(" ", "-") for line in lines if line.startswith("#")}


def wing_rows(text):
    """The rows of the tables whose first column is "wing"."""
    inside = False
    for _, line in without_blocks(text):
        inside = line.startswith("| wing |") or (inside and line.startswith("|"))
        if inside:
            yield line


def without_blocks(text):
    """The lines outside of code blocks, with their numbers."""
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            inside = not inside
        elif not inside:
            yield number, line


def problems(root):
    files = files_of(root)
    tops = {path.split("/")[0] for path in files if "/" in path} - {"build"}
    for room, wings in layers_test.WINGS.items():
        page = f"{room}/README.md"
        rows = list(wing_rows((root / page).read_text(encoding="utf-8")))
        for wing in wings:
            if not any(re.match(rf"\| \[?`{re.escape(wing)}/?`", row) for row in rows):
                yield f"{page}: the table of wings has no row for {wing} (a line that begins with | `{wing}` |)"
    for page in sorted(path for path in files if path.endswith(".md") and (root / path).is_file()):
        folder = (root / page).parent
        for number, line in without_blocks((root / page).read_text(encoding="utf-8")):
            for target, heading in re.findall(r"\]\(([^)#\s]*)#?([^)]*)\)", line):
                to = folder / target if target else root / page
                if re.match(r"[a-z]+:", target):
                    continue
                if not to.exists() or (heading and heading not in headings(to)):
                    yield f"{page}:{number}: the link leads nowhere: {target}{'#' if heading else ''}{heading}"
            for name in re.findall(r"`([^`]+)`", line):
                if is_path(name, tops) and not exists(name, page, files):
                    yield f"{page}:{number}: there is no {name}"
    for path in files:
        whole = root / path
        if path.endswith((".py", ".sh")) and not os.access(whole, os.X_OK) and whole.read_bytes().startswith(b"#!"):
            yield f"{path}: begins with #! and cannot be started (chmod +x)"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    found = list(problems(root))
    print("\n".join(found) or "every wing has its row, every link and path leads somewhere, every script can be started")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
