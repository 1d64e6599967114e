#!/usr/bin/env python3
"""Studies that are moved away from their name: while a session writes to them, and after a killed one, whose log stays behind.

Usage: moved_study_test.py JND
"""
import json
import os
import shutil
import subprocess
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

SPECIMENS = ("--rig", "specimens", "--kind", "pilot", "--fast", "--plain", "--override-readiness", "a machine that runs tests")


class MovedStudies(program.Case):
    def setUp(self):
        super().setUp()
        self.jnd("new", "study.json", "--task", "which", "--rig", "specimens")
        content = json.loads(self.read("study.json"))
        content["trial"].update(explore_s=0.5, gap_s=0, between_trials_s=0)
        self.write("study.json", content)
        self.shown = ""
        self.process = self.started("run", "study.json", "--study", "s.sqlite", "--participant", "P01", *SPECIMENS,
                                    stdin=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.press(" ")  # the instructions
        for trial in (1, 2, 3):
            self.reads(f"Trial {trial} of")
            self.press("   1")
        self.reads("Trial 4 of")

    def press(self, keys):
        self.process.stdin.write(keys)
        self.process.stdin.flush()

    def reads(self, wanted):
        while wanted not in self.shown:
            line = self.process.stdout.readline()
            self.assertTrue(line, self.shown)
            self.shown += line

    def answered(self, study):
        return self.jnd("status", study, "--json").json["sessions"][0]["trials_done"]

    def test_the_last_words_name_the_file_that_has_the_answers_and_no_command_goes_on_in_another(self):
        os.rename(self.folder / "s.sqlite", self.folder / "away.sqlite")
        self.press(" ")
        self.reads("is now in")
        self.press("    1")
        self.reads("Trial 5 of")
        rest, _ = self.process.communicate()
        words = rest[rest.index("Stopped."):]
        rescued = str(self.folder / "s-rescued.sqlite")
        self.says(words, f"saved in {rescued};", f"--study {rescued} goes on", f"jnd status {rescued}", f"jnd verify {rescued}")
        self.assertNotIn("s.sqlite", words)
        self.assertEqual(self.answered(rescued), 4)
        again = ("run", "study.json", "--study", "s.sqlite", "--participant", "P01", *SPECIMENS)
        self.refused(self.jnd(*again, code=5), "s-rescued.sqlite", "are nowhere else")
        os.rename(self.folder / "away.sqlite", self.folder / "s.sqlite")
        self.refused(self.jnd(*again, code=5), "s-rescued.sqlite", "this file lacks")
        os.rename(rescued, self.folder / "s.sqlite")
        self.says(self.jnd(*again, code=130, input="").said, "Stopped.")

    def test_a_log_that_was_left_behind_goes_into_no_other_file(self):
        self.process.kill()
        self.process.communicate()
        os.rename(self.folder / "s.sqlite", self.folder / "old.sqlite")
        log = self.folder / "s.sqlite-wal"
        left = log.read_bytes()
        self.assertTrue(left)
        responder = ("--responder", "chinello2017", "--fast")
        self.jnd("run", "tutorial", "--study", "one.sqlite", "--participant", "P01", *responder, "--seed", 1)
        self.jnd("run", "tutorial", "--study", "two.sqlite", "--participant", "P02", *responder, "--seed", 2)
        for command in (("run", "tutorial", "--study", "s.sqlite", "--participant", "P01", *responder),
                        ("simulate", "tutorial", "--participants", 1, "--study", "s.sqlite"), ("backup", "one.sqlite", "--to", "s.sqlite"),
                        ("recover", "one.sqlite", "--to", "s.sqlite"), ("merge", "one.sqlite", "two.sqlite", "--to", "s.sqlite")):
            with self.subTest(command):
                self.refused(self.jnd(*command, code=5), "s.sqlite-wal lies beside this name", "put the study back here")
                self.assertFalse((self.folder / "s.sqlite").exists())
        shutil.copy(self.folder / "one.sqlite", self.folder / "s.sqlite")
        for command in ("status", "verify", "analyze", "note"):
            with self.subTest(command):
                self.refused(self.jnd(command, "s.sqlite", *(("words",) if command == "note" else ()), code=5), "s.sqlite-wal",
                             "does not continue this study")
        self.assertEqual((self.folder / "s.sqlite").read_bytes(), (self.folder / "one.sqlite").read_bytes())
        self.assertEqual(log.read_bytes(), left)
        os.rename(self.folder / "old.sqlite", self.folder / "s.sqlite")
        self.assertEqual(self.answered("s.sqlite"), 3)
        self.jnd("verify", "s.sqlite")


if __name__ == "__main__":
    program.main()
