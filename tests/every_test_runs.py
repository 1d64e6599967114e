#!/usr/bin/env python3
"""No test stands in the sources and does not run: every TEST_CASE of tests/ is known to one of the test programs, what is
hidden from the usual run has a tag that tests/long.sh asks for, and every *_test script is registered with ctest.

Usage: every_test_runs.py TESTS-FOLDER PROGRAM..."""
import pathlib
import re
import subprocess
import sys

CASE = re.compile(r'^\s*TEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+)(?:,\s*"([^"]*)")?', re.M)


def problems(folder, programs):
    known = []
    for program in programs:
        for which in ([], ["[.]"]):  # Catch2 names the hidden ones only where they are asked for
            for asked in (["--list-test-names-only"], ["--list-tests", "--verbosity", "quiet"]):  # of Catch2 v2; of v3
                names = subprocess.run([program, *asked, *which], capture_output=True, text=True, check=False).stdout
                if names:
                    break
            known += names.splitlines()
    campaigns = (folder / "long.sh").read_text(encoding="utf-8")
    written = {}
    for source in sorted(folder.rglob("*.cpp")):
        if source.relative_to(folder).parts[0] in ("bench", "fuzz", "kernel", "tools"):
            continue
        for case in CASE.finditer(source.read_text(encoding="utf-8")):
            name = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', case[1])).replace('\\"', '"').replace("\\\\", "\\")
            if name in written:
                yield f"{source}: \"{name}\" is also in {written[name]}"
            written[name] = source
            if name.strip() not in (one.strip() for one in known):
                yield f"{source}: \"{name}\" is in no test program"
            hidden = re.search(r"\[[.!]", case[2] or "")
            if hidden and not any(tag in campaigns for tag in re.findall(r"\[[a-z_-]+\]", case[2])):
                yield f"{source}: \"{name}\" is hidden ({case[2]}), and tests/long.sh asks for none of its tags"
    if len(written) < 0.9 * len(known):
        yield f"only {len(written)} of {len(known)} test cases were found in the sources: this script no longer reads them"
    registered = (folder / "CMakeLists.txt").read_text(encoding="utf-8")
    for script in sorted(folder.rglob("*_test.py")):
        if script.name != "layers_test.py" and script.name.removesuffix("_test.py") not in registered:
            yield f"{script} is not registered in tests/CMakeLists.txt"


def main():
    found = list(problems(pathlib.Path(sys.argv[1]), sys.argv[2:]))
    print("\n".join(found) or "every test runs")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
