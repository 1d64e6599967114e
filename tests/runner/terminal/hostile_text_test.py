#!/usr/bin/env python3
"""Text that a terminal would obey, fed through every input: none of it comes out raw on either stream of any command."""
import json
import os
import re
import shutil
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REAL_STUDY = program.argument()
PROTOCOLS = program.ROOT / "protocols"

# Clears the screen, sets the title, a C1 control sequence, reordered text, a hidden character, a line separator.
TEXT = "x\x1b[2J\x1b]0;t\x07\x9b31m\u202eabc\u2066\u200b\u2028\x7fy"
BYTES = TEXT.encode() + b"\xff\xc0\x80"
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]")


class HostileText(program.Case):
    def jnd(self, *arguments, code=None):
        done = super().jnd(*arguments, code=code, input=b"")
        for stream in (done.stdout, done.stderr):
            try:
                text = stream.decode()  # strict: no byte that is not UTF-8
            except UnicodeDecodeError as error:
                self.fail(f"{arguments}: {error}: {stream!r}")
            found = FORBIDDEN.search(text)
            self.assertIsNone(found, f"{arguments}: {text!r}")
        self.assertGreaterEqual(done.returncode, 0, f"{arguments}: ended by a signal")
        return done.stdout.decode() + done.stderr.decode()

    def protocol(self, **members):
        return json.loads((PROTOCOLS / "tutorial.json").read_text()) | members

    def test_arguments(self):
        commands = self.jnd("--help")
        for argument in (TEXT.encode(), BYTES):
            for arguments in ((argument,), ("--" + "x", argument), (b"--" + argument,), ("new", b"no/" + argument), ("new", "n", "--from", argument),
                              ("check", argument), ("check", argument, "--json"), ("plan", argument), ("plan", "tutorial", "--participant", argument),
                              ("plan", "--study", argument), ("plan", "tutorial", "--precision", "--jnd", argument),
                              ("run", argument, "--study", "s"), ("run", "tutorial", "--study", "s.sqlite", "--participant", argument, "--fast"),
                              ("run", "tutorial", "--study", "s.sqlite", "--participant", "P01", "--responder", argument, "--fast"),
                              ("run", "tutorial", "--study", b"no/" + argument, "--participant", "P01", "--responder", "chinello2017", "--fast"),
                              ("run", "tutorial", "--study", "s.sqlite", "--language", argument, "--participant", "P01"),
                              ("run", "tutorial", "--study", "s.sqlite", "--record", argument, "--participant", "P01"),
                              ("simulate", "tutorial", "--study", b"no/" + argument), ("simulate", "tutorial", "--no-study", "--profile", argument),
                              ("status", argument), ("verify", argument), ("analyze", argument), ("analyze", "s.sqlite", "--kind", argument),
                              ("export", argument, "--to", argument), ("report", argument), ("doctor", "--seconds", "0.1", "--study", argument),
                              ("doctor", "--seconds", "0.1", "--json", "--study", argument), ("help", argument), ("help", "calc", argument),
                              ("studies", argument), ("watch", argument, "--once"), ("diff", argument, "tutorial"), ("completions", argument),
                              ("init", b"no/" + argument), ("new", "n", "--task", argument), ("plan", "tutorial", b"--" + argument),
                              ("calc", argument), ("calc", "sdt", argument), ("calc", "jnd", argument), ("calc", "compare", argument),
                              ("device", argument), ("device", "info", argument), ("device", "test", argument), ("device", "model", argument)):
                self.jnd(*arguments)
            for command in ("note", "exclude", "unblind", "backup", "merge", "recover"):
                if re.search(rf"^\s+{command}\b", commands, re.M):
                    for arguments in ((argument,), (argument, argument), (argument, "--reason", argument), (argument, "--to", argument)):
                        self.jnd(command, *arguments)

    def test_protocol_files(self):
        # Escaped in the JSON, so that they reach the reader as characters; keys and values, rejected or not.
        places = {"title": TEXT, TEXT: 1, "paradigm": TEXT, "notes": [TEXT], "conditions": [{"name": TEXT, "label": TEXT, "cues": [TEXT]}],
                  "questions": [{"id": TEXT, "when": TEXT, "kind": TEXT, "text": TEXT}], "feedback": TEXT, "consent": {"text": TEXT},
                  "translations": {TEXT: {TEXT: TEXT}}, "source": {"citation": TEXT, "doi": TEXT},
                  "published": [{"condition": TEXT, "quantity": TEXT, "value": 1}], "assumed": [{"path": TEXT, "why": TEXT}],
                  "rig": {"device": TEXT, "fingers": [TEXT]}, "breaks": [{"after": TEXT, "say": TEXT}]}
        for key, value in places.items():
            for ascii_only in (True, False):
                self.write("p.json", json.dumps(self.protocol(**{key: value}), ensure_ascii=ascii_only))
                for arguments in (("check", "p.json"), ("check", "p.json", "--json"), ("plan", "p.json"), ("plan", "p.json", "--json"),
                                  ("plan", "p.json", "--cohort", "4"), ("simulate", "p.json", "--no-study")):
                    self.jnd(*arguments)
        for text in (BYTES, b'{"title": "' + BYTES + b'"}', b'{"' + BYTES + b'": 1}', b"[" + BYTES):
            self.write("p.json", text)
            self.jnd("check", "p.json", code=3)

    def test_visible_text_of_other_scripts_stays(self):
        self.write("p.json", json.dumps(self.protocol(title="Steifigkeit für Anfänger: 剛性, жёсткость")))
        self.assertIn("für Anfänger: 剛性, жёсткость", self.jnd("check", "p.json", code=0))

    def test_paths(self):
        file, folder = BYTES + b".sqlite", b"to" + BYTES
        protocol = PROTOCOLS / "tutorial.json"
        super().jnd(file, protocol, "3", "pilot", "2", "0", program=REAL_STUDY)
        shutil.copy(protocol, os.path.join(os.fsencode(self.folder), BYTES + b".json"))
        for arguments in (("status", file), ("status", file, "--json"), ("verify", file), ("verify", file, "--json"), ("analyze", file),
                          ("studies",), ("studies", "--json"), ("watch", file, "--once"), ("diff", "tutorial", BYTES + b".json"),
                          ("analyze", file, "--csv", folder + b"1"), ("export", file, "--to", folder + b"2"), ("export", file, "--to", folder + b"2"),
                          ("report", file, "--to", folder + b".html"), ("report", file, "--to", folder + b".html"), ("plan", "--study", file),
                          ("check", BYTES + b".json"), ("check", BYTES + b".json", "--json"), ("plan", BYTES + b".json"),
                          ("simulate", BYTES + b".json", "--study", file), ("new", BYTES + b"2.json")):
            self.jnd(*arguments)

    def test_profiles_and_tables(self):
        profile = json.loads((program.ROOT / "devices/profiles/chinello2017.json").read_text())
        for key, value in (("title", TEXT), (TEXT, 1), ("source", TEXT), ("ratings", {TEXT: {"mean": TEXT, "sd": 1}}), ("answers", {TEXT: {TEXT: 1}})):
            self.write("p.json", json.dumps({**profile, key: value}))
            self.jnd("simulate", "tutorial", "--no-study", "--profile", "./p.json")
        header = b"participant,condition,series,hits,n_diff,false_alarms,n_same\n"
        for text in (BYTES + b",x\n1,2\n", header + TEXT.encode() + b",a,1,3,4,1,4\n", header + BYTES + b",a,b\n", b"item,a,b\n" + TEXT.encode() + b",1,2\n"):
            self.write("t.csv", text)
            for command in ("sdt", "jnd", "compare", "wilcoxon", "fit"):
                self.jnd("calc", command, "t.csv")
                self.jnd("calc", command, "t.csv", "--json")


if __name__ == "__main__":
    program.main()
