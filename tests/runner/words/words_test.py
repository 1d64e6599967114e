#!/usr/bin/env python3
"""The screen's own words: every table has all of them and no other, and a session speaks the language that is asked for.

Usage: words_test.py JND
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

JND = os.path.abspath(sys.argv.pop(1))
RUNNER = pathlib.Path(__file__).resolve().parents[3] / "runner"
LITERALS = r'((?:"(?:[^"\\]|\\.)*"\s*)+)'
# Words that the program takes from tables of its own: who entered an answer, what stopped the devices.
OF_TABLES = {"participant", "operator", "key", "button", "signal", "program"}


def words_in_code():
    found = set()
    for places in ("console/*.*", "screen/*.*", "opening/*.cpp", "commands/command_run.cpp"):
        for path in sorted(RUNNER.glob(places)):
            for call in re.finditer(r"\b(?:tr|word)\(\s*" + LITERALS, path.read_text(encoding="utf-8")):
                parts = re.findall(r'"((?:[^"\\]|\\.)*)"', call[1])
                found.add("".join(json.loads(f'"{part}"') for part in parts))
    return found


class Words(unittest.TestCase):
    def test_every_table_has_all_words_and_no_other(self):
        words = words_in_code()
        self.assertGreater(len(words), 250)
        tables = sorted((RUNNER / "words/languages").glob("*.json"))
        self.assertIn("de.json", [path.name for path in tables])
        for path in tables:
            with self.subTest(path.name):
                table = json.loads(path.read_text(encoding="utf-8"))
                self.assertEqual(words | OF_TABLES, set(table["words"]))

    def session(self, *options, environment=None):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([JND, "run", "tutorial", "--study", "s.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast",
                                   "--plain", "--seed", "1", *options], cwd=folder, capture_output=True, text=True,
                                  env=os.environ | (environment or {}))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return done.stdout

    def test_a_session_speaks_the_language_of_its_texts(self):
        english, german = self.session(), self.session("--language", "de")
        self.assertIn("Trial 1 of 16", english)
        self.assertNotIn("Durchgang", english)
        self.assertIn("Durchgang 1 von 16", german)
        self.assertIn("VORFÜHRUNG", german)
        self.assertRegex(english, r"saved: trial 1, (same|different), ")
        self.assertRegex(german, r"gespeichert: Durchgang 1, (gleich|verschieden), ")
        self.assertNotIn("Trial ", german)
        self.assertIn("Fertig. Die Sitzung von P01 ist vollständig", german)
        self.assertRegex(german, r"gespeichert in  s\.sqlite\n  weiter          jnd status s\.sqlite")
        self.assertRegex(english, r"Done\. The session of P01 is complete[^\n]*\n(.*\n)*?  saved in  s\.sqlite\n  next      jnd status s\.sqlite")

    def test_a_language_is_added_by_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            table = json.loads((RUNNER / "words/languages/de.json").read_text(encoding="utf-8"))
            table["words"]["Trial {} of {}"] = "{1} in allem, jetzt {0}"
            places = pathlib.Path(folder, "languages")
            places.mkdir()
            (places / "de.json").write_text(json.dumps(table), encoding="utf-8")
            self.assertIn("16 in allem, jetzt 1", self.session("--language", "de", environment={"JND_DATA_DIR": folder}))


if __name__ == "__main__":
    unittest.main()
