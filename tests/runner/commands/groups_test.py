#!/usr/bin/env python3
"""Groups of participants from outside: plans, sessions whose group the operator says, what stays sealed, and the registered comparison of the
groups held against `jnd calc compare` on the exported files."""
import json
import math
import pathlib
import sqlite3
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

ROOT = program.ROOT
GOOD = ROOT / "tests/protocols/corpus/good/groups.json"
BY_HAND = ("--rig", "specimens", "--plain", "--override-readiness", "a machine that runs tests")


class Groups(program.Case):
    on_disk = True

    def jnd(self, *arguments, code=0, keys=None):
        done = super().jnd(*arguments, code=code, input=keys)
        return done.stdout + (done.stderr if keys is not None or code else "")

    def json_of(self, *arguments):
        return program.parse(self.jnd(*arguments, "--json"))

    def protocol(self, source, **changes):
        """A copy with other values: of a dictionary those named, else the whole member."""
        path = self.folder / "protocol.json"
        protocol = json.loads(pathlib.Path(source).read_text())
        protocol["assumed"] = []
        for key, value in changes.items():
            if isinstance(value, dict) and key != "levels":
                protocol.setdefault(key, {}).update(value)
            else:
                protocol[key] = value
        path.write_text(json.dumps(protocol))
        return path

    def by_hand(self, **changes):
        """Specimens that the operator hands over: in each condition two trials, of three keys to go on and an answer."""
        trial = json.loads((ROOT / "protocols/studies/bergmann-tiest2009.json").read_text())["trial"]
        trial.update(explore_s=0.5, gap_s=0, between_trials_s=0)
        for cue in trial["cues"].values():
            cue["kind"] = "none"
        settings = {"levels": {"absolute": [500]}, "standards": [{"name": "s800", "value": 800}], "trial": trial, "instructions": [], "published": [],
                    "conditions": [{"name": name, "label": name, "parameters": {"hand": name}} for name in ("left", "right")],
                    "groups": [{"name": "novice", "label": "new to it", "conditions": ["left"]},
                               {"name": "expert", "label": "ten years of it"}],
                    "design": {"participants": 6, "allotment": "given", "trials_per_cell": 2, "sessions": 2,
                               "order": {"series": "fixed", "conditions": "permuted"}},
                    "analysis": {"contrasts": [], "tests": {}}}
        settings.update(changes)
        return self.protocol(ROOT / "protocols/studies/bergmann-tiest2009.json", **settings)

    def numbers(self, study):
        database = sqlite3.connect(self.folder / study)
        found = database.execute("SELECT json_extract(body, '$.participant'), json_extract(body, '$.participant_number'), "
                                 "json_extract(body, '$.group') FROM event WHERE kind = 'session.opened' ORDER BY utc").fetchall()
        database.close()
        return found

    def test_the_operator_says_the_group_once_and_it_stays(self):
        protocol = self.by_hand()
        run = ("run", protocol, "--study", "s.sqlite", *BY_HAND)
        for more, words in ((), "say the participant's group: --group NAME, with one of novice, expert"), \
                (("--group", "zzz"), "the protocol has the groups novice, expert"):
            self.assertIn(words, self.jnd(*run, "--participant", "P01", *more, code=2))
        self.assertFalse((self.folder / "s.sqlite").exists())
        trial = " " * 3 + "1"
        expert = (*run, "--participant", "P01", "--seed", 4)
        screen = self.jnd(*expert, "--group", "expert", keys=trial, code=130)
        self.assertIn("participant P01, group expert, session 1 of 2, 0 of 4 trials done", screen)
        self.assertIn("participant P01 is of group expert, not novice", self.jnd(*expert, "--group", "novice", code=2, keys=""))
        self.assertIn("1 of 4 trials done; going on", self.jnd(*expert, keys=" " + trial * 3))
        self.assertIn("is of group expert, not novice", self.jnd(*expert, "--group", "novice", code=2, keys=""))
        self.jnd(*expert, "--group", "expert", keys=trial * 4)
        self.assertIn("say the participant's group", self.jnd(*run, "--participant", "P02", code=2, keys=""))
        self.jnd(*run, "--participant", "P02", "--group", "expert", keys=trial * 4)
        self.jnd(*run, "--participant", "P03", "--group", "novice", keys=trial * 2)
        # Of its numbers each group takes the first that is free.
        self.assertEqual(self.numbers("s.sqlite"), [("P01", 2, "expert"), ("P01", 2, "expert"), ("P02", 4, "expert"),
                                                     ("P03", 1, "novice")])
        self.jnd("verify", "s.sqlite", "--deep")
        self.assertIn("P03           novice", self.jnd("status", "s.sqlite"))
        self.assertEqual([one["group"] for one in self.json_of("status", "s.sqlite")["sessions"]],
                         ["novice", "expert", "expert", "expert"])
        self.assertIn("for a newcomer of the same group", self.jnd("exclude", "s.sqlite", "--participant", "P03", "--reason", "wrong group",
                                                                  "--replace"))
        self.jnd(*run, "--participant", "P04", "--group", "novice", keys=trial * 2)
        self.assertEqual(self.numbers("s.sqlite")[-1], ("P04", 1, "novice"))
        self.jnd("verify", "s.sqlite", "--deep")
        # A group that was changed behind the program's back is found.
        database = sqlite3.connect(self.folder / "s.sqlite")
        database.execute("DROP TRIGGER event_no_update")
        database.execute("UPDATE event SET body = json_set(body, '$.group', 'novice') WHERE kind = 'session.opened' AND "
                         "json_extract(body, '$.participant') = 'P02'")
        database.commit()
        database.close()
        self.jnd("verify", "s.sqlite", code=1)

    def test_a_group_is_refused_where_nobody_has_to_say_it(self):
        for protocol in (self.by_hand(design={"participants": 6, "trials_per_cell": 2, "allotment": "balanced",
                                              "order": {"series": "fixed", "conditions": "permuted"}}), "tutorial"):
            self.assertIn("leave it out", self.jnd("run", protocol, "--study", "no.sqlite", "--participant", "P01", "--group", "expert",
                                                    code=2))
        self.assertFalse((self.folder / "no.sqlite").exists())
        for words in (("--participant", 1, "--group", "a"), ("--cohort", 4, "--group", "a")):
            self.jnd("plan", "tutorial", *words, code=2)

    def test_a_group_that_was_drawn_stays_sealed_while_the_study_is_blinded(self):
        protocol = self.by_hand(design={"participants": 4, "trials_per_cell": 2, "allotment": "balanced",
                                        "order": {"series": "fixed", "conditions": "permuted"}})
        screen = self.jnd("run", protocol, "--study", "s.sqlite", "--participant", "P01", "--seed", 4, *BY_HAND, keys=(" " * 3 + "1") * 4)
        told = [screen, self.jnd("status", "s.sqlite"), self.jnd("status", "s.sqlite", "--json"), self.jnd("verify", "s.sqlite"),
                self.jnd("plan", "--study", "s.sqlite", "--participant", 1), self.jnd("plan", "--study", "s.sqlite", "--json"),
                self.jnd("analyze", "s.sqlite"), self.jnd("analyze", "s.sqlite", "--json")]
        self.jnd("plan", "--study", "s.sqlite", "--cohort", 4, code=2)
        self.jnd("export", "s.sqlite", "--to", "s")
        told += [path.read_text() for path in sorted((self.folder / "s").rglob("*.csv"))]
        for text in told:
            for word in ("expert", "novice", "ten years of it"):
                self.assertNotIn(word, text)
        # A pilot session of that number has the same group: a rehearsal alone in its file is not in code, and does not tell it.
        self.jnd("run", protocol, "--study", "alone.sqlite", "--participant", "P09", "--kind", "pilot", *BY_HAND, keys=(" " * 3 + "1") * 4)
        self.jnd("export", "alone.sqlite", "--to", "pilot", "--kind", "pilot")
        for name in ("sessions", "estimates", "counts", "values"):
            self.assertEqual({row["group"] for row in self.rows(f"pilot/{name}.csv")}, {""}, name)
        self.assertFalse((self.folder / "pilot/groups.csv").exists())
        # A simulated participant of that number would show it.
        self.assertIn("blinded", self.jnd("simulate", protocol, "--participants", 1, "--study", "s.sqlite", code=2))
        self.jnd("unblind", "s.sqlite", "--reason", "the test is over")
        group = self.json_of("plan", protocol, "--participant", 1, "--seed", 4)["group"]
        self.assertIn(group, self.jnd("status", "s.sqlite"))
        self.jnd("export", "s.sqlite", "--to", "open")
        self.assertEqual(self.rows("open/sessions.csv")[0]["group"], group)

    def test_plans_are_of_groups(self):
        check = self.json_of("check", GOOD)
        self.assertEqual([one["name"] for one in check["groups"]], ["young", "old", "all"])
        self.assertEqual(check["between"], "mann-whitney")
        self.assertEqual(check["trials"], 48)  # of the group with the most
        cohort = self.json_of("plan", GOOD, "--cohort", 18)["groups"]
        self.assertEqual([(one["group"], one["participants"]) for one in cohort], [("young", 6), ("old", 6), ("all", 6)])
        self.assertEqual([len(one["cells"]) for one in cohort], [4, 4, 6])
        member = self.json_of("plan", GOOD, "--participant", 2, "--group", "old")
        self.assertEqual((member["participant"], member["group"]), (5, "old"))
        self.assertEqual({trial["condition"] for trial in member["trials"]}, {"S", "V"})
        alone = self.json_of("plan", GOOD, "--cohort", 18, "--group", "old")
        self.assertEqual(alone, cohort[1])
        self.jnd("plan", GOOD, "--participant", 1, "--group", "nobody", code=2)

    def compare(self, rows):
        """`jnd calc compare` of (participant, group, condition, value)."""
        text = "participant,group,condition,value\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)
        (self.folder / "values.csv").write_text(text)
        return self.json_of("calc", "compare", "values.csv")

    def held_against(self, results, calc, groups):
        """The registered comparison, with everything that `jnd calc compare` says of the same values."""
        for row in results["between"]:
            theirs = next(one for one in calc["anova"] if one["effect"] == row["effect"])
            for key in set(theirs) - {"outcome", "test", "unit"}:
                self.assertTrue(row[key] == theirs[key] or math.isclose(row[key], theirs[key], rel_tol=1e-9), (row, key, theirs[key]))
        theirs = {(one["a"], one["b"], one.get("condition")): one for one in calc["pairs"]}
        found = 0
        for pair in results["group_pairs"]:
            place = (pair["a"], pair["b"], pair.get("condition"))
            turned = place not in theirs
            other = theirs[(place[1], place[0], place[2])] if turned else theirs[place]
            for test in ("welch", "mann_whitney"):
                for key in ("p", "p_holm"):
                    found += 1
                    a, b = pair[test][key], other[test][key]
                    self.assertTrue(a == b or math.isclose(a, b, rel_tol=1e-9), (place, test, key, a, b))
        self.assertEqual(found, 4 * len(calc["pairs"]))
        self.assertEqual([*dict.fromkeys(row["group"] for row in results["groups"])], groups)

    def test_pairs_of_stimuli_and_different_conditions_by_group(self):
        protocol = self.protocol(GOOD, trial={"explore_s": 0.5}, analysis={"tests": {"on": "slope", "between": "welch"}})
        self.jnd("simulate", protocol, "--participants", 9, "--study", "g.sqlite", "--seed", 1)
        self.jnd("verify", "g.sqlite", "--deep")
        results = self.json_of("analyze", "g.sqlite")
        self.jnd("export", "g.sqlite", "--to", "g")
        slopes = {}
        for row in self.rows("g/estimates.csv"):
            slopes.setdefault((row["participant"], row["group"]), []).append(float(row["slope"]))
        self.assertEqual(sorted(map(len, slopes.values())), [2] * 6 + [3] * 3)
        calc = self.compare([(*who, "mean", sum(values) / len(values)) for who, values in slopes.items()])
        self.held_against(results, calc, ["young", "old", "all"])
        pairs = self.rows("g/group_pairs.csv")
        self.assertEqual([(row["a"], row["b"]) for row in pairs], [("young", "old"), ("young", "all"), ("old", "all")])
        for row, pair in zip(pairs, results["group_pairs"]):
            self.assertEqual((float(row["welch_p"]), float(row["welch_p_holm"])), (pair["welch"]["p"], pair["welch"]["p_holm"]))
        means = self.rows("g/groups.csv")
        self.assertEqual([row["condition"] for row in means if row["group"] == "old"], ["S", "V", ""])
        # The contrast of two conditions that two of the groups get rests on them.
        contrasts = {(row["a"], row["b"], row["registered"]): row for row in results["contrasts"]}
        self.assertEqual(contrasts["S", "V", True]["participants"], 6)
        columns = {(row["file"], row["column"]) for row in self.rows("g/dictionary.csv")}
        for file in ("trials.csv", "sub-*/report.csv", "estimates.csv", "cells.csv", "participants.csv", "sessions.csv", "groups.csv"):
            self.assertIn((file, "group"), columns)
        counts = self.json_of("simulate", protocol, "--participants", 9, "--seed", 1, "--no-study")
        self.assertEqual(counts["groups"], results["groups"])
        methods = (self.folder / "g/methods.md").read_text()
        self.assertIn("by Welch's t test (Welch 1947) of each pair, of each participant's mean over their conditions", methods)
        self.assertIn("Welch B. L. (1947)", methods)
        text = self.jnd("analyze", "g.sqlite")
        self.assertIn("Groups of participants", text)
        self.assertIn("young - old", text)
        self.jnd("report", "g.sqlite", "--to", "g.html")
        self.assertIn("Groups of participants</a>", (self.folder / "g.html").read_text())

    def test_groups_and_conditions_crossed_of_another_task(self):
        self.jnd("simulate", "sandpaper-hands2013", "--participants", 24, "--study", "s.sqlite", "--seed", 3)
        self.jnd("verify", "s.sqlite", "--deep")
        results = self.json_of("analyze", "s.sqlite")
        self.assertEqual({row["test"] for row in results["between"]}, {"mixed-anova"})
        self.jnd("export", "s.sqlite", "--to", "s")
        estimates = self.rows("s/estimates.csv")
        calc = self.compare([(row["participant"], row["group"], row["condition"], row["correct"]) for row in estimates])
        self.held_against(results, calc, [one["name"] for one in json.loads(
            (ROOT / "protocols/studies/sandpaper-hands2013.json").read_text())["groups"]])
        effects = {row["effect"]: row for row in self.rows("s/between.csv")}
        self.assertEqual(float(effects["group"]["p"]), results["between"][0]["p"])
        self.assertEqual(effects["group"]["p_gg"], "")
        self.assertEqual((effects["group"]["df1"], effects["group"]["df2"]), ("5", "18"))
        # Too few to be tested: a status, and no number.
        self.jnd("simulate", "sandpaper-hands2013", "--participants", 6, "--study", "few.sqlite", "--seed", 5)
        few = self.json_of("analyze", "few.sqlite")["between"][0]
        self.assertEqual((few["p"], few["status"]), (None, "too_few"))

    def test_answers_that_set_the_levels(self):
        protocol = self.protocol(ROOT / "protocols/adaptive-staircase.json", trial={"explore_s": 0.5},
                                 groups=[{"name": "a", "label": "A", "conditions": ["S"]}, {"name": "b", "label": "B", "conditions": ["V"]}])
        kept = json.loads(protocol.read_text())
        kept["analysis"]["contrasts"] = []
        kept["published"] = []
        kept["practice"].pop("conditions", None)
        kept["conditions"] = [one for one in kept["conditions"] if one["name"] in ("S", "V")]
        protocol.write_text(json.dumps(kept))
        self.jnd("simulate", protocol, "--participants", 4, "--study", "a.sqlite", "--seed", 2)
        self.jnd("verify", "a.sqlite", "--deep")
        results = self.json_of("analyze", "a.sqlite")
        self.assertEqual({(row["group"], row["condition"]) for row in results["tracks"]}, {("a", "S"), ("b", "V")})
        self.assertEqual([(row["condition"], row["participants"]) for row in results["group"] if row["outcome"] == "threshold"], [("S", 2), ("V", 2)])
        self.assertEqual(results["group_pairs"][0]["test"], "welch")
        self.jnd("export", "a.sqlite", "--to", "a")
        self.jnd("simulate", protocol, "--participants", 2, "--seed", 2, "--no-study")


if __name__ == "__main__":
    program.main()
