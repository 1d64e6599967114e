#!/usr/bin/env python3
"""Runs the pages' commands: every line "$ jnd ..." of a page's console blocks, in order, in an empty folder per page.

The lines that the page shows below a command must be in its output, in that order; a line "..." stands for any lines.
A command that ends with "# exit N" must end with that code. Lines that begin with "> " go on with a command.

A command that a page shows and that is not run here, in a console block, in an indented block or between backquotes,
must be in ELSEWHERE, which says what runs it instead. In running text "jnd ..." is a mention, not a command.

Usage: readme_commands.py JND PAGE|FOLDER...   of a folder every page (.md) that shows commands
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Pattern of commands that are not run here; the file that runs them ("": nothing does); why they are not run here.
ELSEWHERE = [
    (r"runner/demo\.sh|tests/run\.sh|cmake --install build/demo", "tests/long.sh", "on a bare machine, which they change"),
    (r"tests/run\.sh (release|asan|tsan)", "tests/long.sh", "they run this test"),
    (r"tests/run\.sh long", "tests/run.sh", "it starts tests/long.sh, which takes hours"),
    (r"cmake --workflow --preset dev|ctest --preset dev.*", "tests/run.sh", "they run this test: the same steps"),
    (r"(DESTDIR=FOLDER )?cmake --install build/release", "tests/runner/install.sh",
     "in a folder of its own, in each preset"),
    (r"build/dev/tests/protocols_tests .*", "tests/CMakeLists.txt", "ctest runs the whole program"),
    (r"tests/long\.sh .*", "tests/run.sh", "hours"),
    (r"tests/fresh\.sh .*", "tests/long.sh", "it needs root, and makes a machine"),
    (r"tests/kernel/run\.sh build/dev( short.*)?", "tests/CMakeLists.txt", "minutes, in QEMU"),
    (r"(JND_CAMPAIGN=\d+ )?(tests/faults/kill_\w+\.py|tests/runner/cluster/slurm_test\.py|tests/fuzz/run\.sh"
     r"|tests/kernel/run\.sh build/dev long|build/release/tests/\w+_tests).*", "tests/long.sh", "campaigns of hours"),
    (r"cmake --preset bench && cmake --build --preset bench|build/bench/tests/bench/recovery_bench", "tests/long.sh", "minutes"),
    (r"build/bench/.*|tests/bench/.*", "", "the other benchmarks print ratios and assert nothing"),
    (r"devices/hid/firmware/build-arm\.sh --run", "tests/devices/hid/firmware/firmware_arm.sh", "needs a cross-compiler"),
    (r"sudo (modprobe uhid|jnd-virtual-device .*)", "tests/kernel/guest/lib.sh", "in a kernel of its own"),
    (r"jnd device (list|info|test|calibrate)( FT-0001.*)?", "tests/kernel/run.sh", "real devices"),
    (r"jnd(-virtual-device| device test).* thumb\.sock.*", "tests/runner/session/served_device_test.py",
     "a socket is served until it is ended"),
    (r"jnd device test external --command .*", "tests/runner/device_commands/external_rigs_test.py", "seconds of real time"),
    (r"jnd (run|doctor) .*--rig booth-2\.json.*", "tests/runner/session/served_device_test.py", "devices of a laboratory"),
    (r"jnd run my-study\.json --study rehearsal\.sqlite .*", "tests/runner/screen/screens/console_screen_test.cpp",
     "somebody has to answer"),
    (r"jnd run my-study\.json .*--events markers\.sock|python3 lsl_markers\.py .*", "tests/runner/events/events_test.py",
     "somebody has to answer"),
    (r"jnd cluster campaign --shards 64 .*", "tests/runner/cluster/slurm_test.py", "needs Slurm"),
    (r"jnd plan chinello2017 --power .*--studies 2000.*", "tests/runner/commands/power_test.py", "hours; there with fewer"),
    (r'echo "unplug 300" > /tmp/thumb', "tests/kernel/guest/unplug.sh", "in a kernel of its own"),
    (r"python3 results/recompute\.py", "tests/runner/commands/export_test.py", "after an export; here in console blocks"),
]
SHOWN = re.compile(r"(?:[A-Z_]+=\S+ )*(?:(?:sudo|cmake|ctest|python3|echo|jnd|jnd-virtual-device) [\w\"-]"
                   r"|(?:tests|runner|devices|build|\.ci)/[\w./{},-]+ )")


def shown_only(text):
    """(line number, command) of every command in an indented block or, with arguments, between backquotes."""
    fenced, block, before = False, False, ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        block = not fenced and line.startswith("    ") and (block or not before.strip())
        before = line
        if block and SHOWN.match(line[4:]):
            yield number, re.split(r"   +", line[4:])[0]
        elif not block and not fenced:
            for span in re.findall(r"`([^`]+)`", line):
                if SHOWN.match(span) and not span.startswith(("jnd", "echo")):
                    yield number, span


def elsewhere(command):
    """The row of ELSEWHERE that has the command, or None."""
    return next((row for row in ELSEWHERE if re.fullmatch(row[0], command)), None)


def commands(text, fence="```console"):
    """(line number, command, expected exit code, shown output lines) of every console block. Blocks "console virtual"
    need virtual devices: the kernel tests run them."""
    found, inside = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            inside = line == fence
        elif inside and line.startswith("$ "):
            match = re.match(r"\$ (.*?)(?:\s+# exit (\d+))?$", line)
            found.append((number, match[1], int(match[2] or 0), []))
        elif inside and line.startswith("> ") and found and not found[-1][3]:
            number, command, code, shown = found[-1]
            found[-1] = (number, f"{command}\n{line[2:]}", code, shown)
        elif inside and found:
            found[-1][3].append(line.rstrip())
    return found


def mismatch(shown, actual):
    """The first shown line that is not in the output after the ones before it, or None."""
    position, anywhere = 0, False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        while anywhere and position < len(actual) and actual[position] != line:
            position += 1
        if position >= len(actual) or actual[position] != line:
            return line
        position, anywhere = position + 1, False
    return None


def pages(arguments):
    """The pages named, and those of the folders named, builds and hidden folders left out."""
    for argument in arguments:
        if not os.path.isdir(argument):
            yield argument
            continue
        for folder, folders, files in os.walk(argument):
            folders[:] = sorted(name for name in folders if name != "build" and not name.startswith("."))
            for name in sorted(files):
                path = os.path.join(folder, name)
                if name.endswith(".md"):
                    yield path


def run_page(jnd, page):
    """(commands run, commands failed) of a page."""
    # In a build tree jnd-virtual-device is in another folder than jnd; installed, it is beside it.
    programs = [os.path.dirname(jnd), os.path.join(os.path.dirname(jnd), "..", "devices")]
    environment = dict(os.environ, PATH=os.pathsep.join([*programs, os.environ["PATH"]]), LC_ALL="C.UTF-8")
    failures = ran = 0
    with tempfile.TemporaryDirectory() as folder:
        text = open(page, encoding="utf-8").read()
        for number, command in shown_only(text):
            if elsewhere(command) is None:
                failures += 1
                print(f"{page}:{number}: {command}\n  is not run: run it in a console block, or name in ELSEWHERE what runs it")
        for number, command, code, shown in commands(text):
            if command.startswith(("cmake", "runner/", "tests/")) and elsewhere(command) is not None:
                continue
            done = subprocess.run(command, shell=True, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            ran += 1
            # A bell is heard, not shown.
            actual = [line.rstrip() for line in done.stdout.replace("\a", "").splitlines()]
            wrong = mismatch(shown, actual)
            if done.returncode != code or wrong is not None:
                failures += 1
                print(f"{page}:{number}: $ {command}\n  exit {done.returncode}, expected {code}")
                if wrong is not None:
                    print(f"  not in the output (or not there): {wrong!r}\n  the output was:\n{done.stdout}")
    return ran, failures


def main():
    jnd = os.path.abspath(sys.argv[1])
    ran = failed = 0
    for pattern, script, _ in ELSEWHERE:
        if script and not (ROOT / script).exists():
            failed += 1
            print(f"{script}, which is to run {pattern}, is not there")
    for page in pages(sys.argv[2:]):
        counts = run_page(jnd, os.path.abspath(page))
        if counts != (0, 0):
            print(f"{page}: {counts[0]} commands run, {counts[1]} failed", flush=True)
        ran, failed = ran + counts[0], failed + counts[1]
    sys.exit(1 if failed or ran == 0 else 0)


if __name__ == "__main__":
    main()
