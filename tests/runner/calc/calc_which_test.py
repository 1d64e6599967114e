#!/usr/bin/env python3
"""`jnd calc which` from outside: shapes, reference numbers, statuses, and one located message for a mistake."""
import json
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REFERENCE = program.ROOT / "analysis/selftest/two_interval_reference.json"

COUNTS = "x,n,k\n800,20,3\n900,20,9\n1000,20,18\n"
TOLERANCES = {"loglik": 1e-7, "deviance": 1e-6, "loglik_with_binomial_constants": 1e-7, "loglik_without_order": 1e-7,
              "lapse": 1e-4, "order_b": 1e-6, "order_lr": 1e-6, "order_p": 1e-6}


def run(*arguments, text, code=0):
    return program.run("calc", "which", "-", *arguments, input=text, code=code)


class Which(program.Case):
    def lines(self, *arguments, text):
        return run(*arguments, "--json", text=text).lines

    def refused(self, *words, arguments=("--standard", "900"), text=COUNTS, code=3):
        super().refused(run(*arguments, text=text, code=code), *words)

    def agrees(self, key, ours, theirs):
        if isinstance(theirs, list):
            for one, other in zip(ours, theirs):
                self.agrees(key, one, other)
        elif isinstance(theirs, str) or theirs is None or key == "status":
            self.assertEqual(ours, theirs if theirs is None or key == "status" else theirs.lower(), key)
        else:
            tolerance = TOLERANCES.get(key)
            close = (abs(ours - theirs) <= tolerance if tolerance else
                     math.isclose(ours, theirs, rel_tol=1e-5 if key.endswith("_ci") else 1e-6))
            self.assertTrue(close, (key, ours, theirs))

    def test_every_reference_case(self):
        cases = json.loads(REFERENCE.read_text())["cases"]
        self.assertGreater(len(cases), 10)
        for case in cases:
            given = case["input"]
            columns = [key for key in ("x", "n", "k", "order") if key in given]
            text = ",".join(columns) + "\n" + "".join(
                ",".join(map(str, row)) + "\n" for row in zip(*(given[column] for column in columns)))
            line, = self.lines("--standard", str(given["standard"]), "--lapse", str(given["lapse"]), "--link",
                               given["link"], text=text)
            with self.subTest(case["name"]):
                for key, theirs in case["expected"].items():
                    self.agrees(key, line[key], theirs)

    def test_a_line_a_group(self):
        lines = self.lines("--standard", "900", text="group,x,n,k\nA,800,9,1\nB,800,9,0\nA,1000,9,8\nB,1000,9,0\n")
        self.assertEqual([(line["group"], line["status"]) for line in lines], [("A", "ok"), ("B", "all_same")])
        self.assertIsNone(lines[1]["pse"])
        self.assertIsNone(lines[1]["jnd_75"])
        self.assertEqual(lines[1]["s_ci"], [0, "inf"])

    def test_no_weber_fraction_without_a_standard_above_0(self):
        line, = self.lines("--standard", "0", text="x,n,k\n-1,20,3\n0,20,9\n1,20,18\n")
        self.assertGreater(line["jnd_75"], 0)
        self.assertIsNone(line["weber_75"])

    def test_the_table_says_which_jnd_is_which(self):
        out = run("--standard", "900", text="x,n,k,order\n800,20,3,1\n900,20,9,1\n1000,20,18,-1\n900,20,4,-1\n").stdout
        self.says(out, "JND 75 %", "JND 84 %", "JND d' = 1", "0.6745 s", "without the lapses", "order b")
        out = run("--standard", "900", text="x,n,k\n800,20,0\n1000,20,20\n").stdout
        self.assertIn("separated: a step fits best", out)

    def test_answers_that_fall_are_named(self):
        done = run("--standard", "900", text="group,x,n,k\nA,800,20,18\nA,1000,20,2\nB,800,20,2\nB,1000,20,18\n")
        self.says(done.stderr, "A: the counted answers fall with the level, from 18 of 20 at 800 to 2 of 20 at 1000")
        self.assertNotIn("B:", done.stderr)

    def test_mistakes(self):
        self.refused("standard input:3:3: k: 21 choices in 20 trials (k is at most n)", text="x,n,k\n1,2,1\n2,20,21\n")
        self.refused("order: 0 is no order", text="x,n,k,order\n1,2,1,0\n")
        self.refused('there is no column "k"', text="x,n\n1,2\n")
        self.refused("--standard is needed", arguments=(), code=2)
        self.refused("is not a number (a column goes with --trials)", arguments=("--standard", "std"), code=2)
        self.refused("--lapse: 1 is neither", arguments=("--standard", "900", "--lapse", "1"), code=2)
        self.refused("--level goes with --trials", arguments=("--standard", "900", "--level", "x"), code=2)


if __name__ == "__main__":
    program.main()
