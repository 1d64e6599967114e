#!/usr/bin/env python3
"""jnd studies and jnd watch: what they say of studies of every kind, that they change nothing, and how watch is left."""
import fcntl
import hashlib
import os
import signal
import sqlite3
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REAL_STUDY = program.argument()
PROTOCOL = program.ROOT / "protocols/tutorial.json"


class Studies(program.Case):
    def people(self, name, finished, unfinished, kind="real"):
        self.jnd(name, PROTOCOL, 1, kind, finished, unfinished, program=REAL_STUDY)

    def digests(self):
        return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in self.folder.iterdir()}

    def test_every_study_has_a_line_and_other_files_none(self):
        self.people("open.sqlite", 1, 1)
        self.people("done.sqlite", 2, 0)
        self.jnd("simulate", "tutorial", "--participants", "1", "--study", "one.sqlite", "--seed", "1")
        bytes_of_one = (self.folder / "one.sqlite").read_bytes()
        self.write("bad.sqlite", bytes_of_one[:5000] + bytes(20000) + bytes_of_one[25000:])
        sqlite3.connect(self.folder / "other.sqlite").execute("CREATE TABLE t (a)").connection.close()
        self.write("note.txt", "SQLite format 3 is not what this is")
        os.mkfifo(self.folder / "pipe")
        os.mkdir(self.folder / "folder")
        os.symlink("nowhere", self.folder / "dangling")
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
        report = self.jnd("studies", self.folder, "--json").json
        studies = {study["file"]: study for study in report["studies"]}
        self.assertEqual(set(studies), set(lines))
        self.assertEqual(studies["open.sqlite"]["participants"], {"finished": 1, "planned": 2, "left_early": 0, "excluded": 0})
        self.assertEqual(studies["open.sqlite"]["open"], ["P02"])
        self.assertIn("damaged", studies["bad.sqlite"]["damage"])

    def test_a_folder_without_studies_and_none_at_all(self):
        self.assertEqual(self.jnd("studies").stdout, "no study in .\n")
        self.assertEqual(self.jnd("studies", "--json").json["studies"], [])
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
        self.assertFalse(os.path.exists(self.folder / "none.sqlite"))
        self.assertIn("--once", self.jnd("watch", "s.sqlite", code=2).stderr)

    def watch(self, study):
        return program.Terminal("watch", study, folder=self.folder, env={"TERM": "xterm"})

    def left(self, terminal):
        terminal.until("\x1b[?1049l")
        return terminal.ends()

    def test_the_board_follows_a_writer_without_disturbing_it_and_q_leaves(self):
        self.people("s.sqlite", 1, 0)
        terminal = self.watch("s.sqlite")
        terminal.until("1 of 2 finished")
        self.people("s.sqlite", 0, 1, "pilot")  # of another kind: not counted
        self.jnd("note", "s.sqlite", "while it is watched")
        self.jnd("exclude", "s.sqlite", "--participant", "P01", "--kind", "real", "--reason", "while it is watched")
        terminal.until("0 of 2 finished, 1 excluded")
        terminal.type("zq")
        self.assertIn("\x1b[?25h", self.left(terminal))
        self.jnd("verify", "s.sqlite")
        self.assertEqual(sorted(os.listdir(self.folder)), ["s.sqlite"])

    def test_a_session_whose_program_is_gone_is_told_from_one_that_runs(self):
        self.people("s.sqlite", 0, 1)
        gone = "not running: it was closed or killed"
        self.assertIn(gone, self.jnd("watch", "s.sqlite", "--once").stdout)
        # As a program that writes does; killed, it leaves the file but not the lock.
        with open(self.folder / "s.sqlite.lock", "w", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertNotIn(gone, self.jnd("watch", "s.sqlite", "--once").stdout)
            terminal = self.watch("s.sqlite")
            self.assertNotIn(gone, terminal.until("q leaves"))
        terminal.until(gone)
        terminal.type("q")
        self.left(terminal)

    def test_ctrl_c_leaves_too_and_is_no_interruption(self):
        self.people("s.sqlite", 1, 0)
        terminal = self.watch("s.sqlite")
        terminal.until("q leaves")
        terminal.process.send_signal(signal.SIGINT)
        self.assertNotIn("interrupted", self.left(terminal))


if __name__ == "__main__":
    program.main()
