#!/usr/bin/env python3
"""jnd calc posterior from outside: every reference sequence, messages with places, exit codes."""
import json
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REFERENCE = json.loads((program.ROOT / "analysis/selftest/posterior_reference.json").read_text())["cases"]


def even(start, stop, size):
    return [start + i * (stop - start) / (size - 1) for i in range(size)]


def configuration(given):
    if given["definition"] == "same_different":
        return {"task": "same-different", "levels": [25 * i for i in range(25)], "utility": given["utility"],
                "grid": {"ln_s": even(math.log(60), math.log(1200), 31), "k": even(-0.5, 2.5, 17), "lapse": [0, 0.025, 0.05]},
                "prior": {"ln_s": [math.log(275), 0.7], "k": [0.75, 0.75], "lapse": [0.5, 0.3, 0.2]},
                "slots": given["types"], "responses": given["responses"]}
    return {"task": "which", "standard": 900, "levels": [400 + 50 * i for i in range(21) if i != 10],
            "grid": {"ln_s": even(math.log(40), math.log(800), 30), "pse_offset": even(-120, 120, 13), "lapse": [0, 0.02, 0.06]},
            "prior": {"ln_s": [math.log(180), 0.8], "pse_offset": [0, 60], "lapse": [0.5, 0.35, 0.15]},
            "utility": given["utility"], "slots": given["types"], "responses": given["responses"]}


class CalcPosterior(program.Case):
    def calc(self, text, *more, code=0):
        self.write("run.json", text)
        return self.jnd("calc", "posterior", "run.json", *more, code=code)

    def json_of(self, given):
        return self.calc(json.dumps(given), "--json").json

    def test_a_response_is_0_or_1(self):
        given = configuration(REFERENCE[0]["input"])
        given["responses"] = [2]
        self.assertIn("2 is out of range (must be 0 or 1)", self.calc(json.dumps(given), code=3).stderr)

    def test_every_reference_sequence(self):
        for case in REFERENCE:
            expected = case["expected"]
            found = self.json_of(configuration(case["input"]))
            self.assertEqual(len(found["trials"]), len(expected["trials"]))
            self.assertEqual(found["final"], found["trials"][-1])
            self.assertIsNone(found["next"])
            pairs = list(zip(found["trials"], expected["trials"]))
            if "prior_stats" in expected:
                pairs.append((found["prior_stats"], expected["prior_stats"]))
            for trial, reference in pairs:
                for key, value in reference.items():
                    mine = trial[key.replace("ln_sigma", "ln_s")]
                    if key.endswith("geomean"):
                        self.assertLessEqual(abs(mine - value), 1e-9 * value, (case["name"], key))
                    elif isinstance(value, float) and key != "level":
                        self.assertLessEqual(abs(mine - value), 1e-10, (case["name"], key))
                    else:
                        self.assertEqual(mine, value, (case["name"], key))

    def test_slots_may_be_absent_and_may_go_on(self):
        given = configuration(REFERENCE[3]["input"])
        given["responses"] = given["responses"][:12]
        with_free_slots = dict(given, slots="F" * 12)
        del given["slots"]
        self.assertEqual(self.json_of(given), self.json_of(with_free_slots))
        found = self.json_of(dict(given, slots="F" * 12 + "U"))
        self.assertGreater(found["next"]["level"], 900)
        self.assertEqual(self.json_of(dict(given, responses=[]))["final"], None)

    def test_mistakes_have_a_place_and_say_what_to_do(self):
        good = configuration(REFERENCE[0]["input"])
        def changed(path, value):
            copy = json.loads(json.dumps(good))
            *parents, last = path
            part = copy
            for key in parents:
                part = part[key]
            if value is None:
                del part[last]
            else:
                part[last] = value
            return json.dumps(copy, indent=1)
        for path, value, where, what in (
                (["task"], "which-one", "$.task", "which"),
                (["utility"], None, "$", '"utility" is missing'),
                (["levels"], [10, 20, 30], "$.levels[0]", "the first of them is 0"),
                (["levels"], [0, 20, 20], "$.levels[2]", "stands twice"),
                (["levels"], [0, -20], "$.levels[1]", "0"),
                (["grid", "ln_s"], [5, 4], "$.grid.ln_s[1]", "ascend"),
                (["grid", "lapse"], [0, 1], "$.grid.lapse[1]", "0.999"),
                (["grid", "k"], [], "$.grid.k", ""),
                (["grid", "pse_offset"], [0], "$.grid.pse_offset", "not known"),
                (["prior", "ln_s"], [5, 0], "$.prior.ln_s[1]", "above 0"),
                (["prior", "ln_s"], [5], "$.prior.ln_s", ""),
                (["prior", "lapse"], [1, 2], "$.prior.lapse", "2 weights for 3 lapses"),
                (["prior", "lapse"], [0, 0, 0], "$", "one of them is above 0"),
                (["prior", "k"], [1e6, 1], "$", "bring its mean onto the grid"),
                (["responses"], [1, 2], "$.responses[1]", "1"),
                (["slots"], "SDX" * 8, "$.slots", 'trial 3: "X" is no slot'),
                (["slots"], "SD", "$.slots", "2 slots for 24 responses")):
            done = self.calc(changed(path, value), code=3)
            self.refused(done, where, what)
            self.assertRegex(done.stderr, r"run\.json:\d+:\d+: ")
        one_sided = configuration(REFERENCE[3]["input"])
        one_sided["levels"] = [950, 1000]
        self.assertIn("below the standard", self.calc(json.dumps(one_sided), code=3).stderr)
        self.calc("{", code=3)

    def test_an_accelerated_staircase(self):
        arguments = ["--start", "400", "--up", "1", "--step-up", "180", "--step-down", "60", "--accelerated"]
        def staircase(down, code):
            return self.jnd("calc", "staircase", "-", "--json", "--down", down, *arguments, input=["response", 1, 1, 0, 0, 1, 0], code=code)
        found = staircase("1", 0).json
        # Steps divided by 1, 2, then 2 + reversals.
        self.assertEqual((found["levels"], found["next"]), ([400, 340, 310, 370, 430, 415], 451))
        self.assertAlmostEqual(found["target"], 0.75, delta=1e-12)
        self.assertIn("1 up, 1 down", staircase("2", 3).stderr)

    def test_standard_input_and_a_table(self):
        given = configuration(REFERENCE[0]["input"])
        done = self.jnd("calc", "posterior", "-", input=json.dumps(given))
        self.says(done.stdout, "prior", "different", "253", "325")
        self.assertNotIn("nan", done.stdout)


if __name__ == "__main__":
    program.main()
