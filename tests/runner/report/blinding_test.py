#!/usr/bin/env python3
"""What a blinded study gives away: every command in every format is searched for conditions, stimuli and the seed."""
import collections
import concurrent.futures
import json
import os
import re
import shutil
import sys
import time

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REAL_STUDY = program.argument()
SEED = "9182736455463728190"
NAMES = ("Qforce", "Qvibro", "Qboth")
LABELS = ("the motors alone", "the buzzer alone", "motors and buzzer")
SERIES = ("zest1", "zest2", "zest3")
STIFFNESS = (413, 517, 619, 937)
PUBLISHED = ("271.75", "333.25")


def secret_patterns():
    patterns = [re.escape(word) for word in (*NAMES, *LABELS, *SERIES, SEED, *PUBLISHED)]
    # A number of its own: not part of a hash, of a longer number or of its decimals.
    return patterns + [rf"(?<![\w.]){value}(\.0+)?(?![\w.])" for value in STIFFNESS]


def protocol_text(participants, blinding="coded", **members):
    protocol = json.loads((program.ROOT / "protocols/chinello2017.json").read_text())
    for key in ("assumed", "notes", "source"):
        protocol.pop(key, None)
    protocol["source"] = {"citation": "Made for a test."}
    protocol["title"] = "Blinding"
    protocol["stimulus"]["reference"] = STIFFNESS[3]
    for condition, name, label in zip(protocol["conditions"], NAMES, LABELS):
        condition.update(name=name, label=label)
    for series, name, softer in zip(protocol["series"], SERIES, STIFFNESS):
        series.update(name=name, pair=[softer, STIFFNESS[3]])
    protocol["series"] = protocol["series"][:3]
    protocol["design"].update(participants=participants)
    protocol["published"] = [{"condition": NAMES[0], "quantity": "jnd", "value": float(PUBLISHED[0])},
                             {"condition": NAMES[1], "quantity": "jnd", "value": float(PUBLISHED[1])}]
    protocol["analysis"]["contrasts"] = [[NAMES[0], NAMES[2]]]
    protocol["blinding"] = blinding
    protocol.update(members)
    return json.dumps(protocol, indent=1)


class Blinding(program.Case):
    def setUp(self):
        self.write_protocol(6)

    def write_protocol(self, *arguments, **members):
        self.write("protocol.json", protocol_text(*arguments, **members))

    def jnd(self, *arguments, code=0):
        """Everything that a command gives: both streams, and every file it writes."""
        before = self.files()
        done = super().jnd(*arguments, code=code)
        written = [self.named(name) for name in sorted(self.files() - before) if not re.search(r"\.sqlite(-wal|-shm)?$", name)]
        return "\n".join([done.stdout, done.stderr, *written])

    def files(self):
        return {os.path.relpath(os.path.join(where, name), self.folder)
                for where, _, names in os.walk(self.folder) for name in names}

    def named(self, name):
        return f"{name}\n{self.read(name)}"

    def trials_of(self, folder):
        """How many rows trials.csv has of each participant."""
        return collections.Counter(row["participant"] for row in self.rows(folder, "trials.csv"))

    def study(self, kind, finished, unfinished, how="whole"):
        program.run("s.sqlite", "protocol.json", SEED, kind, finished, unfinished, how, program=REAL_STUDY, folder=self.folder)

    def commands(self):
        """(arguments, exit code while blinded, whether the whole output may show secrets once it is not)"""
        number = iter(range(1000))
        new = lambda what: f"{what}-{next(number)}"
        return [
            (("status", "s.sqlite"), 0, (SEED,)),
            (("status", "s.sqlite", "--json"), 0, (SEED,)),
            (("studies", "--json"), 0, ()),
            (("watch", "s.sqlite", "--once"), 0, ()),
            (("verify", "s.sqlite"), 0, ()),
            (("verify", "s.sqlite", "--json"), 0, ()),
            (("analyze", "s.sqlite"), 0, (*NAMES, SEED, "271.75")),
            (("analyze", "s.sqlite", "--kind", "real", "--by", "delivered"), 0, NAMES),
            (("analyze", "s.sqlite", "--json"), 0, NAMES),
            (("analyze", "s.sqlite", "--cells"), 2, SERIES),
            (("analyze", "s.sqlite", "--models"), 2, NAMES),
            (("analyze", "s.sqlite", "--models", "--json"), 2, NAMES),
            (("analyze", "s.sqlite", "--methods", new("methods") + ".md"), 2, SEED),
            (("analyze", "s.sqlite", "--csv", new("csv")), 0, NAMES),
            (("export", "s.sqlite", "--to", new("export")), 0, (*NAMES, SEED, "413")),
            (("export", "s.sqlite", "--to", new("export"), "--by", "delivered"), 0, NAMES),
            (("export", "s.sqlite", "--to", new("export"), "--telemetry"), 2, NAMES),
            (("report", "s.sqlite", "--to", new("report") + ".html"), 0, (*NAMES, LABELS[0], SEED)),
            (("plan", "--study", "s.sqlite", "--participant", "1"), 0, (*NAMES, "413", SEED)),
            (("plan", "--study", "s.sqlite", "--participant", "7", "--json"), 0, (*NAMES, "413", SEED)),
            (("plan", "--study", "s.sqlite", "--cohort", "1"), 2, NAMES),
        ]

    def assert_silent(self, text, arguments):
        for pattern in secret_patterns():
            found = re.search(pattern, text)
            self.assertIsNone(found, f"{arguments} shows {pattern}: ...{text[max(0, (found.start() if found else 0) - 80):][:200]}")

    def test_no_command_shows_a_secret_until_the_study_is_unblinded(self):
        self.study("real", 4, 1)
        for arguments, code, _ in self.commands():
            with self.subTest(arguments=arguments):
                text = self.jnd(*arguments, code=code)
                self.assert_silent(text, arguments)
                if arguments[0] not in ("verify", "watch") and "--json" not in arguments:
                    self.assertIn("BLINDED: 4 of 6 planned participants finished, 1 real session open", text)
                    self.assertIn('unblind s.sqlite --reason', text)
        # Refusals say nothing either; a wrong seed is refused without the right one.
        for arguments in (("simulate", "protocol.json", "--study", "s.sqlite"),
                          ("simulate", "protocol.json", "--study", "s.sqlite", "--seed", "5"),
                          ("run", "protocol.json", "--study", "s.sqlite", "--participant", "P09", "--responder", "chinello2017",
                           "--fast", "--seed", "5")):
            self.assert_silent(self.jnd(*arguments, code=2), arguments)
        self.jnd("unblind", "s.sqlite", "--reason", "the registered interim look")
        for arguments, _, shown in self.commands():
            with self.subTest(arguments=arguments, unblinded=True):
                again = tuple(a.replace("-", "-open-", 1) if a.startswith(("csv-", "export-", "report-", "methods-")) else a
                              for a in arguments)
                text = self.jnd(*again)
                self.assertNotIn("BLINDED", text)
                self.says(text, *((shown,) if isinstance(shown, str) else shown))

    def test_blinded_results_are_coded_and_in_the_order_of_the_codes(self):
        self.study("real", 4, 1, "taken-back")
        result = json.loads(self.jnd("analyze", "s.sqlite", "--json"))
        self.assertEqual([row["condition_code"] for row in result["coded"]], ["A", "B", "C"])
        self.assertEqual({row["status"] for row in result["coded"]}, {"ok"})
        self.assertEqual([row["state"] for row in result["monitoring"]], ["finished"] * 4 + ["not finished"])
        self.assertTrue(result["blinding"]["blinded"])
        plan = json.loads(self.jnd("plan", "--study", "s.sqlite", "--json"))
        self.assertEqual(set(plan["trials"][0]), {"index", "block", "condition_code", "practice"})
        self.assertEqual({trial["condition_code"] for trial in plan["trials"]}, {"A", "B", "C"})
        self.assertIsNone(plan["seed"])
        self.jnd("export", "s.sqlite", "--to", "x")
        for name in ("x/monitoring.csv", "x/dictionary.csv", "x/datapackage.json"):  # limits follow from forces
            self.assertNotIn("saturated", self.named(name))
        for name in ("intervals.csv", "voided.csv", "recompute.py"):  # neither what was felt, nor what did not count
            self.assertFalse(os.path.exists(self.folder / "x" / name), name)
        self.assertNotIn("saturated", json.dumps(result))
        self.assertNotIn("saturated", self.jnd("analyze", "s.sqlite"))
        header = self.named("x/trials.csv").splitlines()[1]
        for column in ("stimulus", "same", "correct", "answer", "force", "saturated", "series"):
            self.assertNotIn(column, header)

    def test_practice_has_no_letter(self):
        """Practice takes the conditions in the protocol's own order: its letters would be the key to all of them."""
        self.write_protocol(6, practice={"trials": 4, "series": SERIES[2], "conditions": list(NAMES),
                                         "criterion_correct": 0.5, "max_rounds": 2})
        self.study("real", 2, 0)
        plan = json.loads(self.jnd("plan", "--study", "s.sqlite", "--json"))["trials"]
        self.assertEqual([trial["condition_code"] for trial in plan if trial["practice"]], [None] * 8)
        self.assertEqual({trial["condition_code"] for trial in plan if not trial["practice"]}, {"A", "B", "C"})
        lines = [line.split() for line in self.jnd("plan", "--study", "s.sqlite").splitlines() if "practice round" in line]
        self.assertEqual([line[1:3] for line in lines], [["-", "-"]] * 8)
        self.jnd("export", "s.sqlite", "--to", "x")
        rows = self.rows("x/trials.csv")
        self.assertEqual({row["condition_code"] for row in rows if row["practice"] == "1"}, {""})
        self.assertEqual({row["condition_code"] for row in rows if row["practice"] == "0"}, {"A", "B", "C"})
        self.assertNotIn("attempt", rows[0])  # repeated at a device's limit, which the force of the stimulus reaches

    def test_the_console_shows_no_letter_in_practice(self):
        self.write_protocol(6, practice={"trials": 4, "series": SERIES[2], "conditions": list(NAMES),
                                         "criterion_correct": 0.5, "max_rounds": 1})
        shown = self.jnd("run", "protocol.json", "--study", "s.sqlite", "--participant", "P01", "--responder",
                         "chinello2017", "--fast", "--seed", SEED)
        heads = [line for line in shown.splitlines() if re.match(r"(Practice|Trial) \d+ of", line)]
        practice = [line for line in heads if line.startswith("Practice")]
        self.assertEqual(len(practice), 4)
        for line in practice:
            self.assertNotIn("condition", line)
        self.assertTrue(all("condition " in line for line in heads if line.startswith("Trial")))

    def test_coded_trials_leave_out_the_excluded_and_what_was_taken_back(self):
        self.study("real", 3, 0)
        self.jnd("exclude", "s.sqlite", "--participant", "P02", "--kind", "real", "--reason", "took the blindfold off")
        self.jnd("export", "s.sqlite", "--to", "x")
        self.assertEqual(set(self.trials_of("x")), {"P01", "P03"})
        self.assertNotIn("blindfold", self.named("x/participants.csv"))  # what was said of somebody may hint at what they felt
        self.study("real", 1, 0, "taken-back")
        self.jnd("export", "s.sqlite", "--to", "y")
        rows = [self.trials_of("y")[code] for code in ("P01", "P04")]
        self.assertEqual(rows[0] - rows[1], 1)

    def test_a_session_that_was_ended_early_finishes_nobody(self):
        self.study("real", 5, 0)
        self.study("real", 1, 0, "ended-early")
        text = self.jnd("analyze", "s.sqlite")
        self.assertIn("BLINDED: 5 of 6 planned participants finished, 0 real sessions open", text)
        result = json.loads(self.jnd("analyze", "s.sqlite", "--json"))
        self.assertEqual([row["state"] for row in result["monitoring"]], ["finished"] * 5 + ["ended early"])
        self.jnd("export", "s.sqlite", "--to", "x")
        self.assertEqual([row["state"] for row in self.rows("x", "monitoring.csv")], ["finished"] * 5 + ["ended early"])

    def test_a_mean_of_few_is_nobodys_own_result(self):
        self.study("real", 2, 0)
        result = json.loads(self.jnd("analyze", "s.sqlite", "--json"))
        self.assertEqual({row[key] for row in result["coded"] for key in ("n", "mean")}, {None})
        self.assertEqual({row["status"] for row in result["coded"]}, {"too_few_participants"})

    def test_a_complete_study_and_an_open_protocol_are_not_blinded(self):
        self.study("real", 6, 0)
        self.assertIn(NAMES[0], self.jnd("analyze", "s.sqlite"))
        self.assertIn(SEED, self.jnd("status", "s.sqlite"))
        os.remove(self.folder / "s.sqlite")
        self.write_protocol(6, "open")
        self.study("real", 2, 1)
        self.assertIn(NAMES[0], self.jnd("analyze", "s.sqlite"))
        self.assertIn(SEED, self.jnd("status", "s.sqlite"))

    def test_rehearsals_that_stand_alone_are_not_coded(self):
        for kind in ("pilot", "simulated"):
            self.study(kind, 2, 1)
            text = self.jnd("analyze", "s.sqlite", "--kind", kind)
            self.says(text, *NAMES)
            # Trial by trial a rehearsal is the plan that people are to have in the same file.
            page = self.jnd("report", "s.sqlite", "--to", f"{kind}.html")
            self.says(page, *NAMES)
            self.assertEqual("Every answer" in page, kind == "simulated")
            self.jnd("report", "s.sqlite", "--to", "press.html", "--press", "P01:9", code=2)
            if kind == "simulated":
                self.assertIn(SEED, text)
                self.jnd("export", "s.sqlite", "--kind", kind, "--to", kind)
                self.assertIn("413", self.named(f"{kind}/trials.csv"))
                self.assertIn(NAMES[0], self.named(f"{kind}/answers.csv"))
            os.remove(self.folder / "s.sqlite")

    def test_a_study_of_pilot_sessions_alone_keeps_the_plan_that_people_will_have(self):
        self.study("pilot", 1, 0)
        for number in ("1", "2", "7"):
            self.assert_silent(self.jnd("plan", "--study", "s.sqlite", "--participant", number), number)
        self.assertNotIn(SEED, self.jnd("status", "s.sqlite"))
        # What is said to be open is what the table below shows to be open.
        self.study("pilot", 0, 1)
        status = self.jnd("status", "s.sqlite")
        self.assertIn("0 real sessions open", status)
        self.assertRegex(status, r"pilot +open ")
        self.jnd("simulate", "protocol.json", "--study", "s.sqlite", code=2)

    def test_rehearsals_beside_real_sessions_are_coded_too(self):
        """Participant n of every kind has the same plan: by name, trial by trial, it would decode all letters."""
        for kind in ("pilot", "simulated", "real"):
            self.study(kind, 3, 1)
        for kind in ("pilot", "simulated"):
            for arguments in (("analyze", "s.sqlite"), ("analyze", "s.sqlite", "--json"), ("report", "s.sqlite", "--to", f"{kind}.html"),
                              ("export", "s.sqlite", "--to", kind)):
                self.assert_silent(self.jnd(*arguments, "--kind", kind), arguments)
            result = json.loads(self.jnd("analyze", "s.sqlite", "--kind", kind, "--json"))
            self.assertEqual((result["kind"], len(result["monitoring"]), result["coded"]), (kind, 4, []))
            self.assertFalse(os.path.exists(self.folder / f"{kind}-figures"))
            for refused in (("report", "s.sqlite", "--to", "x.html", "--press", "P01:9"), ("analyze", "s.sqlite", "--cells"),
                            ("export", "s.sqlite", "--to", "x", "--telemetry")):
                self.assert_silent(self.jnd(*refused, "--kind", kind, code=2), refused)
        self.jnd("unblind", "s.sqlite", "--reason", "the registered interim look")
        self.says(self.jnd("report", "s.sqlite", "--to", "open.html", "--kind", "pilot"), *NAMES)

    def test_an_open_session_has_no_head(self):
        """From one trial to the next it would be the hash of a single event."""
        self.study("real", 1, 1)
        shown = {row["participant"]: row["head"] for row in json.loads(self.jnd("status", "s.sqlite", "--json"))["sessions"]}
        self.assertEqual((len(shown["P01"]), shown["P02"]), (64, None))
        self.jnd("export", "s.sqlite", "--to", "x")
        self.assertEqual([len(row["head"]) for row in self.rows("x", "sessions.csv")], [64, 0])
        copied = json.loads(self.jnd("backup", "s.sqlite", "--to", "copy.sqlite", "--json").split("\n")[0])
        self.assertEqual([len(row["head"]) for row in copied["heads"]], [64, 0])

    def test_nor_has_an_open_rehearsal(self):
        self.study("pilot", 1, 1)
        heads = super().jnd("analyze", "s.sqlite", "--kind", "pilot", "--json", "--methods", "methods.md").json["heads"]
        self.assertEqual([(row["closed"], row["hash"] is None) for row in heads], [(True, False), (False, True)])
        self.assertIn("  - P02 `sealed` (not finished)\n", (self.folder / "methods.md").read_text())


# What arguments and options take; words alone, and 1 for everything else. A new command needs nothing here.
TAKES = {"STUDY": ["s.sqlite"], "STUDIES": [("s.sqlite", "other.sqlite")], "DAMAGED": ["s.sqlite"], "FILE": ["new"],
         "FOLDER": ["new"], "PROTOCOL": ["protocol.json"], "CODE": ["P01"], "CODE:TRIAL": ["P01:9"]}
# `run` goes on with a session and ends before its first answer: whole sessions are in twin_session_test.cpp, on a clock of the test's own.
TAKEN_BY = {"studies": {"FOLDER": ["."]}, "watch": {"--once": [()]}, "plan": {"PROTOCOL": [()]},
            "run": {"--participant": ["P02"], "--accept-gap": ["why"], "--override-readiness": ["why"], "--kind": ["pilot"]}}
WITHOUT_STUDY = {"init", "new", "check", "combine", "cluster", "diff", "device", "doctor", "calc", "completions", "man"}
REFUSED = {"simulate", "merge"}  # while it is blinded; of the same participants twice
# A study's size is unavoidable (runner/README.md), and how fast this machine is just now; everything beside it is compared.
BESIDE = {"backup": r'\d+ bytes|"bytes":\d+', "recover": r'\d+ of \d+ pages|"pages":\d+',
          "run": r"(?m)^(?:ok|warning|BAD) (?:loop|study folder): .*\n(?:  -> .*\n)?|^  this run .*"}
BEGAN = 1_700_000_001  # the first session of real_study, in seconds of UTC


class Twins(program.Case):
    """Two studies that look the same (twin_plan.h), with the same answers at the same times: until they are unblinded nothing that
    any command gives tells one from the other."""

    def make_twins(self, finished, participants):
        self.write("protocol.json", protocol_text(6))
        twin = program.run("--twin", "protocol.json", SEED, participants, program=REAL_STUDY, folder=self.folder).stdout.strip()
        for name, seed in (("a", SEED), ("b", twin)):
            for kind in ("real", "pilot", "simulated"):
                program.run(f"{name}.sqlite", "protocol.json", seed, kind, finished, participants - finished, "by-place",
                            program=REAL_STUDY, folder=self.folder)

    def given(self, name, arguments):
        """Exit code, both streams, and every file but studies. Hashes are masked by their form, and nothing else is."""
        place = self.folder / name
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        for study in ("s", "other"):
            shutil.copy(self.folder / f"{name}.sqlite", place / f"{study}.sqlite")
        shutil.copy(self.folder / "protocol.json", place)
        done = program.run(*arguments, folder=place, code=None, env={"BROWSER": "true"})
        files = [f"{path.relative_to(place)}\n" + ("" if path.read_bytes().startswith(b"SQLite format") else path.read_text())
                 for path in sorted(place.rglob("*")) if path.is_file()]
        text = "\n".join([str(done.returncode), done.stdout, done.stderr, *files]).replace(str(place), "PLACE")
        return re.sub(r"\b[0-9a-f]{64}\b", "HASH", text)

    def both(self, arguments):
        """Of both studies, within the same minute of what `watch` counts since a session began."""
        minute = lambda: (time.time() - BEGAN) // 60
        began, texts = None, []
        while began != minute():
            began = minute()
            with concurrent.futures.ThreadPoolExecutor() as both:  # at once: `run` measures the machine for a second
                texts = list(both.map(lambda study: self.given(study, arguments), "ab"))
        return texts

    def calls(self):
        """Every command that may open a study, with each option alone and beside each kind of session."""
        def words(name, what, value):
            taken = TAKEN_BY.get(name, {}).get(what) or ([()] if not value else TAKES.get(value) or
                                                         (value.split("|") if value.islower() else ["1"]))
            return [[one] if isinstance(one, str) else [*one] for one in taken]

        tree = re.search(r'contains -- "\$command \$word" (.*)', self.jnd("completions", "fish").stdout)[1]
        for name in re.findall(r"'jnd ([^']*)'", tree):
            if name.split()[0] in WITHOUT_STUDY:
                continue
            shown = self.jnd("help", *name.split()).stdout
            base, ways = name.split(), [[]]
            for argument in re.findall(r"^  ([A-Z]+)(?:\.\.\.)?  ", shown.partition("Options:")[0], re.M):
                base += words(name, argument, argument)[0]
            for option, value, what in re.findall(r"^  (--[\w-]+)(?: (\S+))?((?:\n?  +.*?)*?)(?=\n  --|\n\n)", shown, re.M):
                given = [[option, *one] for one in words(name, option, value)]
                if "required: " in what or option == "--study" or option in TAKEN_BY.get(name, {}):
                    base += given[0]
                elif option != "--help":
                    ways += given
            kinds = [way for way in ways if way[:1] == ["--kind"]]
            for way in ways + [way + kind for way in ways[1:] if way not in kinds for kind in kinds]:
                yield name, [*base, *way]

    def test_no_command_tells_two_studies_apart_that_look_the_same(self):
        self.make_twins(1, 2)
        called, done = set(), set()
        for name, arguments in self.calls():
            with self.subTest(arguments=arguments):
                one, other = self.both(arguments)
                if arguments[0] in BESIDE:
                    one, other = (re.sub(BESIDE[arguments[0]], "", text) for text in (one, other))
                self.assertEqual(one, other)
                called.add(name)
                done |= {name} if one.startswith("130\n" if name == "run" else "0\n") else set()
        self.assertEqual(called - done, REFUSED)
        self.assertLess({"status", "plan", "analyze", "report", "export"}, done)
        for study in "ab":  # they are two: unblinded, they differ
            self.jnd("unblind", f"{study}.sqlite", "--reason", "this test")
        for arguments in (["status", "s.sqlite"], ["plan", "--study", "s.sqlite"], ["analyze", "s.sqlite"],
                          ["export", "s.sqlite", "--to", "new", "--kind", "pilot"], ["report", "s.sqlite", "--kind", "simulated"]):
            self.assertNotEqual(*self.both(arguments))

    def test_from_three_participants_on_means_by_letter_differ_and_nothing_else(self):
        self.make_twins(5, 5)
        for kind in ("real", "pilot", "simulated"):
            one, other = (program.parse(text.split("\n")[1])
                          for text in self.both(["analyze", "s.sqlite", "--kind", kind, "--json"]))
            self.assertEqual(one.pop("coded") == other.pop("coded"), kind != "real")
            self.assertEqual(one, other)


if __name__ == "__main__":
    program.main()
