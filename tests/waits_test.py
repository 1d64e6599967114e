#!/usr/bin/env python3
"""A test waits for what happens, not for a while: every sleep, time limit and look at a clock under tests/ stands in
tests/allowed_waits.txt with its reason, and every line of that list is still needed. Left out by rule: benchmarks, and clocks
that are simulated (`sleep_until_ns`, in files that have no SteadyClock)."""
import fnmatch
import pathlib
import re
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent
LIST = "allowed_waits.txt"
SHELL = r"""\bu?sleep\ ["'$\d.]|\btimeout\ ["'$\d-]|\bread\ -t"""
PYTHON = r"""\bsleep\(|\btimeout=(?!(program\.)?GUARD_S\b|None\b)|\bsettimeout\(|\.(wait|join|get|poll|communicate)\((\w+, )?[\d.]
             |\b(monotonic|perf_counter|process_time|time|thread_time)(_ns)?\(\)|\bTimer\(|\balarm\(|\bselect\((?![^\n]*\],\ \[\]\))"""
CPP = r"""\b(sleep_for|sleep_until|usleep|nanosleep|clock_nanosleep|sleep|alarm|setitimer|timerfd_settime)\(|_clock::now\(|\bclock_gettime\(
          |\b(wait_for|wait_until)\(\w*lock|\bp?poll\((?![^;]*,\ -1\))|\b(minutes(?!\(10\))|seconds|milliseconds|microseconds)[({][\d']|\d(ms|us|s|min)\b(?=[;,)\ ])"""
EMBEDDED = r"""\btime\.(sleep|monotonic)\("""  # Python in a text of C++
KINDS = {".py": [PYTHON, SHELL], ".cpp": [CPP, EMBEDDED, SHELL], ".h": [CPP, EMBEDDED, SHELL], ".c": [CPP], ".sh": [SHELL], "": [SHELL],
         ".txt": [r"\bTIMEOUT\b"]}
KINDS = {suffix: re.compile("|".join(kinds), re.X if suffix not in ("", ".sh", ".txt") else 0) for suffix, kinds in KINDS.items()}
COMMENT = re.compile(r"\s*(//|#(?!include)|\*)")


def waits(folder):
    """(path, line number, line) of everything that waits for a while."""
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        kind = KINDS.get(path.suffix)
        if kind is None or not path.is_file() or name.startswith(("bench/", "fuzz/corpus/", "waits_test.py")) or (path.suffix == ".txt" and path.name != "CMakeLists.txt"):
            continue
        text = path.read_text(encoding="utf-8")
        real = path.suffix in (".cpp", ".h") and "SteadyClock" in text
        for number, line in enumerate(text.splitlines(), 1):
            if not COMMENT.match(line) and (kind.search(line) or (real and re.search(r"sleep_until_ns\((?!.*override)", line))):
                yield name, number, line.strip()


def problems(folder):
    listed = [line.split(" | ", 2) for line in (folder / LIST).read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    needed = set()
    for name, number, line in waits(folder):
        found = {i for i, (path, words, reason) in enumerate(listed) if fnmatch.fnmatch(name, path) and (words == "*" or words in line)}
        needed |= found
        if not found:
            yield f"{name}:{number}: waits for a while; please wait for what happens instead: {line}"
    for i, entry in enumerate(listed):
        if i not in needed:
            yield f"{LIST}: nothing is like this any more: {' | '.join(entry)}"


class Waits(unittest.TestCase):
    def test_every_wait_is_on_the_list_and_the_list_has_no_other(self):
        found = list(problems(FOLDER))
        self.assertFalse(found, "\n" + "\n".join(found))

    def planted(self, name, line, allowed=""):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, name)
            path.parent.mkdir(exist_ok=True)
            path.write_text(f"first\n{line}\nlast\n")
            pathlib.Path(folder, LIST).write_text(allowed)
            return list(problems(pathlib.Path(folder)))

    def test_what_waits_is_found(self):
        for name, line in (("a/b.py", "    time.sleep(1)"), ("b.py", "run(['x'], timeout=60)"), ("b.py", "process.wait(5)"), ("b.py", "Timer(3, f).start()"),
                           ("b.py", "end = time.monotonic() + 30"), ("b.py", "select.select([terminal], [], [], 0.5)"), ("b.py", "'exec sleep 60'"),
                           ("b.cpp", "std::this_thread::sleep_for(std::chrono::milliseconds(5));"), ("b.h", "usleep(1000);"), ("b.c", "poll(&file, 1, 100);"),
                           ("b.cpp", "changed.wait_for(lock, patience, ready);"), ("b.cpp", "const auto begun = std::chrono::steady_clock::now();"),
                           ("b.cpp", "CHECK(comes(link, 20ms));"), ("b.cpp", "until(ready, std::chrono::seconds(30));"), ("b.cpp", "SteadyClock().sleep_until_ns(9);"),
                           ("b.sh", "sleep 1"), ("b.sh", "  timeout 60 jnd run"), ("CMakeLists.txt", "set_tests_properties(x PROPERTIES TIMEOUT 60)")):
            self.assertEqual(len(self.planted(name, line)), 1, line)
            self.assertEqual(self.planted(name, line, f"*{name} | {line.strip()[:30]} | a reason\n"), [], line)

    def test_what_waits_for_something_and_what_is_simulated_is_not(self):
        for name, line in (("b.py", "process.wait(program.GUARD_S)"), ("b.py", "communicate(timeout=program.GUARD_S)"), ("b.py", "process.wait()"),
                           ("b.cpp", "clock.sleep_until_ns(clock.now_ns() + 5);"), ("b.cpp", "terminal.wait_for(\"Trial 1\");"), ("b.cpp", "poll(&file, 1, -1);"),
                           ("b.cpp", "// sleep_for(everything)"), ("bench/b.cpp", "usleep(1000);"), ("b.sh", "echo slept"), ("c.txt", "TIMEOUT")):
            self.assertEqual(self.planted(name, line), [], line)

    def test_an_entry_that_nothing_needs_is_told(self):
        self.assertEqual(len(self.planted("b.py", "pass", "b.py | sleep | a reason\n")), 1)


if __name__ == "__main__":
    unittest.main()
