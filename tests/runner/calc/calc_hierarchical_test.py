#!/usr/bin/env python3
"""jnd calc hierarchical from outside: shapes, numbers, messages, exit codes.

Usage: calc_hierarchical_test.py JND
"""
import json
import os
import subprocess
import sys
import unittest

JND = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else None
HERE = os.path.dirname(os.path.abspath(__file__))
ANALYSIS = os.path.join(HERE, "..", "..", "..", "analysis")
with open(os.path.join(ANALYSIS, "selftest", "hierarchical_reference.json"), encoding="utf-8") as reference_file:
    REFERENCE = json.load(reference_file)

# By key of the reference; the rest is compared to 1e-4. Criteria of choices and their spread are in N/m.
TOLERANCES = {"loglik": 1e-6, "loglik_equal_mu": 1e-6, "tu": 1e-3, "tv": 1e-3, "tw": 1e-3, "mu_ci": 3e-4, "ci": 3e-4,
              "lr_equal_mu": 1e-5, "p_equal_mu": 1e-5, "alpha": 0.01, "group_jnd": 0.05, "jnd_ci": 0.3,
              "ratio_ci": 1e-3}


def same_different_lines(rows):
    return ["participant,condition,delta,n,k"] + [f"P{p},C{c},{level},{n},{k}" for p, c, level, n, k in rows]


def which_lines(rows, standard):
    return ["participant,condition,x,n,k"] + [f"P{p},C{c},{standard + level},{n},{k}" for p, c, level, n, k in rows]


class CalcHierarchical(unittest.TestCase):
    def calc(self, lines, *more, code=0):
        done = subprocess.run([JND, "calc", "hierarchical", "-", *more], input="\n".join(lines) + "\n",
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, code, f"{more}: {done.stdout}{done.stderr}")
        return done

    def json_of(self, lines, *more):
        return json.loads(self.calc(lines, *more, "--json").stdout, parse_constant=self.fail)

    def agree(self, found, expected, where, tolerance=1e-4):
        if isinstance(expected, dict):
            for key, value in expected.items():
                if value is not None:
                    self.assertIn(key, found, where)
                    scale = 100 if key == "tw" and "alpha" in expected else 1  # N/m there
                    self.agree(found[key], value, f"{where} {key}", scale * TOLERANCES.get(key, 1e-4))
        elif isinstance(expected, list):
            self.assertEqual(len(found), len(expected), where)
            for one, other in zip(found, expected):
                if other is not None:
                    self.agree(one, other, where, tolerance)
        else:
            self.assertAlmostEqual(found, expected, delta=tolerance, msg=where)

    def test_every_reference(self):
        for task in ("same_different", "which"):
            for case in REFERENCE[task]:
                given = case["input"]
                for fit in case["expected"]:
                    model = fit["model"]
                    options = ["--random", ",".join(model["random"]), "--lapse", str(model["lapse"])]
                    if task == "which":
                        lines = which_lines(given["rows"], given["ref"])
                        options += ["--task", "which", "--standard", str(given["ref"])]
                    else:
                        lines = same_different_lines(given["rows"])
                        options += ["--task", "same-different"]
                    if model["label"] == "a_common_slope":
                        options.append("--one-jnd")
                    found = self.json_of(lines, *options)
                    self.assertTrue(found["converged"])
                    # One pair of conditions was computed there, we give all.
                    pairs = {(one["a"], one["b"]): one for one in found["mu_diff"]}
                    expected = dict(fit["expected"])
                    for one in expected.pop("mu_diff", []):
                        self.agree(pairs[one["a"], one["b"]], one, case["name"])
                    self.agree(found, expected, f"{case['name']} {model['label']}")

    def test_trials_and_counts_say_the_same(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 5]
        trials = ["who,where,difference,said"]
        for p, c, level, n, k in rows:
            trials += [f"P{p},C{c},{level},{'different' if i < k else 'same'}" for i in range(n)]
        counted = self.json_of(same_different_lines(rows), "--task", "same-different")
        told = self.json_of(trials, "--task", "same-different", "--trials", "--participant", "who", "--condition",
                            "where", "--level", "difference", "--answer", "said")
        self.assertAlmostEqual(counted["loglik"], told["loglik"], delta=1e-7)
        self.assertEqual(counted["conditions"], told["conditions"])
        self.assertEqual(counted["trials"], sum(row[3] for row in rows))
        self.assertIsInstance(counted["trials"], int)

    def test_trials_against_several_standards_are_refused(self):
        trials = ["who,standard,level,said"] + [f"P{p},{standard},{level},{said}" for p in (1, 2) for standard in (500, 900)
                                                for level in (400, 1000) for said in ("yes", "no")]
        done = self.calc(trials, "--task", "which", "--trials", "--participant", "who", "--level", "level", "--answer",
                         "said", "--standard", "standard", code=3)
        self.assertIn("several standards, 500 and 900", done.stderr)

    def test_people_get_tables(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 6]
        text = self.calc(same_different_lines(rows), "--task", "same-different", "--people", "--bootstrap", "20").stdout
        for part in ("hierarchical model: same-different", "C1 : C2", "persons (tu)", "from these answers alone",
                     "of 20 studies drawn without a difference it is as large", "Assumed:"):
            self.assertIn(part, text)
        self.assertNotIn("nan", text)

    def test_a_check_says_whether_the_model_draws_such_answers(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 6]
        lines = same_different_lines(rows)
        text = self.calc(lines, "--task", "same-different", "--check").stdout
        for part in ("posterior predictive check, 400 draws", "The model draws answers like these: ", "95 % of drawn",
                     "a large one hardly for"):
            self.assertIn(part, text)
        self.assertNotIn("nan", text)
        check, again = [self.json_of(lines, "--task", "same-different", "--check=60")["check"] for _ in range(2)]
        self.assertEqual(check, again)
        self.assertEqual((check["draws"], check["fits"]), (60, True))
        self.assertEqual(check["bands"], 2 * len(check["rows"]))
        counts = {}
        for _, c, level, n, k in rows:
            total = counts.setdefault((f"C{c}", level), [0, 0])
            total[0] += n
            total[1] += k
        self.assertEqual([(row["condition"], row["level"]) for row in check["rows"]], sorted(counts))
        for row in check["rows"]:
            n, k = counts[row["condition"], row["level"]]
            self.assertEqual(row["trials"], n)
            self.assertAlmostEqual(row["share"]["observed"], k / n)
            self.assertLessEqual(row["share"]["drawn_low"], row["share"]["drawn_high"])
        self.assertNotIn("check", self.json_of(lines, "--task", "same-different"))
        # Every answer given twice hangs together with its like.
        twice = same_different_lines([(p, c, level, 4 * n, 4 * k) for p, c, level, n, k in rows])
        bad = self.json_of(twice, "--task", "same-different", "--check=100")["check"]
        self.assertFalse(bad["fits"])
        self.assertLess(bad["p"], 0.025)
        self.assertIn("scatter more", bad["verdict"])

    def test_a_check_of_choices_and_of_one_person(self):
        case = REFERENCE["which"][0]["input"]
        rows = [row for row in case["rows"] if row[0] == case["rows"][0][0]]
        found = self.json_of(which_lines(rows, case["ref"]), "--task", "which", "--standard", str(case["ref"]),
                             "--check=20")["check"]
        self.assertEqual({row["level"] for row in found["rows"]}, {case["ref"] + row[2] for row in rows})
        for row in found["rows"]:
            self.assertEqual(row["sd_between"], {"observed": None, "drawn_low": None, "drawn_high": None,
                                                 "status": "one_person"})

    def test_what_is_undefined_is_null_with_a_status(self):
        lines = ["participant,condition,delta,n,k"]
        for p in range(4):
            for level, k in ((0, 1), (200, 3), (400, 6)):
                lines += [f"P{p},good,{level},6,{min(6, k + p % 2)}", f"P{p},flat,{level},6,3"]
        found = self.json_of(lines, "--task", "same-different")
        self.assertEqual(found["status"], ["ok", "no_sensitivity"])
        self.assertIsNone(found["group_jnd"][1])
        self.assertEqual(found["jnd_ci"][1][1], "inf")
        self.assertIsNone(found["mu_diff"][0]["ratio"])
        self.assertLess(found["mu_diff"][0]["p"], 0.05)
        text = self.calc(lines, "--task", "same-different").stdout
        self.assertIn("no_sensitivity: the answers do not change with the level", text)
        self.assertNotIn("nan", text)
        alone = self.json_of([line for line in lines if line[:2] in ("pa", "P0")], "--task", "same-different")
        self.assertEqual([alone[key] for key in ("tu_status", "tv_status", "tw_status")], ["not_identified"] * 3)

    def test_the_drawn_studies_are_the_seeds(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 4]
        drawn = [self.json_of(same_different_lines(rows), "--task", "same-different", "--bootstrap", "15", "--threads",
                              threads)["bootstrap"] for threads in ("1", "2")]
        self.assertEqual(drawn[0], drawn[1])

    def test_what_cannot_be_used(self):
        head = "participant,condition,delta,n,k"
        for lines, part in (([head, "P1,S,0,4,5"], "5 answers in 4 trials"), ([head, "P1,S,-3,4,2"], "delta"),
                            ([head, "P1,S,0,4,2"], "one level only"),
                            ([head, "P1,S,0,4,2", "P1,S,9,4,2", "P1,V,9,0,0"], "condition V has no trials"),
                            (["participant,x,n,k", "P1,4,4,2"], "unknown column")):
            done = self.calc(lines, "--task", "same-different", code=3)
            self.assertEqual((done.stdout, len(done.stderr.splitlines())), ("", 1))
            self.assertIn(part, done.stderr)
        good = [head, "P1,S,0,4,1", "P1,S,9,4,3"]
        for options, part in ((("--task", "same-different", "--random", "tu,zz"), "zz is none of"),
                              (("--task", "same-different", "--random", "tw,rho"), "goes with tu and tw"),
                              (("--task", "same-different", "--lapse", "1"), "--lapse"),
                              (("--task", "which"), "--standard is needed"),
                              (("--task", "which", "--observer", "differencing"), "--observer goes with"),
                              (("--task", "same-different", "--bootstrap", "9"), "--bootstrap tests one JND"),
                              (("--task", "same-different", "--check=-3"), "--check=N"),
                              ((), "--task")):
            done = self.calc(good, *options, code=2)
            self.assertIn(part, done.stderr)


if __name__ == "__main__":
    unittest.main()
