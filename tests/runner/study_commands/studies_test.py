#!/usr/bin/env python3
"""jnd studies and jnd watch: what they say of studies of every kind, that they change nothing, and how watch is left.

Usage: studies_test.py JND REAL_STUDY
"""
import fcntl
import hashlib
import json
import os
import pty
import select
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

REAL_STUDY = os.path.abspath(sys.argv.pop(2)) if len(sys.argv) > 2 else None
JND = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else None
PROTOCOL = os.path.join(os.path.dirname(__file__), "../../../protocols/tutorial.json")


class Studies(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def jnd(self, *arguments, code=0):
        done = subprocess.run([JND, *arguments], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        return done

    def people(self, name, finished, unfinished, kind="real"):
        subprocess.run([REAL_STUDY, self.path(name), PROTOCOL, "1", kind, str(finished), str(unfinished)], check=True)

    def digests(self):
        found = {}
        for name in sorted(os.listdir(self.folder)):
            with open(self.path(name), "rb") as file:
                found[name] = hashlib.sha256(file.read()).hexdigest()
        return found

    def test_every_study_has_a_line_and_other_files_none(self):
        self.people("open.sqlite", 1, 1)
        self.people("done.sqlite", 2, 0)
        self.jnd("simulate", "tutorial", "--participants", "1", "--study", "one.sqlite", "--seed", "1")
        with open(self.path("one.sqlite"), "rb") as file:
            bytes_of_one = file.read()
        with open(self.path("bad.sqlite"), "wb") as file:
            file.write(bytes_of_one[:5000] + bytes(20000) + bytes_of_one[25000:])
        sqlite3.connect(self.path("other.sqlite")).execute("CREATE TABLE t (a)").connection.close()
        with open(self.path("note.txt"), "w", encoding="utf-8") as file:
            file.write("SQLite format 3 is not what this is")
        os.mkfifo(self.path("pipe"))
        os.mkdir(self.path("folder"))
        os.symlink("nowhere", self.path("dangling"))
        text = self.jnd("studies").stdout
        lines = {line.split()[0]: " ".join(line.split()[1:]) for line in text.splitlines()[1:5]}
        self.assertEqual(lines, {
            "bad.sqlite": "damaged",
            "done.sqlite": "tutorial real 2 of 2 2023-11-14 complete",
            "one.sqlite": "tutorial simulated 1 of 2 2000-01-01 in progress",
            "open.sqlite": "tutorial real 1 of 2 2023-11-14 open, blinded",
        })
        self.assertIn("bad.sqlite: is damaged", text)
        for name in ("other.sqlite", "note.txt", "pipe", "folder"):
            self.assertNotIn(name, text)
        report = json.loads(self.jnd("studies", self.folder, "--json").stdout)
        studies = {study["file"]: study for study in report["studies"]}
        self.assertEqual(set(studies), set(lines))
        self.assertEqual(studies["open.sqlite"]["participants"], {"finished": 1, "planned": 2, "left_early": 0, "excluded": 0})
        self.assertEqual(studies["open.sqlite"]["open"], ["P02"])
        self.assertIn("damaged", studies["bad.sqlite"]["damage"])

    def test_a_folder_without_studies_and_none_at_all(self):
        self.assertEqual(self.jnd("studies").stdout, "no study in .\n")
        self.assertEqual(json.loads(self.jnd("studies", "--json").stdout)["studies"], [])
        self.assertIn("cannot be listed", self.jnd("studies", "nowhere", code=2).stderr)

    def test_the_board_once_says_how_far_it_is_and_changes_nothing(self):
        self.people("s.sqlite", 1, 1)
        self.jnd("exclude", "s.sqlite", "--participant", "P01", "--reason", "felt ill", "--replace")
        before = self.digests()
        text = self.jnd("watch", "s.sqlite", "--once").stdout
        self.assertEqual(self.digests(), before)
        self.assertIn("0 of 2 finished, 1 excluded", text)
        self.assertRegex(text, r"open now +P02 +\[#+\.+\] +\d+ of 16, 0 voided\n +began \d+ h")
        self.assertIn("number 1 of the plan", text)
        self.assertNotIn("\x1b", text)
        self.jnd("watch", "none.sqlite", "--once", code=5)
        self.assertFalse(os.path.exists(self.path("none.sqlite")))
        self.assertIn("--once", self.jnd("watch", "s.sqlite", code=2).stderr)

    def watch(self, study):
        child, terminal = pty.fork()
        if child == 0:
            os.chdir(self.folder)
            os.environ["TERM"] = "xterm"
            os.execv(JND, ["jnd", "watch", study])
        self.addCleanup(os.close, terminal)
        return child, terminal

    def wait_for(self, terminal, wanted, text=""):
        end = time.monotonic() + 30
        while wanted not in text:
            ready, _, _ = select.select([terminal], [], [], max(0, end - time.monotonic()))
            self.assertTrue(ready, f"{wanted!r} did not come: {text[-2000:]!r}")
            text += os.read(terminal, 4096).decode(errors="replace")
        return text

    def test_the_board_follows_a_writer_without_disturbing_it_and_q_leaves(self):
        self.people("s.sqlite", 1, 0)
        child, terminal = self.watch("s.sqlite")
        self.wait_for(terminal, "1 of 2 finished")
        self.people("s.sqlite", 0, 1, "pilot")  # of another kind: not counted
        self.jnd("note", "s.sqlite", "while it is watched")
        self.jnd("exclude", "s.sqlite", "--participant", "P01", "--kind", "real", "--reason", "while it is watched")
        self.wait_for(terminal, "0 of 2 finished, 1 excluded")
        os.write(terminal, b"zq")
        text = self.wait_for(terminal, "\x1b[?1049l")
        self.assertIn("\x1b[?25h", text)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        self.jnd("verify", "s.sqlite")
        self.assertEqual(sorted(os.listdir(self.folder)), ["s.sqlite"])

    def test_a_session_whose_program_is_gone_is_told_from_one_that_runs(self):
        self.people("s.sqlite", 0, 1)
        gone = "not running: it was closed or killed"
        self.assertIn(gone, self.jnd("watch", "s.sqlite", "--once").stdout)
        # As a program that writes does; killed, it leaves the file but not the lock.
        with open(self.path("s.sqlite.lock"), "w", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertNotIn(gone, self.jnd("watch", "s.sqlite", "--once").stdout)
            child, terminal = self.watch("s.sqlite")
            self.assertNotIn(gone, self.wait_for(terminal, "q leaves"))
        self.wait_for(terminal, gone)
        os.write(terminal, b"q")
        self.wait_for(terminal, "\x1b[?1049l")
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)

    def test_ctrl_c_leaves_too_and_is_no_interruption(self):
        self.people("s.sqlite", 1, 0)
        child, terminal = self.watch("s.sqlite")
        self.wait_for(terminal, "q leaves")
        os.kill(child, signal.SIGINT)
        text = self.wait_for(terminal, "\x1b[?1049l")
        self.assertNotIn("interrupted", text)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)


if __name__ == "__main__":
    unittest.main()
