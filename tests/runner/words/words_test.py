#!/usr/bin/env python3
"""The screen's own words: every table has all of them and no other, and a session speaks the language that is asked for."""
import json
import re
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

RUNNER = program.ROOT / "runner"
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


class Words(program.Case):
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
        (self.folder / "s.sqlite").unlink(missing_ok=True)
        return self.jnd("run", "tutorial", "--study", "s.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast",
                        "--plain", "--seed", "1", *options, env=environment).stdout

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
        table = json.loads((RUNNER / "words/languages/de.json").read_text(encoding="utf-8"))
        table["words"]["Trial {} of {}"] = "{1} in allem, jetzt {0}"
        (self.folder / "languages").mkdir()
        self.write("languages/de.json", table)
        self.assertIn("16 in allem, jetzt 1", self.session("--language", "de", environment={"JND_DATA_DIR": str(self.folder)}))


if __name__ == "__main__":
    program.main()
