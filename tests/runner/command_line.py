#!/usr/bin/env python3
"""The program from outside: exit codes, messages, JSON shapes, refusals, and what an operator's screen gives away.

Usage: command_line.py JND
"""
import contextlib
import csv
import json
import os
import re
import sqlite3
import stat
import subprocess
import sys
import tempfile
import unittest

JND = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else None


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = cls.folder.name
        cls.small = os.path.join(cls.path, "small.json")
        cls.jnd_class("new", cls.small, "--from", "chinello2017")
        protocol = json.loads(read(cls.small))
        for key in ("assumed", "checklist"):
            protocol.pop(key)
        protocol["design"]["trials_per_cell"] = 4
        protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1)
        write(cls.small, json.dumps(protocol, indent=1))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def jnd_class(cls, *arguments, **options):
        return subprocess.run([JND, *arguments], capture_output=True, text=True, cwd=cls.path, **options)

    def jnd(self, *arguments, code=0, **options):
        done = self.jnd_class(*arguments, **options)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        return done

    def study(self, name, *more, participants=3):
        self.jnd("simulate", self.small, "--participants", str(participants), "--study", name, "--seed", "1", *more)
        return os.path.join(self.path, name)

    def test_help_names_every_command_and_gives_examples(self):
        overview = self.jnd("--help").stdout
        for command in ("new", "check", "plan", "run", "simulate", "status", "verify", "analyze", "export", "doctor"):
            self.assertIn(command, overview)
            self.assertIn("Example:", self.jnd(command, "--help").stdout)
        self.assertRegex(self.jnd("--version").stdout, r"^jnd \d+\.\d+\.\d+\n$")

    def test_usage_errors_exit_with_2(self):
        for arguments in ((), ("fly",), ("simulate", self.small), ("simulate", self.small, "--study", "x", "--no-study"),
                          ("plan", self.small, "--participant", "0"), ("plan", self.small, "--participant", "many")):
            self.assertEqual(self.jnd_class(*arguments).returncode, 2, arguments)

    def test_doctor_says_whether_the_machine_is_fit_and_what_to_do(self):
        done = self.jnd_class("doctor", "--seconds", "0.2", "--json")
        report = json.loads(done.stdout, parse_constant=lambda name: self.fail(name))
        self.assertEqual(set(report), {"ok", "checks", "jitter"})
        verdicts = {check["name"]: check["verdict"] for check in report["checks"]}
        self.assertLessEqual({"kernel", "processors", "clock source", "HID devices", "study folder"}, set(verdicts))
        # A busy or restricted machine may be unfit; the exit code says what the report does.
        self.assertEqual(report["ok"], "bad" not in verdicts.values())
        self.assertEqual(done.returncode, 0 if report["ok"] else 1)
        for check in report["checks"]:
            self.assertIn(check["verdict"], ("ok", "warn", "bad"))
            self.assertTrue(check["found"])
            self.assertEqual(check["verdict"] != "ok", bool(check["what_to_do"]), check)
        jitter = report["jitter"]
        self.assertLessEqual(jitter["p50_us"], jitter["p99_us"])
        self.assertGreater(jitter["ticks"], 0)
        self.assertGreaterEqual(jitter["ticks"] + jitter["overruns"], 200)
        text = self.jnd("doctor", "--seconds", "0.1", "--study", os.path.join(self.path, "no", "such", "s.sqlite"), code=1).stdout
        self.assertIn("BAD", text)
        self.assertNotIn("\x1b", text)
        self.jnd("doctor", "--seconds", "0", code=2)

    def test_check_locates_mistakes_and_exits_with_3(self):
        bad = os.path.join(self.path, "bad.json")
        text = read(self.small).replace('"explore_s"', '"explor_s"').replace('"balanced"', '"balancd"')
        write(bad, text)
        out = self.jnd("check", bad, code=3).stdout
        self.assertRegex(out, r"bad\.json:\d+:\d+: \$\.trial")
        self.assertIn("explore_s", out)
        report = json.loads(self.jnd("check", "--json", bad, code=3).stdout)
        self.assertFalse(report["ok"])
        for error in report["errors"]:
            self.assertEqual(set(error), {"file", "line", "column", "path", "message", "suggestion"})
            self.assertGreater(error["line"], 0)
        for command in (("plan", bad), ("simulate", bad, "--no-study"), ("run", bad, "--study", "x.sqlite")):
            self.jnd(*command, code=3)
        self.assertFalse(os.path.exists(os.path.join(self.path, "x.sqlite")))

    def test_check_accepts_every_shipped_protocol(self):
        for name in ("chinello2017", "chinello2017-balanced", "tutorial"):
            report = json.loads(self.jnd("check", "--json", name).stdout)
            self.assertTrue(report["ok"])
            self.assertTrue(report["precision"]["conditions"])
            self.assertGreater(report["trials"], 0)
            self.assertGreater(report["duration_s"], 60)

    def test_a_missing_file_says_what_is_shipped(self):
        self.assertIn("chinello2017", self.jnd("check", "nothing-here", code=3).stderr)
        self.jnd("analyze", "nothing.sqlite", code=5)
        self.assertFalse(os.path.exists(os.path.join(self.path, "nothing.sqlite")))

    def test_new_never_overwrites(self):
        self.jnd("new", "mine.json")
        before = read(os.path.join(self.path, "mine.json"))
        self.jnd("new", "mine.json", "--from", "chinello2017", code=2)
        self.assertEqual(read(os.path.join(self.path, "mine.json")), before)

    def test_plan_is_a_pure_function(self):
        one = json.loads(self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "5", "--json").stdout)
        self.assertEqual(one, json.loads(self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "5", "--json").stdout))
        self.assertEqual(len(one["trials"]), 108)
        self.assertEqual(set(one), {"participant", "protocol_sha256", "seed", "trials"})
        self.assertEqual([t["index"] for t in one["trials"]], list(range(1, 109)))
        for trial in one["trials"]:
            self.assertEqual(trial["same"], trial["stimuli"][0] == trial["stimuli"][1])
        other = json.loads(self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "6", "--json").stdout)
        self.assertNotEqual(one["trials"], other["trials"])

    def test_a_study_from_simulation_to_csv(self):
        study = self.study("whole.sqlite")
        self.assertEqual(stat.S_IMODE(os.stat(study).st_mode), 0o600)
        self.assertFalse(os.path.exists(study + "-wal"))
        report = json.loads(self.jnd("verify", study, "--json").stdout)
        self.assertEqual((report["ok"], report["trials"], report["voided"]), (True, 108, 0))
        status = json.loads(self.jnd("status", study, "--json").stdout)
        self.assertEqual([s["participant"] for s in status["sessions"]], ["P01", "P02", "P03"])
        self.assertTrue(all(s["state"] == "closed" and s["kind"] == "simulated" and s["trials_done"] == 36 for s in status["sessions"]))
        analysis = json.loads(self.jnd("analyze", study, "--json").stdout)
        self.assertEqual(len(analysis["participants"]), 9)
        self.jnd("export", study, "--to", "whole-csv")
        with open(os.path.join(self.path, "whole-csv", "sub-P02", "cells.csv"), newline="") as file:
            cells = list(csv.DictReader(file))
        self.assertEqual(len(cells), 9)
        # The counts of the CSV are those of the JSON and of the view.
        with contextlib.closing(sqlite3.connect(study)) as connection:
            hits = connection.execute("SELECT count(*) FROM trials WHERE participant = 'P02' AND same = 0 AND answer = 'different'").fetchone()[0]
        self.assertEqual(sum(int(cell["hits"]) for cell in cells), hits)
        self.assertEqual(sum(c["hits"] for p in analysis["participants"] if p["participant"] == "P02" for c in p["cells"]), hits)
        self.jnd("export", study, "--to", "whole-csv", code=5)
        self.jnd("export", study, "--to", "whole-csv", "--replace")

    def test_no_bare_nan_in_json(self):
        study = self.study("json.sqlite")
        for command in (("analyze", study, "--json"), ("status", study, "--json"), ("verify", study, "--json")):
            out = self.jnd(*command).stdout
            json.loads(out, parse_constant=lambda name: self.fail(f"{command} prints {name}"))

    def test_running_it_again_changes_nothing(self):
        study = self.study("again.sqlite")
        before = json.loads(self.jnd("status", study, "--json").stdout)
        self.assertIn("had finished before", self.jnd("simulate", self.small, "--participants", "3", "--study", study).stdout)
        self.assertEqual(json.loads(self.jnd("status", study, "--json").stdout), before)

    def test_refusals_say_what_to_do_and_lose_nothing(self):
        study = self.study("refusals.sqlite")
        size = os.path.getsize(study)
        self.assertIn("another protocol", self.jnd("simulate", "tutorial", "--study", study, code=3).stderr)
        self.assertIn("seed 1", self.jnd("simulate", self.small, "--study", study, "--seed", "2", code=2).stderr)
        self.assertIn("profile", self.jnd("simulate", self.small, "--study", study, "--profile", "chinello2017-varied", code=3).stderr)
        self.assertIn("participant code", self.jnd("run", self.small, "--study", study, "--participant", "../x", code=2).stderr)
        self.assertEqual(os.path.getsize(study), size)
        text = os.path.join(self.path, "text.sqlite")
        write(text, "not a database, but longer than a header would be " * 40)
        self.jnd("analyze", text, code=5)
        self.jnd("simulate", self.small, "--study", text, code=5)
        self.assertTrue(read(text).startswith("not a database"))

    def test_a_changed_answer_is_found(self):
        study = self.study("tampered.sqlite")
        with contextlib.closing(sqlite3.connect(study)) as connection:
            names = [row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'")]
            self.assertTrue(names)
            with self.assertRaises(sqlite3.DatabaseError):
                connection.execute("UPDATE event SET body = replace(body, '\"answer\":\"same\"', '\"answer\":\"different\"')")
            with self.assertRaises(sqlite3.DatabaseError):
                connection.execute("DELETE FROM event")
            for name in names:
                connection.execute(f"DROP TRIGGER {name}")
            changed = connection.execute("UPDATE event SET body = replace(body, '\"answer\":\"same\"', '\"answer\":\"different\"') "
                                         "WHERE rowid = (SELECT min(rowid) FROM event WHERE kind = 'trial.completed' AND body LIKE '%\"answer\":\"same\"%')").rowcount
            connection.commit()
        self.assertGreater(changed, 0)
        self.assertIn("problem", self.jnd("verify", study, code=1).stdout)

    def test_the_operator_sees_no_stimulus_and_no_condition_name(self):
        done = self.jnd("run", self.small, "--study", "demo.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast", "--seed", "3")
        text = re.sub(r"demo\.sqlite|\d+\.\d+ s\b", "", done.stdout.split("Trial 1 of 36")[1])
        text = text.split("about condition")[0]  # the ratings after the last trial name the conditions
        for secret in ("500", "600", "700", "900", "N/m", "SV", "servo", "motor", "hit", "correct"):
            self.assertNotIn(secret, text)
        self.assertEqual(len(re.findall(r"saved: (same|different)", done.stdout)), 36)

    def test_a_person_can_stop_and_go_on(self):
        questions = "30\nfemale\nright\nno\n"
        command = ("run", self.small, "--study", "person.sqlite", "--participant", "P01", "--fast", "--seed", "3")
        first = self.jnd(*command, code=130, input=questions + " s d d s q")
        # " s", " d", then "d" is no space: the keys meet the prompts one by one.
        self.assertIn("goes on at the next trial", first.stdout)
        status = json.loads(self.jnd("status", "person.sqlite", "--json").stdout)["sessions"][0]
        self.assertEqual((status["kind"], status["state"]), ("pilot", "open"))
        self.assertGreaterEqual(status["trials_done"], 2)
        second = self.jnd(*command[:-2], input=" d" * 60 + "\n5\n5\n5\n")
        self.assertIn("complete", second.stdout)
        status = json.loads(self.jnd("status", "person.sqlite", "--json").stdout)["sessions"][0]
        self.assertEqual((status["state"], status["trials_done"]), ("closed", 36))
        self.jnd("verify", "person.sqlite")
        self.jnd(*command[:-2], code=2)  # this participant has finished

    def test_each_session_has_a_plan_of_its_own(self):
        plan = lambda *more: json.loads(self.jnd("plan", self.small, "--participant", "2", "--json", *more).stdout)
        first, again, second = plan(), plan("--session", "1"), plan("--session", "2")
        self.assertEqual(first, again)
        self.assertNotIn("session", first)
        self.assertEqual(second["session"], 2)
        order = lambda one: list(dict.fromkeys(trial["series"] for trial in one["trials"]))
        self.assertEqual(order(second), order(first)[::-1])
        self.assertIn("session 2", self.jnd("plan", self.small, "--cohort", "18", "--session", "2").stdout)
        self.jnd("plan", self.small, "--session", "0", code=2)

    def test_the_three_kinds_are_never_pooled(self):
        study = self.study("kinds.sqlite", participants=2)
        self.jnd("run", self.small, "--study", study, "--participant", "Q1", "--fast", code=130, input="30\nmale\nleft\nyes\n s d d s q")
        analysis = json.loads(self.jnd("analyze", study, "--kind", "simulated", "--json").stdout)
        self.assertEqual({p["participant"] for p in analysis["participants"]}, {"P01", "P02"})
        self.assertIn("also has", self.jnd("analyze", study, "--kind", "simulated").stdout)
        pilot = json.loads(self.jnd("analyze", study, "--kind", "pilot", "--json").stdout)
        self.assertEqual({p["participant"] for p in pilot["participants"]}, {"Q1"})


if __name__ == "__main__":
    unittest.main()
