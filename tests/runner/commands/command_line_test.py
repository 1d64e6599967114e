#!/usr/bin/env python3
"""The program from outside: exit codes, messages, JSON shapes, refusals, and what an operator's screen gives away."""
import contextlib
import json
import math
import os
import re
import shutil
import signal
import sqlite3
import stat
import subprocess
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class CommandLine(program.Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.small = program.short_protocol("chinello2017", cls.folder / "small.json", design={"trials_per_cell": 4})

    def study(self, name, *more, participants=3):
        """The study is simulated once; the tests have copies of its file."""
        kept = self.folder / "-".join(["kept", str(participants), *more])
        if not os.path.exists(kept):
            self.jnd("simulate", self.small, "--participants", str(participants), "--study", kept, "--seed", "1", *more)
        return shutil.copy(kept, self.folder / name)

    def test_help_names_every_command_and_gives_examples(self):
        overview = self.jnd("--help").stdout
        for command in ("new", "check", "plan", "run", "simulate", "status", "verify", "analyze", "export", "doctor"):
            self.assertIn(command, overview)
            self.assertIn("Example:", self.jnd(command, "--help").stdout)
        self.assertRegex(self.jnd("--version").stdout, r"^jnd \d+\.\d+\.\d+\n")

    def test_usage_errors_exit_with_2(self):
        for arguments in (("fly",), ("simulate", self.small), ("simulate", self.small, "--study", "x", "--no-study"),
                          ("plan", self.small, "--participant", "0"), ("plan", self.small, "--participant", "many")):
            self.jnd(*arguments, code=2)

    def test_doctor_says_whether_the_machine_is_fit_and_what_to_do(self):
        done = self.jnd("doctor", "--seconds", "0.2", "--json", code=None)
        report = done.json
        self.assertEqual(set(report), {"ok", "checks", "jitter", "rehearsal"})
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
        rehearsal = report["rehearsal"]
        self.assertLessEqual(rehearsal["p99_us"], rehearsal["max_us"])
        # Of the tutorial: two intervals of 2 s, and 0.7 s each to the first contact.
        self.assertAlmostEqual(rehearsal["trial_s"], 5.4)
        expected = 1 - math.exp(-rehearsal["gaps"] / rehearsal["presented_s"] * rehearsal["trial_s"])
        self.assertAlmostEqual(rehearsal["lost_trials"], expected)
        text = self.jnd("doctor", "--seconds", "0.1", "--study", self.folder / "no" / "such" / "s.sqlite", code=1).stdout
        self.assertIn("BAD", text)
        self.assertNotIn("\x1b", text)
        self.jnd("doctor", "--seconds", "0", code=2)

    def test_check_locates_mistakes_and_exits_with_3(self):
        bad = self.folder / "bad.json"
        text = self.read(self.small).replace('"explore_s"', '"explor_s"').replace('"balanced"', '"balancd"')
        self.write(bad, text)
        out = self.jnd("check", bad, code=3).stdout
        self.assertRegex(out, r"bad\.json:\d+:\d+: \$\.trial")
        self.assertIn("explore_s", out)
        report = self.jnd("check", "--json", bad, code=3).json
        self.assertFalse(report["ok"])
        for error in report["errors"]:
            self.assertEqual(set(error), {"file", "line", "column", "path", "message", "suggestion"})
            self.assertGreater(error["line"], 0)
        for command in (("plan", bad), ("simulate", bad, "--no-study"), ("run", bad, "--study", "x.sqlite")):
            self.jnd(*command, code=3)
        self.assertFalse(os.path.exists(self.folder / "x.sqlite"))

    def test_check_accepts_every_shipped_protocol(self):
        for name in ("chinello2017", "chinello2017-balanced", "tutorial"):
            report = self.jnd("check", "--json", name).json
            self.assertTrue(report["ok"])
            self.assertTrue(report["precision"]["conditions"])
            self.assertGreater(report["trials"], 0)
            self.assertGreater(report["duration_s"], 60)

    def test_a_missing_file_says_what_is_shipped(self):
        self.assertIn("chinello2017", self.jnd("check", "nothing-here", code=3).stderr)
        self.jnd("analyze", "nothing.sqlite", code=5)
        self.assertFalse(os.path.exists(self.folder / "nothing.sqlite"))

    def test_new_never_overwrites(self):
        self.jnd("new", "mine.json")
        before = self.read(self.folder / "mine.json")
        self.jnd("new", "mine.json", "--from", "chinello2017", code=2)
        self.assertEqual(self.read(self.folder / "mine.json"), before)

    def test_plan_is_a_pure_function(self):
        one = self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "5", "--json").json
        self.assertEqual(one, self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "5", "--json").json)
        self.assertEqual(len(one["trials"]), 108)
        self.assertEqual(set(one), {"participant", "protocol_sha256", "seed", "trials"})
        self.assertEqual([t["index"] for t in one["trials"]], list(range(1, 109)))
        for trial in one["trials"]:
            self.assertEqual(trial["same"], trial["stimuli"][0] == trial["stimuli"][1])
        other = self.jnd("plan", "chinello2017", "--participant", "7", "--seed", "6", "--json").json
        self.assertNotEqual(one["trials"], other["trials"])

    def test_a_study_from_simulation_to_csv(self):
        study = self.study("whole.sqlite")
        self.assertEqual(stat.S_IMODE(os.stat(study).st_mode), 0o600)
        self.assertFalse(os.path.exists(f"{study}-wal"))
        report = self.jnd("verify", study, "--json").json
        self.assertEqual((report["ok"], report["trials"], report["voided"]), (True, 108, 0))
        status = self.jnd("status", study, "--json").json
        self.assertEqual([s["participant"] for s in status["sessions"]], ["P01", "P02", "P03"])
        self.assertTrue(all(s["state"] == "closed" and s["kind"] == "simulated" and s["trials_done"] == 36 for s in status["sessions"]))
        analysis = self.jnd("analyze", study, "--json").json
        self.assertEqual(len(analysis["estimates"]), 9)
        self.jnd("export", study, "--to", "whole-csv")
        cells = [row for row in self.rows("whole-csv", "cells.csv") if row["participant"] == "P02"]
        self.assertEqual(len(cells), 9)
        # The counts of the CSV are those of the JSON and of the view.
        with contextlib.closing(sqlite3.connect(study)) as connection:
            hits = connection.execute("SELECT count(*) FROM trials WHERE participant = 'P02' AND same = 0 AND answer = 'different'").fetchone()[0]
        self.assertEqual(sum(int(cell["hits"]) for cell in cells), hits)
        self.assertEqual(sum(cell["hits"] for cell in analysis["cells"] if cell["participant"] == "P02"), hits)
        self.jnd("export", study, "--to", "whole-csv", code=5)
        self.jnd("export", study, "--to", "whole-csv", "--replace")

    def test_a_file_in_the_folder_takes_no_shipped_devices_place(self):
        spec = self.jnd("device", "info", "rrs3", "--json").json
        text = self.read(spec["file"])
        own = self.folder / "own"
        own.mkdir()
        self.write(own / "rrs3", text.replace('"max_force_n": 4.7', '"max_force_n": 12'))
        self.write(own / "weak.json", text.replace('"max_force_n": 4.7', '"max_force_n": 3'))
        listed = self.jnd("device", "list", folder=own).stdout
        self.assertIn("at most 4.7 N", listed)
        self.assertNotIn("12 N", listed)
        self.assertIn("12 N is more than a device of this model is ever given, 4.7 N",
                      self.jnd("device", "info", "./rrs3", folder=own, code=3).stderr)
        self.assertIn("not the shipped rrs3", self.jnd("device", "info", "weak.json", folder=own).stdout)
        # The laboratory's own descriptions.
        shutil.copytree(os.path.dirname(spec["file"]), own / "specs")
        os.replace(own / "weak.json", own / "specs" / "rrs3.json")
        options = {"folder": own, "env": {"JND_DATA_DIR": str(own)}}
        simulated = self.jnd("simulate", self.small, "--participants", "1", "--no-study", **options)
        self.assertIn("not the shipped rrs3: rrs3 at most 3 N", simulated.stdout)
        session = self.jnd("run", self.small, "--study", "m.sqlite", "--participant", "P01", "--fast", input="q", code=None, **options)
        self.assertIn("warning limits: rrs3 at most 3 N, 2000 N/m; not the shipped rrs3", session.said)

    def test_streams_that_cannot_be_written(self):
        study = self.study("streams.sqlite", participants=1)
        for arguments in (("status", study), ("verify", study), ("analyze", study, "--json"), ("check", self.small),
                          ("plan", self.small), ("--help",)):
            with open("/dev/full", "w") as full:
                done = self.jnd(*arguments, stdout=full, code=5)
            self.assertIn("could not be written in full: No space left on device", done.stderr)
        shell = lambda words, code: self.jnd("-c", f'"$0" {words}', program.JND, program="bash", code=code)
        # A message that cannot be written changes nothing else.
        shell("status nothing.sqlite 2>/dev/full", 5)
        shell("status nothing.sqlite 2>&-", 5)
        shell(f"simulate {self.small} --participants 1 --seed 1 --study lost.sqlite 2>/dev/full", 0)
        shell(f"simulate {self.small} --participants 1 --seed 1 --study closed.sqlite >&- 2>&-", 5)
        for name in ("lost.sqlite", "closed.sqlite"):
            self.jnd("verify", name)
        # A session whose screen is gone ends, and goes on later.
        shell(f"run {self.small} --study gone.sqlite --participant P01 --responder chinello2017 --fast --seed 1 >/dev/full", 130)
        self.jnd("run", self.small, "--study", "gone.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast")
        self.jnd("verify", "gone.sqlite")

    def test_a_session_ends_in_order_where_nobody_reads_what_it_prints(self):
        def unread(*arguments, code):
            reading, writing = os.pipe()
            os.close(reading)
            with open(writing, "w") as pipe:
                self.jnd(*arguments, stdout=pipe, code=code)
        command = ("run", self.small, "--study", "unread.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast")
        unread(*command, "--plain", "--seed", "1", code=130)
        self.assertEqual(self.jnd("status", "unread.sqlite", "--json").json["sessions"][0]["state"], "open")
        self.jnd(*command)
        self.jnd("verify", "unread.sqlite")
        unread("status", "unread.sqlite", code=-signal.SIGPIPE)

    def test_a_name_that_begins_with_a_dash_is_told_from_an_option(self):
        self.jnd("new", "./-x.json")
        for name in ("-x.json", "--x.json"):
            self.assertIn(f"check has no option {name}; a file of that name is ./{name}", self.jnd("check", name, code=2).stderr)
        self.jnd("check", "./-x.json")
        self.assertIn("check has no option -x\n", self.jnd("check", "-x", code=2).stderr)

    def test_what_to_do_next_is_a_command_that_a_shell_takes(self):
        for name in ("my study.sqlite", "it's $(touch ran).sqlite", "-x.sqlite", "\x1b[2J.sqlite"):
            said = self.jnd("simulate", self.small, "--participants", "2", "--study", f"./{name}" if name[0] == "-" else name, "--seed", "1").stdout
            command = said.partition("  next:  jnd ")[2].strip()
            program.run("-c", f'"$0" {command} >/dev/null', program.JND, program="bash", folder=self.folder)
        self.assertFalse((self.folder / "ran").exists())

    def test_the_first_signal_ends_what_only_computes(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            # Seconds of arithmetic, and standard input that never ends.
            for arguments in (("plan", "chinello2017", "--precision", "--participants", "1000", "--trials", "2000", "--between-cv", "0.5"),
                              ("calc", "sdt", "-")):
                process = self.started(*arguments, stdin=subprocess.PIPE)
                program.until_it_handles(number, process)
                process.send_signal(number)
                self.assertEqual(process.wait(program.GUARD_S), 130, arguments)
                self.assertIn("jnd: interrupted", process.stderr.read())

    def test_what_is_no_file_is_refused_and_nobody_is_waited_for(self):
        pipe = self.folder / "pipe.json"
        os.mkfifo(pipe)
        for thing, words in ((pipe, "is a named pipe"), ("/dev/zero", "is a device"), (f"{self.folder}/", "is a folder")):
            for arguments in (("check", thing), ("simulate", "tutorial", "--no-study", "--profile", thing), ("device", "model", "rrs3", "--batch", thing),
                              ("run", "tutorial", "--study", "no.sqlite", "--participant", "P01", "--rig", thing),
                              ("run", "tutorial", "--study", "no.sqlite", "--participant", "P01", "--buttons", thing)):
                done = self.jnd(*arguments, code=3)
                self.assertIn(words, done.stderr, arguments)
        study = self.study("methods.sqlite", participants=1)
        self.assertIn("is not a file; it was left as it is", self.jnd("analyze", study, "--methods", pipe, code=5).stderr)
        self.assertFalse(os.path.exists(self.folder / "no.sqlite"))

    def test_no_bare_nan_in_json(self):
        study = self.study("json.sqlite")
        for command in (("analyze", study, "--json"), ("status", study, "--json"), ("verify", study, "--json")):
            self.assertTrue(self.jnd(*command).json)

    def test_running_it_again_changes_nothing(self):
        study = self.study("again.sqlite")
        before = self.jnd("status", study, "--json").json
        self.assertIn("had finished before", self.jnd("simulate", self.small, "--participants", "3", "--study", study).stdout)
        self.assertEqual(self.jnd("status", study, "--json").json, before)

    def variant(self, base, name, change):
        """The path of a shipped protocol that was changed."""
        path = self.folder / name
        self.jnd("new", path, "--from", base)
        protocol = json.loads(self.read(path))
        change(protocol)
        self.write(path, json.dumps(protocol, indent=1))
        return path

    def test_check_refuses_what_run_and_simulate_refuse_in_the_same_words(self):
        def with_object(name):
            def change(protocol):
                protocol["rig"].pop("sphere_radius_m", None)
                protocol["rig"]["object"] = name
            return change

        def two_far_apart(protocol):
            protocol["rig"]["separation_m"] = 0.05
            with_object("baseball")(protocol)

        for number, (change, words) in enumerate((
                (with_object("ghost"), "$.rig.object: no object called 'ghost' is shipped"),
                (with_object("wall"), '$.rig.object: "wall" does not lie between two fingers'),
                (two_far_apart, "does not fit between fingers that rest"))):
            path = self.variant("tutorial", f"unfit-{number}.json", change)
            checked = self.jnd("check", path, code=3).stdout
            error = next(line for line in checked.splitlines() if line.startswith("error: "))[len("error: "):]
            self.assertIn(words, error)
            self.assertRegex(error, r"^\S+\.json:[1-9]\d*:\d+: \$\.rig")
            for command in (("run", path, "--participant", "P01", "--responder", "chinello2017", "--fast", "--study", "unfit.sqlite"),
                            ("simulate", path, "--no-study", "--participants", "1"), ("plan", path, "--participant", "1")):
                self.assertIn(error, self.jnd(*command, code=3).stderr)
            self.assertFalse(os.path.exists(self.folder / "unfit.sqlite"))

    def test_check_and_run_refuse_an_object_of_free_interaction_that_does_not_exist(self):
        def with_ghost(protocol):
            protocol["explore"]["objects"][1] = "ghost"
        path = self.variant("chinello2017-experiment2", "ghost.json", with_ghost)
        words = "$.explore.objects[1]: no object called 'ghost' is shipped"
        self.assertIn(words, self.jnd("check", path, code=3).stdout)
        run = ("run", path, "--participant", "P01", "--responder", "chinello2017", "--fast", "--study", "ghost.sqlite")
        self.assertIn(words, self.jnd(*run, code=3).stderr)
        self.assertFalse(os.path.exists(self.folder / "ghost.sqlite"))

    def test_sessions_are_not_counted_as_participants(self):
        def twice(protocol):
            protocol["design"]["sessions"] = 2
            protocol["trial"]["explore_s"] = 0.5
        said = self.jnd("simulate", self.variant("tutorial", "twice.json", twice), "--participants", "3", "--study", "twice.sqlite").stdout
        self.assertIn("twice.sqlite: 3 participants, 2 sessions each, profile chinello2017", said)
        self.assertIn("6 sessions had finished before", self.jnd("simulate", "twice.json", "--participants", "3", "--study", "twice.sqlite").stdout)
        adaptive = self.variant("adaptive-staircase", "adaptive-twice.json", twice)
        result = self.jnd("simulate", adaptive, "--participants", "2", "--no-study", "--json").json
        self.assertEqual({row["n"] for row in result["group"]}, {2}, result["group"])

    def test_free_interaction_shows_how_far_it_is(self):
        def short(protocol):
            protocol["explore"]["duration_s"] = 10
        path = self.variant("chinello2017-experiment2", "short.json", short)
        done = self.jnd("simulate", path, "--participants", "2", "--study", "short.sqlite")
        self.assertIn("simulating explorations: 8 of 8", done.stderr)
        self.assertIn("2 participants", done.stdout)

    def test_refusals_say_what_to_do_and_lose_nothing(self):
        study = self.study("refusals.sqlite")
        size = os.path.getsize(study)
        self.assertIn("another protocol", self.jnd("simulate", "tutorial", "--study", study, code=3).stderr)
        self.assertIn("seed 1", self.jnd("simulate", self.small, "--study", study, "--seed", "2", code=2).stderr)
        self.assertIn("profile", self.jnd("simulate", self.small, "--study", study, "--profile", "chinello2017-varied", code=3).stderr)
        self.assertIn("participant code", self.jnd("run", self.small, "--study", study, "--participant", "../x", code=2).stderr)
        self.assertEqual(os.path.getsize(study), size)
        text = self.folder / "text.sqlite"
        self.write(text, "not a database, but longer than a header would be " * 40)
        self.jnd("analyze", text, code=5)
        self.jnd("simulate", self.small, "--study", text, code=5)
        self.assertTrue(self.read(text).startswith("not a database"))

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
        self.assertEqual(len(re.findall(r"saved: \w+ \d+, (same|different)", done.stdout)), 36)

    def test_a_person_can_stop_and_go_on(self):
        questions = "30\nfemale\nright\nno\n"
        command = ("run", self.small, "--study", "person.sqlite", "--participant", "P01", "--fast", "--seed", "3")
        first = self.jnd(*command, code=130, input=questions + " s d d s q")
        # " s", " d", then "d" is no space: the keys meet the prompts one by one.
        self.assertIn("goes on at the next trial", first.stdout)
        status = self.jnd("status", "person.sqlite", "--json").json["sessions"][0]
        self.assertEqual((status["kind"], status["state"]), ("pilot", "open"))
        self.assertGreaterEqual(status["trials_done"], 2)
        second = self.jnd(*command[:-2], input=" d" * 60 + "\n5\n5\n5\n")
        self.assertIn("complete", second.stdout)
        status = self.jnd("status", "person.sqlite", "--json").json["sessions"][0]
        self.assertEqual((status["state"], status["trials_done"]), ("closed", 36))
        self.jnd("verify", "person.sqlite")
        self.jnd(*command[:-2], code=2)  # this participant has finished

    def test_each_session_has_a_plan_of_its_own(self):
        plan = lambda *more: self.jnd("plan", self.small, "--participant", "2", "--json", *more).json
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
        analysis = self.jnd("analyze", study, "--kind", "simulated", "--json").json
        self.assertEqual({p["participant"] for p in analysis["estimates"]}, {"P01", "P02"})
        self.assertIn("also has", self.jnd("analyze", study, "--kind", "simulated").stdout)
        pilot = self.jnd("analyze", study, "--kind", "pilot", "--json").json
        self.assertEqual({p["participant"] for p in pilot["estimates"]}, {"Q1"})


if __name__ == "__main__":
    program.main()
