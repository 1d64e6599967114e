#!/usr/bin/env python3
"""Every task from outside: the shipped studies of others planned, rehearsed, verified, analysed, exported and reported; a session on specimens,
keys in and screen out; and one on a rig of the laboratory's own."""
import json
import sqlite3
import subprocess
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

PATIENT_RIG = program.argument()
ROOT = program.ROOT
# The rig's watchdog, too, is nothing for a busy machine; and its finger presses four times a second, to be done soon.
PLAIN_RIG = (ROOT / "devices/external/examples/plain_rig.py").read_text().replace("heard > 0.1", "heard > 600").replace(
    "elapsed_s % 1.0", "4 * elapsed_s % 1.0")
PRESSES_ONCE = PLAIN_RIG.replace("4 * elapsed_s % 1.0", "min(4 * elapsed_s, 0.5)")  # and stays there
ONE_PRESS = {"interval_end": "contacts", "contacts": 1, "explore_s": 60}
STUDIES = {"leib2015": "pse", "jones1997-viscosity": "weber", "pang1991": "threshold", "maereg2017": "weber",
           "bergmann-tiest2009": "weber", "zoeller2020": "jnd", "dhong2019-magnitude": "exponent",
           "carpenter2018-oddity": "dprime", "van-beek2015": "exponent", "varadharajan2008-magnitude": "exponent",
           "lee2007-delay": "threshold", "identify-stiffness2025": "information", "brown2019-prosthesis": "jnd",
           "singhala2020": "weber", "abx-stiffness": "jnd", "jones-hunter1990": "weber", "sandpaper-hands2013": "correct"}

READY = "[space] when the participant is ready"
TASKS = ("same-different", "which", "yes-no", "identify", "oddity", "abx", "magnitude", "adjust")
ADAPTIVE = ("same-different", "which", "yes-no", "oddity", "abx")


class Tasks(program.Case):
    def jnd(self, *arguments, keys=None, **options):
        done = super().jnd(*arguments, input=keys, **options)
        return done.stdout + (done.stderr if keys is not None else "")

    def test_every_study_goes_all_the_way(self):
        for name, outcome in STUDIES.items():
            with self.subTest(name):
                study = self.folder / f"{name}.sqlite"
                self.assertTrue(program.parse(self.jnd("check", name, "--json"))["ok"])
                plan = program.parse(self.jnd("plan", name, "--participant", 2, "--seed", 3, "--json"))["trials"]
                self.assertIn("arrangements", self.jnd("plan", name, "--cohort", 4, "--seed", 3))
                self.jnd("simulate", name, "--participants", 3, "--study", study, "--seed", 3)
                self.jnd("verify", study, "--deep")
                results = program.parse(self.jnd("analyze", study, "--json"))
                self.assertEqual(results["outcome"], outcome)
                self.assertEqual(len({row["participant"] for row in results["estimates"]}), 3)
                used = [row["n"] for row in results["group"] if row["outcome"] == outcome]
                self.assertGreater(max(used), 0, results["group"])
                self.assertIn(" by condition", self.jnd("analyze", study))
                self.jnd("export", study, "--to", self.folder / name)
                rows = self.trials(name, "P02")
                main = [trial for trial in plan if not trial["practice"]]
                if all(None not in trial["stimuli"] for trial in main):
                    suffix = next(column for column in rows[0] if column.startswith("stimulus_1_"))
                    self.assertEqual([float(row[suffix]) for row in rows if row["practice"] == "0"],
                                     [trial["stimuli"][0] for trial in main])
                columns = {row["column"] for row in self.rows(name, "dictionary.csv")}
                self.assertIn(outcome, columns)
                self.assertIn("the task", (self.folder / name / "methods.md").read_text())
                self.jnd("report", study, "--to", self.folder / f"{name}.html")

    def test_the_hierarchical_model_of_a_study_is_that_of_its_exported_trials(self):
        # maereg2017: which, 75 %; lee2007-delay: yes-no. The study's spreads are those that calc takes by itself.
        for name, factor, task in (("maereg2017", 0.6744897501960817, "which"), ("lee2007-delay", 1, "yes-no")):
            with self.subTest(name):
                study = f"{name}.sqlite"
                self.jnd("simulate", name, "--participants", 4, "--study", study, "--seed", 5)
                model = program.parse(self.jnd("analyze", study, "--json"))["hierarchical"]
                self.assertEqual({(one["status"], one["observer"]) for one in model}, {("ok", "choice" if task == "which" else "yes_no")})
                self.jnd("export", study, "--to", name)
                said = program.parse(self.jnd("calc", "hierarchical", *self.counts(name, task), "--json"))
                places = {condition: place for place, condition in enumerate(said["conditions"])}
                for one in model:
                    place = places[one["condition"]]
                    self.assertAlmostEqual(one["jnd"] / said["group_jnd"][place], factor, delta=1e-4)
                    self.assertAlmostEqual(one["ci_high"] / said["jnd_ci"][place][1], factor, delta=1e-3)
                    if task == "which":
                        self.assertAlmostEqual(one["bias"], said["alpha"][place], delta=0.05)
                        self.assertTrue(one["pse_ci_low"] < one["pse"] < one["pse_ci_high"])
                self.assertAlmostEqual(model[0]["equal_p"], said["p_equal_mu"], delta=1e-4)
                rows = self.rows(name, "hierarchical.csv")
                self.assertEqual([row["condition"] for row in rows], [one["condition"] for one in model])
                self.assertEqual("pse_ci_low" in rows[0], task == "which")
                text = self.jnd("analyze", study, "--tests", "--participants")
                self.assertIn("The group by the hierarchical model", text)
                self.assertIn("JND (75 %)" if task == "which" else "threshold", text)

    # What was answered at each level, as jnd calc hierarchical takes it: its file and the options that go with it.
    def counts(self, name, task):
        told = {}
        for row in self.trials(name):
            if row["practice"] != "0":
                continue
            stimuli = [float(value) for column, value in row.items() if column.startswith("stimulus_") and value
                       and column[9].isdigit() and column[10] == "_"]
            standard = float(next(value for column, value in row.items() if column.startswith("standard_")
                                  and not column.startswith("standard_interval")))
            if task == "which":
                place = 0 if stimuli[0] == standard else 1  # of the standard
                level, positive = stimuli[1 - place], (row["answer"] == ("first", "second")[1 - place])
            else:
                level, positive = abs(stimuli[0] - standard), row["answer"] == "yes"
            n, k = told.get((row["participant"], row["condition"], level), (0, 0))
            told[row["participant"], row["condition"], level] = (n + 1, k + positive)
        file = self.folder / f"{name}.csv"
        with open(file, "w", newline="") as out:
            out.write(f"participant,condition,{'x' if task == 'which' else 'delta'},n,k\n")
            for (participant, condition, level), (n, k) in told.items():
                out.write(f"{participant},{condition},{level:g},{n},{k}\n")
        return (file, "--task", "which", "--standard", f"{standard:g}") if task == "which" else (
            file, "--task", "same-different")

    def test_the_same_seed_gives_the_same_answers_and_one_changed_answer_is_found(self):
        for study in ("a", "b"):
            self.jnd("simulate", "maereg2017", "--participants", 2, "--study", f"{study}.sqlite", "--seed", 8)
            self.jnd("export", f"{study}.sqlite", "--to", study)
        a, b = ((self.folder / s / "counts.csv").read_bytes() for s in ("a", "b"))
        self.assertEqual(a, b)
        database = sqlite3.connect(self.folder / "a.sqlite")
        database.execute("DROP TRIGGER event_no_update")
        database.execute("UPDATE event SET body = json_set(body, '$.answer', 'first', '$.said', 0) WHERE kind = 'trial.completed' "
                         "AND json_extract(body, '$.said') = 1 AND session = (SELECT min(session) FROM event WHERE session <> 'study')")
        database.commit()
        database.close()
        self.jnd("verify", "a.sqlite", code=1)

    def test_a_simulation_that_keeps_nothing_finds_what_a_kept_one_does(self):
        own = {"TMPDIR": str(self.folder)}
        for name in ("maereg2017", "jones-hunter1990", "chinello2017-experiment2"):
            with self.subTest(name):
                command = ("simulate", name, "--participants", 3, "--seed", 4)
                self.jnd(*command, "--study", f"{name}.sqlite")
                kept = self.jnd("analyze", f"{name}.sqlite", "--json")
                self.assertEqual(program.parse(self.jnd(*command, "--no-study", "--json", env=own)), json.loads(kept))
                shown = self.jnd(*command, "--no-study", env=own)
                self.assertIn("\n  condition ", shown)
        self.assertEqual(list(self.folder.glob("jnd-simulated-*")), [])

    def test_a_protocol_to_start_from_of_every_task_rig_and_procedure(self):
        refused = set()
        for task in (*TASKS, "explore"):
            for rig in ("rrs3", "mckibben", "rrs3+mckibben", "external", "specimens"):
                for procedure in ("constant", "staircase", "quest", "posterior"):
                    name = self.folder / f"{task}-{rig}-{procedure}.json"
                    done = program.run("new", name, "--task", task, "--rig", rig, "--procedure", procedure, code=(0, program.USAGE))
                    if done.returncode == 2:
                        refused.add((task, rig, procedure))
                        continue
                    checked = program.parse(self.jnd("check", name, "--json"))
                    self.assertTrue(checked["ok"], (task, rig, procedure, checked["errors"]))
                    self.assertLess(max(map(len, name.read_text().splitlines())), 160)
                    if procedure == "constant" and rig in ("rrs3", "external") or rig == "external" and (
                            task in ("which", "oddity", "abx") or procedure == "posterior"):
                        study = name.with_suffix(".sqlite")
                        self.jnd("simulate", name, "--participants", 2, "--study", study, "--seed", 1)
                        self.jnd("verify", study, "--deep")
                        self.jnd("analyze", study)
        adaptive = ("staircase", "quest", "posterior")
        self.assertEqual(refused, {(task, rig, procedure) for task in (*TASKS, "explore")
                                   for rig in ("rrs3", "mckibben", "rrs3+mckibben", "external", "specimens")
                                   for procedure in ("constant", *adaptive)
                                   if task == "explore" and (rig != "rrs3" or procedure in adaptive)
                                   or procedure in adaptive and (rig == "specimens" or task not in ADAPTIVE)
                                   or procedure == "posterior" and task in ("oddity", "abx")})

    def test_the_list_names_every_shipped_protocol(self):
        shipped = {path.stem for path in (ROOT / "protocols").rglob("*.json") if path.name != "protocol.schema.json"}
        self.assertEqual({one["name"] for one in program.parse(self.jnd("new", "--list", "--json"))}, shipped)
        listed = self.jnd("new", "--list")
        for task in (*TASKS, "explore"):
            self.assertIn(f"{task}: ", listed)
        for name in shipped:
            self.assertEqual(len([line for line in listed.splitlines() if line.split()[:1] == [name]]), 1, name)
        for wrong in (["x.json", "--list"], ["--json"], [], ["x.json", "--rig", "external"], ["x.json", "--task", "guess"],
                      ["x.json", "--task", "which", "--from", "tutorial"]):
            self.jnd("new", *wrong, code=2)
        self.assertFalse((self.folder / "x.json").exists())

    def session_on(self, rig, protocol, study, keys):
        """A session of P01 on a rig of the laboratory's own, verified and exported. Returns its trials."""
        super().jnd(rig, "run", protocol, "--study", f"{study}.sqlite", "--participant", "P01", "--plain",
                    "--seed", "4", "--override-readiness", "a machine that runs tests", program=PATIENT_RIG, input=keys)
        self.jnd("verify", f"{study}.sqlite", "--deep")
        self.jnd("export", f"{study}.sqlite", "--to", study, "--kind", "pilot")
        return self.trials(study)

    def asked(self, keys, *arguments, **options):
        """A session in lines; each key is pressed when a line holds the text that it answers. Returns what was said."""
        said = ""
        with program.start(*arguments, folder=self.folder, stdin=subprocess.PIPE, stderr=subprocess.STDOUT, **options) as session:
            for line in session.stdout:
                said += line
                session.stdin.write("".join(key for text, key in keys.items() if text in line))
                session.stdin.flush()
        self.assertEqual(session.returncode, 0, said)
        return said

    def trials(self, folder, participant=None):
        return [row for row in self.rows(f"{folder}/trials.csv") if participant in (None, row["participant"])]

    def intervals(self, folder, trial):
        """What was presented in one trial, in the order of intervals and fingers."""
        return [row for row in self.rows(f"{folder}/intervals.csv") if (row["session"], row["seq"]) == (trial["session"], trial["seq"])]

    def rig_of(self, source=PLAIN_RIG, name="rig"):
        script, path = self.folder / f"{name}.py", self.folder / f"{name}.json"
        script.write_text(source)
        path.write_text(json.dumps({"format": 1, "title": name, "external": {
            "command": [sys.executable, str(script)], "hello_s": 600, "prepare_s": 600}}))
        return path

    def small(self, source, name="small", **changes):
        path = self.folder / f"{name}.json"
        self.jnd("new", path, "--from", source)
        protocol = json.loads(path.read_text())
        for key in ("assumed", "instructions", "published", "notes"):
            protocol.pop(key, None)
        protocol["blinding"] = "open"
        protocol["trial"].update(explore_s=0.5, gap_s=0, between_trials_s=0)
        for cue in protocol["trial"]["cues"].values():
            cue["kind"] = "none"
        for key, value in changes.items():
            if isinstance(value, dict) and key != "levels":
                protocol.setdefault(key, {}).update(value)
            else:
                protocol[key] = value
        path.write_text(json.dumps(protocol))
        return path

    def test_a_value_is_adjusted_until_it_is_accepted(self):
        """On specimens: 2 asks for more, 1 for less, 0 accepts; both values are handed over again with each of them."""
        protocol = self.small("bergmann-tiest2009", paradigm="adjust", task={"start": 1}, levels={"absolute": [500, 800, 1200]},
                              standards=[{"name": "s800", "value": 800}], design={"trials_per_cell": 2},
                              trial={"keys": {"less": "1", "more": "2", "accept": "0"}}, analysis={"outcome": "pse"},
                              rig={"specimens": [{"value": 500, "codes": ["7"]}, {"value": 800, "codes": ["K", "M"]},
                                                 {"value": 1200, "codes": ["5"]}]})
        plan = program.parse(self.jnd("plan", protocol, "--participant", 1, "--seed", 4, "--json"))["trials"]
        starts = [trial["stimuli"][1] for trial in plan]
        self.assertEqual(sorted(starts), [500, 1200])
        keys = "".join(" " * 3 + ("2" if start == 500 else "1") + " " * 2 + "0" for start in starts)
        def played(study):
            return self.jnd("run", protocol, "--study", study, "--participant", "P01", "--rig", "specimens", "--kind", "pilot",
                            "--plain", "--seed", 4, "--override-readiness", "a machine that runs tests", keys=keys)
        screen = played("s.sqlite")
        self.assertEqual(screen.count("Hand over"), 8, screen)
        self.assertRegex(screen, r"saved: trial 1, 800, \d+\.\d\d s")
        protocol.write_text(protocol.read_text().replace('"blinding": "open"', '"blinding": "coded"'))
        self.assertRegex(played("coded.sqlite"), r"saved: trial 1, \d+\.\d\d s")  # the value is a stimulus
        self.jnd("verify", "s.sqlite", "--deep")
        self.jnd("export", "s.sqlite", "--to", "s", "--kind", "pilot")
        rows = self.trials("s")
        self.assertEqual([row["settings"] for row in rows], [f"{start:g} 800" for start in starts])
        self.assertEqual([row["answer"] for row in rows], ["800", "800"])
        # A setting that does not follow from the one before is found.
        database = sqlite3.connect(self.folder / "s.sqlite")
        database.execute("DROP TRIGGER event_no_update")
        database.execute("UPDATE event SET body = json_set(body, '$.settings[1]', 500) WHERE kind = 'trial.completed'")
        database.commit()
        database.close()
        self.assertIn("settings", self.jnd("verify", "s.sqlite", code=1))

    def test_how_sure_pairs_were_judged_gives_a_jnd_of_its_own(self):
        path = self.folder / "sure.json"
        self.jnd("new", path, "--from", "chinello2017")
        protocol = json.loads(path.read_text())
        protocol["task"] = {"sureness": 2}
        protocol["trial"]["keys"] = {"same-2": "1", "same-1": "2", "different-1": "3", "different-2": "4"}
        protocol["design"]["trials_per_cell"] = 40
        protocol["assumed"] = []
        path.write_text(json.dumps(protocol))
        self.jnd("simulate", path, "--participants", 2, "--study", "q.sqlite", "--seed", 5)
        self.jnd("verify", "q.sqlite", "--deep")
        results = program.parse(self.jnd("analyze", "q.sqlite", "--json"))
        self.assertEqual(len(results["sureness"]), 2 * len(protocol["conditions"]))
        self.jnd("export", "q.sqlite", "--to", "q")
        trials = [row for row in self.trials("q", "P01") if row["practice"] == "0"]
        self.assertEqual({row["sureness"] for row in trials}, {"1", "2"})
        # The same from the trials, by `jnd calc sureness`.
        condition = protocol["conditions"][0]["name"]
        counts = {}
        for row in trials:
            if row["condition"] == condition:
                delta = abs(float(row["stimulus_1_n_per_m"]) - float(row["stimulus_2_n_per_m"]))
                category = 2 + int(row["sureness"]) if row["answer"] == "different" else 3 - int(row["sureness"])
                counts[delta, category] = counts.get((delta, category), 0) + 1
        text = "delta,category,n\n" + "".join(f"{d:g},{c},{n}\n" for (d, c), n in sorted(counts.items()))
        (self.folder / "sure.csv").write_text(text)
        calc = program.parse(self.jnd("calc", "sureness", "sure.csv", "--json"))
        ours = next(row for row in results["sureness"] if row["participant"] == "P01" and row["condition"] == condition)
        self.assertAlmostEqual(ours["sigma"], calc["sigma"], places=6)
        self.assertIn("how sure", self.jnd("analyze", "q.sqlite", "--behaviour"))

    def test_specimens_are_handed_over_by_their_codes(self):
        """Keys in, screen out: space begins a trial and hands a specimen over, 1 and 2 answer."""
        protocol = self.small("bergmann-tiest2009", design={"trials_per_cell": 2}, levels={"absolute": [500, 1200]})
        screen = self.jnd("run", protocol, "--study", "s.sqlite", "--participant", "P01", "--rig", "specimens", "--kind", "pilot",
                          "--plain", "--seed", 4, "--override-readiness", "a machine that runs tests", keys=(" " * 3 + "1") * 4)
        self.assertEqual(screen.count("Hand over"), 8, screen)
        codes = {500: "7", 800: "K", 1200: "5"}
        plan = program.parse(self.jnd("plan", protocol, "--participant", 1, "--seed", 4, "--json"))["trials"]
        handed = [line.split("Hand over", 1)[1].split() for line in screen.splitlines() if "Hand over" in line]
        self.assertEqual([words[0] for words in handed], ["first:", "second:"] * 4)  # the interval it is for
        told = [words[1] for words in handed]
        self.assertEqual(told, [codes[value] for trial in plan for value in trial["stimuli"]])
        self.jnd("verify", "s.sqlite", "--deep")
        results = program.parse(self.jnd("analyze", "s.sqlite", "--json", "--kind", "pilot"))
        self.assertEqual(sum(row["count"] for row in results["counts"]), 4)

    def test_an_interval_ends_with_the_key_and_what_is_prescribed_is_said(self):
        """Specimens in the hand for as long as the participant likes: space begins a trial, hands over and ends the interval."""
        protocol = self.small("zoeller2020", design={"trials_per_cell": 2, "order": {"series": "fixed", "conditions": "fixed"}},
                              levels={"absolute": [20, 40]}, trial={"interval_end": "key", "explore_s": 50}, conditions=[
                                  {"name": "free", "label": "free"},
                                  {"name": "peak", "label": "same peak force", "prescription": {"say": "Press alike."}}])
        screen = self.jnd("run", protocol, "--study", "k.sqlite", "--participant", "P01", "--rig", "specimens", "--kind", "pilot",
                          "--plain", "--seed", 4, "--override-readiness", "a machine that runs tests", keys=(" " * 5 + "1") * 8)
        self.assertEqual(screen.count("Say: Press alike."), 1, screen)
        handed = [line for line in screen.splitlines() if "Hand over" in line]
        self.assertEqual(sum("same peak force" in line for line in handed), 8, handed)  # the operator carries it out
        self.jnd("verify", "k.sqlite", "--deep")
        self.jnd("export", "k.sqlite", "--to", "k", "--kind", "pilot")
        rows = self.trials("k")
        self.assertEqual(len(rows), 8)
        self.assertNotIn("breach", rows[0])
        self.assertLess(max(float(row["duration_s"]) for row in rows), 50, "no key ended an interval")
        self.jnd("analyze", "k.sqlite", "--kind", "pilot", "--methods", str(self.folder / "methods.md"))
        methods = (self.folder / "methods.md").read_text()
        self.assertIn("had felt enough, at the latest 50 s after", methods)
        self.assertIn('In peak, participants were told: "Press alike."', methods)

    def test_what_was_prescribed_is_judged_from_what_was_measured(self):
        """Presses that are too deep are marked and left out; where they are repeated nothing that broke a limit is answered."""
        def protocol(on_breach):
            changes = {"trial": {"explore_s": 5, "interval_end": "contacts", "contacts": 2, "prescription": {
                           "say": "Press twice, gently.", "on_breach": on_breach, "limits": [
                               {"measure": "contacts", "low": 2, "high": 2}, {"measure": "depth", "high": 0.006}]}},
                       "analysis": {"exclude": {"off_prescription": True}},
                       "design": {"participants": 2, "trials_per_cell": 8}}
            return self.small("chinello2017", name=on_breach, **changes)
        self.jnd("simulate", protocol("flag"), "--study", "f.sqlite", "--participants", 2, "--seed", 3)
        self.jnd("verify", "f.sqlite", "--deep")
        self.jnd("export", "f.sqlite", "--to", "f", "--kind", "simulated")
        rows = [row for row in self.trials("f") if row["practice"] == "0"]
        broken = [row for row in rows if row["breach"]]
        self.assertTrue(0 < len(broken) < len(rows), len(broken))
        for row in rows:
            felt = [[one for one in self.intervals("f", row) if one["interval"] == i] for i in ("1", "2")]
            deep = any(float(max(fingers, key=lambda one: float(one["peak_force_n"]))["deepest_penetration_m"]) > 0.006
                       for fingers in felt)
            if "depth" in row["breach"]:
                self.assertIn("above 0.006 m", row["breach"])
            self.assertEqual(row["excluded_reason"], "off_prescription" if row["breach"] else "", row["breach"])
            self.assertFalse(deep and not row["breach"])
        text = self.jnd("analyze", "f.sqlite", "--json")
        self.assertEqual(json.loads(text)["exclusions"], {"off_prescription": len(broken)})
        shown = self.jnd("analyze", "f.sqlite")
        self.assertIn(f"{len(broken)} answered trials broke the prescription", shown)
        self.jnd("simulate", protocol("repeat"), "--study", "r.sqlite", "--participants", 2, "--seed", 3)
        self.jnd("verify", "r.sqlite", "--deep")
        self.jnd("export", "r.sqlite", "--to", "r", "--kind", "simulated")
        again = self.trials("r")
        self.assertEqual([row["breach"] for row in again if row["breach"]], [])
        self.assertTrue(any(int(row["attempt"]) > 1 for row in again))

    def test_a_rig_of_the_laboratorys_own_is_told_when_it_is_enough(self):
        changes = {"design": {"trials_per_cell": 2, "order": {"series": "fixed", "conditions": "fixed"}},
                   "levels": {"absolute": [300, 500]}, "analysis": {"contrasts": []},
                   "conditions": [{"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}]}
        for ends in ("key", "contacts"):
            trial = {"interval_end": ends, "explore_s": 40, "prescription": {"limits": [
                {"measure": "contacts", "low": 2, "high": 2}, {"measure": "peak_force", "high": 100}]}}
            if ends == "contacts":
                trial["contacts"] = 2
            protocol = self.small("maereg2017", name=ends, trial=trial, **changes)
            keys = ("   1" if ends == "key" else " 1") * 12
            rows = self.session_on(self.rig_of(PRESSES_ONCE if ends == "key" else PLAIN_RIG), protocol, ends, keys)
            self.assertEqual(len(rows), 4)
            self.assertLess(max(float(row["duration_s"]) for row in rows), 40)
            if ends == "contacts":
                self.assertEqual({row["breach"] for row in rows}, {""})
            else:
                self.assertTrue(all("contacts 1, below 2" in row["breach"] for row in rows), rows)

    def test_a_rig_of_the_laboratorys_own_renders_a_session(self):
        rig = self.rig_of()
        protocol = self.small("maereg2017", design={"trials_per_cell": 2, "order": {"series": "fixed", "conditions": "fixed"}},
                              levels={"absolute": [300, 500]}, conditions=[
                                  {"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}], analysis={"contrasts": []})
        rows = self.session_on(rig, protocol, "e", " 1" * 12)
        self.assertEqual(len(rows), 4)
        # The program itself gives a rig 100 ms while it presents, and 200 ms to stop: then trials are void and come again, and
        # the rig is started anew.
        last = self.asked({READY: " ", "[1] first": "1"}, "run", protocol, "--study", "own.sqlite", "--participant", "P01", "--rig", rig,
                          "--plain", "--seed", "4", "--override-readiness", "a machine that runs tests")
        self.assertRegex(last, r"\n  rig       slowest answer \d+ of 100 ms while it presented, \d+ of 2000 ms while it waited\n")
        self.jnd("verify", "own.sqlite", "--deep")
        self.jnd("export", "e.sqlite", "--to", "t", "--kind", "pilot", "--telemetry")
        for row in rows:
            for interval in (1, 2):
                trace = self.rows(f"t/sub-P01/telemetry/trial-{int(row['trial']):03}-attempt-{row['attempt']}"
                                  f"-interval-{interval}-trace.csv")
                forces = [float(one["value"]) for one in trace if one["channel"] == "force"]
                self.assertEqual({(one["channel"], one["unit"]) for one in trace}, {("force", "N"), ("depth", "m")})
                measured = dict(one.split("=") for one in self.intervals("t", row)[interval - 1]["measured"].split())
                self.assertAlmostEqual(max(forces), float(measured["peak_force"]), places=9)
                self.assertEqual(len(forces), len(trace) // 2)
            self.assertAlmostEqual(float(self.intervals("t", row)[0]["delivered_n_per_m"]), float(row["stimulus_1_n_per_m"]), delta=1)

    def test_the_rigs_own_buttons_answer(self):
        """No key but space is pressed: the rig says the second answer, and when its button went down, which is when it counts."""
        source = PLAIN_RIG.replace('"answers": False', '"answers": True').replace("""                say("alive", n=message["n"])""", """\
                say("alive", n=message["n"])
                device.asked = [(one, n - 1) for one, n in getattr(device, "asked", [])]
                for one in [one for one, n in device.asked if n == 0]:
                    say("answer", id=one["id"], answer=one["answers"][1], after_s=0.001)""").replace("""            elif kind == "bye":
""", """            elif kind == "ask":
                device.asked = [(message, 20)]  # it says so 20 "alive" later, which is half a second
            elif kind == "bye":
""")
        rig = self.rig_of(source)
        protocol = self.small("maereg2017", design={"trials_per_cell": 2, "order": {"series": "fixed", "conditions": "fixed"}}, trial=ONE_PRESS,
                              levels={"absolute": [300, 500]}, conditions=[
                                  {"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}], analysis={"contrasts": []})
        self.asked({READY: " "}, rig, "run", protocol, "--study", "b.sqlite", "--participant", "P01", "--plain", "--seed", "4",
                   "--override-readiness", "a machine that runs tests", program=PATIENT_RIG)
        self.jnd("verify", "b.sqlite", "--deep")
        self.jnd("export", "b.sqlite", "--to", "b", "--kind", "pilot")
        rows = self.trials("b")
        self.assertEqual([(row["answer"], row["entered_by"]) for row in rows], [("second", "participant")] * 4)
        for row in rows:
            self.assertLess(float(row["response_time_s"]), 0.4)

    def test_the_standard_may_have_parameters_of_its_own(self):
        """The rig is told of each interval; a condition's standard_parameters hold where the standard is felt, in either place."""
        rig = self.rig_of(PLAIN_RIG.replace("device.begin(message)", """device.begin(message)
                with open("told.jsonl", "a") as told:
                    told.write(json.dumps(message) + chr(10))"""))
        protocol = self.small("maereg2017", name="own", trial=ONE_PRESS, design={"trials_per_cell": 4, "order": {"series": "fixed", "conditions": "fixed"}},
                              levels={"absolute": [300, 400]}, analysis={"contrasts": []}, conditions=[
                                  {"name": "index", "label": "index beside thumb", "parameters": {"finger": "index"},
                                   "standard_parameters": {"finger": "thumb"}}])
        self.jnd("check", protocol, "--rig", rig)
        self.session_on(rig, protocol, "o", " 1" * 24)
        told = [json.loads(line) for line in (self.folder / "told.jsonl").read_text().splitlines()]
        trials = {}
        for request in told:
            trials.setdefault((request["trial"], request["attempt"]), []).append((request["value"], request["parameters"]["finger"]))
        whole = [felt for felt in trials.values() if len(felt) == 2]
        self.assertGreaterEqual(len(whole), 8)
        for felt in whole:
            self.assertEqual({finger for _, finger in felt}, {"thumb", "index"}, felt)
            if felt[0][0] != felt[1][0]:
                self.assertEqual(dict(felt)[400], "thumb", felt)
        # The standard comes first and second, also of two equal values, and the trials say which it was.
        self.assertEqual({felt[0][1] for felt in whole}, {"thumb", "index"})
        self.assertEqual({felt[0][1] for felt in whole if felt[0][0] == felt[1][0]}, {"thumb", "index"})
        rows = self.trials("o")
        first = {trial: felt[0][1] for (trial, _), felt in sorted(trials.items()) if len(felt) == 2}  # of the last attempt
        self.assertEqual([row["standard_interval"] for row in rows], ["1" if first[int(row["trial"])] == "thumb" else "2" for row in rows])
        self.jnd("analyze", "o.sqlite", "--kind", "pilot", "--methods", str(self.folder / "methods.md"))
        self.assertIn("In index the standard was presented with finger = thumb.", (self.folder / "methods.md").read_text())

    def test_two_values_are_felt_side_by_side(self):
        """A rig of two places is told both; what it delivers is kept for each, and a rehearsal answers by both."""
        source = PLAIN_RIG.replace('"answers": False', '"answers": False, "places": 2').replace(
            'say("done", id=self.id', 'say("done", delivered_beside=self.beside, id=self.id').replace(
            "self.first, self.contacts", 'self.beside = request["beside"]\n        self.first, self.contacts', 1)
        rig = self.rig_of(source)
        changes = {"design": {"trials_per_cell": 4, "order": {"series": "fixed", "conditions": "fixed"}},
                   "levels": {"absolute": [200, 600]}, "analysis": {"contrasts": []},
                   "conditions": [{"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}],
                   "task": {"presentation": "side-by-side", "sureness": 0}}
        protocol = self.small("maereg2017", name="beside", **changes)
        content = json.loads(protocol.read_text())
        content["trial"]["keys"] = {"left": "1", "right": "2"}
        del content["trial"]["cues"]["second"], content["trial"]["gap_s"]
        protocol.write_text(json.dumps(content))
        self.jnd("simulate", protocol, "--study", "m.sqlite", "--participants", 4, "--seed", 3)
        self.jnd("verify", "m.sqlite", "--deep")
        self.jnd("export", "m.sqlite", "--to", "m", "--kind", "simulated")
        felt = self.trials("m")
        self.assertGreater(sum(row["correct"] == "1" for row in felt), 0.8 * len(felt))  # 200, 400 and 600 are told apart
        self.assertEqual({row["answer"] for row in felt}, {"left", "right"})
        # The standard has parameters of its own, on whichever side it is.
        told = self.rig_of(source.replace("device.begin(message)", """device.begin(message)
                with open("told.jsonl", "a") as told:
                    told.write(json.dumps(message) + chr(10))"""), name="told")
        content["conditions"][0]["standard_parameters"] = {"finger": "index"}
        own = self.folder / "own-place.json"
        own.write_text(json.dumps(content))
        self.session_on(told, own, "w", " 1" * 24)
        requests = [json.loads(line) for line in (self.folder / "told.jsonl").read_text().splitlines()]
        self.assertGreaterEqual(len(requests), 8)
        for request in requests:
            fingers = {request["value"]: request["parameters"]["finger"], request["beside"]: request["beside_parameters"]["finger"]}
            self.assertEqual(fingers[400], "index", request)
            self.assertEqual(sorted(fingers.values()), ["index", "thumb"], request)
        self.assertEqual({request["value"] == 400 for request in requests}, {True, False})
        plain = self.rig_of(name="plain")
        said = super().jnd("check", protocol, "--rig", plain, code=None)
        self.assertNotEqual(said.returncode, 0)
        self.assertIn("side by side", said.said)
        rows = self.session_on(rig, protocol, "e", " 1" * 24)
        self.assertEqual(len(rows), 8)
        for row in rows:
            first, second = self.intervals("e", row)
            self.assertAlmostEqual(float(first["delivered_n_per_m"]), float(row["stimulus_1_n_per_m"]), delta=1)
            self.assertEqual(float(second["delivered_n_per_m"]), float(row["stimulus_2_n_per_m"]))
        self.assertEqual(len({row["stimulus_2_n_per_m"] for row in rows}), 3)

    def test_a_protocol_that_the_rig_cannot_render_is_refused_before_anything_is_made(self):
        rig = self.rig_of()
        refused = super().jnd("run", "lee2007-delay", "--study", "no.sqlite", "--participant", "P01", "--rig", rig, input="", code=program.INVALID)
        self.assertIn("delay", refused.stderr)
        self.assertFalse((self.folder / "no.sqlite").exists())


if __name__ == "__main__":
    program.main()
