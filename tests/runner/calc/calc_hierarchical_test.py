#!/usr/bin/env python3
"""jnd calc hierarchical from outside: shapes, numbers, messages, exit codes."""
import json
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REFERENCE = json.loads((program.ROOT / "analysis/selftest/hierarchical_reference.json").read_text())

# By key of the reference; the rest is compared to 1e-4. Criteria of choices and their spread are in N/m.
TOLERANCES = {"loglik": 1e-6, "loglik_equal_mu": 1e-6, "tu": 1e-3, "tv": 1e-3, "tw": 1e-3, "mu_ci": 3e-4, "ci": 3e-4,
              "lr_equal_mu": 1e-5, "p_equal_mu": 1e-5, "alpha": 0.01, "group_jnd": 0.05, "jnd_ci": 0.3,
              "ratio_ci": 1e-3}


def same_different_lines(rows):
    return ["participant,condition,delta,n,k"] + [f"P{p},C{c},{level},{n},{k}" for p, c, level, n, k in rows]


def which_lines(rows, standard):
    return ["participant,condition,x,n,k"] + [f"P{p},C{c},{standard + level},{n},{k}" for p, c, level, n, k in rows]


class CalcHierarchical(program.Case):
    def calc(self, lines, *more, code=0):
        return program.run("calc", "hierarchical", "-", *more, input=lines, code=code)

    def json_of(self, lines, *more):
        return self.calc(lines, *more, "--json").json

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
        self.says(text, "hierarchical model: same-different", "C1 : C2", "persons (tu)", "from these answers alone", "holds the true JND of 84 %",
                  "of 20 studies drawn without a difference it is as large", "Assumed:")
        self.assertNotIn("nan", text)

    def test_a_check_says_whether_the_model_draws_such_answers(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 6]
        lines = same_different_lines(rows)
        text = self.calc(lines, "--task", "same-different", "--check").stdout
        self.says(text, "posterior predictive check, 400 draws", "The model draws answers like these: ", "95 % of drawn",
                  "a large one hardly for")
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
    def test_what_is_the_same_for_everybody_is_estimated(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 8]
        lines = same_different_lines(rows)
        plain = self.json_of(lines, "--task", "same-different", "--random", "tu,tw")
        found = self.json_of(lines, "--task", "same-different", "--random", "tu,tw", "--overdispersion", "--lapse",
                             "shared")
        self.assertEqual([one["parameter"] for one in found["shared"]], ["lapse", "overdispersion"])
        self.assertEqual(found["lapse"], found["shared"][0]["value"])
        for key in ("loglik", "mu", "mu_ci", "group_jnd", "jnd_ci"):
            self.assertEqual(found["without"][key], plain[key], key)
        self.assertGreaterEqual(found["loglik"], plain["loglik"] - 1e-6)
        self.assertNotIn("shared", plain)
        halves = ["participant,condition,delta,n,k,half"]
        for p, c, level, n, k in rows:
            halves += [f"P{p},C{c},{level},{n - n // 2},{k - k // 2},1", f"P{p},C{c},{level},{n // 2},{k // 2},2"]
        drift = self.json_of(halves, "--task", "same-different", "--random", "tu,tw", "--drift")
        self.assertEqual([one["parameter"] for one in drift["shared"]], ["drift_ln_jnd", "drift_criterion"])
        for one in drift["shared"]:
            self.assertEqual(one["status"], "ok")
            self.assertTrue(one["ci"][0] < one["value"] < one["ci"][1], one)
        first = [halves[0]] + [line for line in halves if line.endswith(",1")]
        for one in self.json_of(first, "--task", "same-different", "--random", "tu,tw", "--drift")["shared"]:
            self.assertEqual((one["status"], one["value"], one["p"]), ("not_identified", None, None))
        text = self.calc(lines, "--task", "same-different", "--random", "tu,tw", "--overdispersion").stdout
        self.assertIn("correlation of answers at one level", text)
        self.assertIn("without these", text)

    def test_halves_are_of_each_persons_own_trials_in_a_condition(self):
        rows = [f"{p},{c},{level},{answer}" for p in "AB" for c in "XY"
                for level, answer in [(0, "same"), (200, "different"), (0, "different"), (400, "same"), (0, "same"),
                                      (200, "same"), (400, "different"), (200, "different"), (0, "same")]]
        trials = ["p,c,x,said"] + rows
        counted = {}
        for i, row in enumerate(rows):
            p, c, level, answer = row.split(",")
            key = p, c, level, 1 if i % 9 < 5 else 2  # the middle one of nine is of the first half
            n, k = counted.get(key, (0, 0))
            counted[key] = n + 1, k + (answer == "different")
        counts = ["participant,condition,delta,half,n,k"] + [
            f"{p},{c},{level},{half},{n},{k}" for (p, c, level, half), (n, k) in counted.items()]
        more = ("--task", "same-different", "--random", "none", "--drift")
        one = self.json_of(trials, "--trials", "--participant", "p", "--condition", "c", "--level", "x", "--answer",
                           "said", *more)
        other = self.json_of(counts, *more)
        self.assertAlmostEqual(one["loglik"], other["loglik"], delta=1e-6)
        self.agree(one["shared"][0]["value"], other["shared"][0]["value"], "drift", 1e-3)

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
        self.assertIn("no_sensitivity (flat): positive answers do not become more frequent as the level grows", text)
        self.assertNotIn("nan", text)
        alone = self.json_of([line for line in lines if line[:2] in ("pa", "P0")], "--task", "same-different")
        self.assertEqual([alone[key] for key in ("tu_status", "tv_status", "tw_status")], ["not_identified"] * 3)

    def test_conditions_without_a_jnd_leave_the_others(self):
        lines = ["participant,condition,delta,n,k"]
        for p in range(6):
            for level, k in ((0, 1), (200, 3), (400, 5)):
                lines += [f"P{p},good,{level},6,{k - p % 2}", f"P{p},always,{level},6,6",
                          f"P{p},step,{level},6,{6 if level == 400 else 0}"]
            lines.append(f"P{p},single,200,6,{p % 3}")
        found = self.json_of(lines, "--task", "same-different")
        self.assertEqual(found["conditions"], ["good", "always", "step", "single"])
        self.assertEqual(found["status"], ["ok", "one_answer", "perfect", "one_level"])
        self.assertEqual(found["ci_status"], ["ok"] + 3 * ["not_computed"])
        self.assertEqual(found["jnd_ci"][1], [None, None])
        self.assertTrue(found["jnd_ci"][0][0] < found["group_jnd"][0] < found["jnd_ci"][0][1])
        self.assertTrue(found["converged"] and found["exact"])
        for one in found["mu_diff"]:
            self.assertEqual((one["ratio"], one["p"], one["ci_status"]), (None, None, "not_computed"))
        text = self.calc(lines, "--task", "same-different", "--people", "--check=20").stdout
        self.says(text, "one_answer (always): every answer is the same", "perfect (step): ", "one_level (single): ")
        self.assertNotIn("nan", text)
        self.assertNotIn("inf", text.replace("infinite", ""))

    def test_answers_that_fall_with_the_level_are_told(self):
        lines = ["participant,delta,n,k"] + [f"P{p},{level},10,{k}" for p in range(3)
                                             for level, k in ((0, 9), (200, 5), (400, 1))]
        done = self.calc(lines, "--task", "same-different")
        self.assertIn("the counted answers fall with the level, from 27 of 30 at 0 to 3 of 30 at 400", done.stderr)
        found = self.json_of(lines, "--task", "same-different")
        self.assertEqual((found["status"], found["falling"]), (["no_sensitivity"], [True]))

    def test_levels_of_single_trials_are_pooled_and_counted(self):
        trials = ["who,x,said"] + [f"P{i % 6},{3 * i},{'different' if i * 7 % 200 < i else 'same'}" for i in range(200)]
        options = ("--task", "same-different", "--trials", "--participant", "who", "--level", "x", "--answer", "said")
        before, after = self.json_of(trials, *options)["pooled_levels"]
        self.assertEqual(before, 200)
        self.assertLess(after, 70)
        self.assertIn(f"Levels within 5 % of each other were pooled: 200 to {after}.", self.calc(trials, *options).stdout)

    def test_a_large_study_has_intervals_by_curvature(self):
        """Searches for the 78 of 20 people in 12 conditions would take a minute. Interval and test agree all the same."""
        rates = (0.11, 0.3, 0.57, 0.81, 0.94)
        lines = ["participant,condition,delta,n,k"] + [
            f"P{p},C{c},{100 * i},100,{min(100, max(0, round(100 * rate) + (7 * p + 5 * c + 3 * i * p * c) % 13 - 6))}"
            for p in range(20) for c in range(12) for i, rate in enumerate(rates)]
        found = self.json_of(lines, "--task", "same-different")
        self.assertEqual({*found["ci_status"], *(one["ci_status"] for one in found["mu_diff"])}, {"by_curvature"})
        for one in found["mu_diff"]:
            self.assertEqual(one["ci"][0] <= 0 <= one["ci"][1], one["p"] >= 0.05, one)
        text = self.calc(lines, "--task", "same-different").stdout
        self.assertIn("interval by_curvature: the search for its ends takes too long", text)

    def test_few_people_get_a_caution(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 6]
        few, more = ["\n".join(self.json_of(same_different_lines([row for row in rows if row[0] <= most]), "--task",
                                            "same-different")["cautions"]) for most in (3, 6)]
        self.assertIn("3 participants are few: in simulated studies of 3 people, 95.3 %", few)
        self.assertNotIn("are few", more)

    def test_likely_lapses_get_a_caution(self):
        sure = [(0, 3), (100, 8), (200, 25), (300, 37), (400, 40)]
        often_wrong = [(0, 6), (100, 16), (200, 32), (300, 34), (400, 34)]
        found = []
        for answers in (sure, often_wrong):
            lines = ["participant,condition,delta,n,k"] + [f"P{p},S,{level},40,{said}" for p in range(6)
                                                                   for level, said in answers]
            found.append("\n".join(self.json_of(lines, "--task", "same-different")["cautions"]))
            self.assertNotIn("are guesses", "\n".join(self.json_of(lines, "--task", "same-different", "--lapse",
                                                                   "shared")["cautions"]))
        self.assertNotIn("are guesses", found[0])
        self.assertRegex(found[1], r"Some answers are guesses: a share of [12]\d\.\d % fits them better \(p ")

    def test_the_drawn_studies_are_the_seeds(self):
        rows = [row for row in REFERENCE["same_different"][0]["input"]["rows"] if row[0] <= 4]
        drawn = [self.json_of(same_different_lines(rows), "--task", "same-different", "--bootstrap", "15", "--threads",
                              threads)["bootstrap"] for threads in ("1", "2")]
        self.assertEqual(drawn[0], drawn[1])

    def rated(self, people=4):
        """Rows of categories and the same as trials: people differ a little, nobody answers at random."""
        counts = {0: (5, 4, 2, 1), 200: (2, 3, 4, 3), 400: (1, 1, 3, 7)}
        lines, trials = ["participant,condition,delta,category,n"], ["who,where,x,said,degree"]
        for p in range(people):
            for condition, shift in (("S", 0), ("V", 1)):
                for level, by_category in counts.items():
                    n = list(by_category)
                    n[(p + shift) % 4] += 2
                    for category, count in enumerate(n, 1):
                        lines.append(f"P{p},{condition},{level},{category},{count}")
                        said, degree = ("same", "same", "different", "different")[category - 1], (3, 1, 1, 2)[category - 1]
                        trials += [f"P{p},{condition},{level},{said},{degree}"] * count
        return lines, trials

    def test_sureness_counts(self):
        lines, trials = self.rated()
        found = self.json_of(lines, "--task", "same-different")
        self.assertTrue(found["converged"])
        sureness = found["sureness"]
        for side in ("below", "above"):
            self.assertEqual(sureness[side + "_status"], "ok")
            self.assertLess(sureness[side + "_ci"][0], sureness[side])
            self.assertGreater(sureness[side + "_ci"][1], sureness[side])
        self.assertEqual(len(sureness["narrower"]), 2)
        self.assertTrue(all(0 < share < 1 for share in sureness["narrower"]))
        told = self.json_of(trials, "--task", "same-different", "--trials", "--participant", "who", "--condition", "where",
                            "--level", "x", "--answer", "said", "--sureness", "degree")
        self.assertAlmostEqual(found["loglik"], told["loglik"], delta=1e-6)
        text = self.calc(lines, "--task", "same-different").stdout
        self.says(text, "criteria of sureness", "different, sure: above", "Intervals of ln JND narrower")
        self.assertNotIn("nan", text)

    def test_without_its_sureness_it_is_the_model_of_two_answers(self):
        lines, trials = self.rated()
        two = self.json_of(trials, "--task", "same-different", "--trials", "--participant", "who", "--condition", "where",
                           "--level", "x", "--answer", "said")
        self.assertIsNone(two["sureness"])
        sure = [line.replace(",2,", ",1,").replace(",3,", ",4,") for line in lines]
        merged = self.json_of(sure, "--task", "same-different")
        self.assertAlmostEqual(merged["loglik"], two["loglik"], delta=1e-6)
        self.assertEqual(merged["sureness"]["below_status"], "not_identified")
        self.assertIsNone(merged["sureness"]["above"])
        self.assertIn("nobody gave both answers", self.calc(sure, "--task", "same-different").stdout)

    def test_the_independent_observer_asks_for_blocks(self):
        rows = [(p, block, delta, n, k) for p in range(4) for block, level, same, different in
                (("a", 200, 4, 7), ("b", 400, 2 + p % 2, 11)) for delta, n, k in ((0, 12, same), (level, 12, different))]
        lines = ["participant,block,delta,n,k"] + [f"P{p},{block},{delta},{n},{k}" for p, block, delta, n, k in rows]
        options = ("--task", "same-different", "--observer", "independent")
        found = self.json_of(lines, *options)
        self.assertEqual((found["observer"], found["status"]), ("independent", ["ok"]))
        trials = ["who,mixed,x,said"] + [f"P{p},{block},{delta},{'different' if i < k else 'same'}"
                                         for p, block, delta, n, k in rows for i in range(n)]
        told = self.json_of(trials, *options, "--trials", "--participant", "who", "--level", "x", "--answer", "said",
                            "--block", "mixed")
        self.assertAlmostEqual(found["loglik"], told["loglik"], delta=1e-7)
        nameless = ["participant,delta,n,k"] + [f"P{p},{delta},{n},{k}" for p, _, delta, n, k in rows]
        self.assertIn("mixed with more than one difference", self.calc(nameless, *options, code=3).stderr)
        self.assertIn("mixed with no difference", self.calc(lines + ["P0,c,0,12,3"], *options, code=3).stderr)
        text = self.calc(lines, *options).stdout
        self.assertIn("decided by each interval itself", text)

    def test_what_cannot_be_used(self):
        head = "participant,condition,delta,n,k"
        for lines, part in (([head, "P1,S,0,4,5"], "5 answers in 4 trials"), ([head, "P1,S,-3,4,2"], "delta"),
                            ([head, "P1,S,0,4,2"], "one level only"),
                            ([head, "P1,S,0,4,2", "P1,S,9,4,2", "P1,V,9,0,0"], "condition V has no trials"),
                            (["participant,delta,n", "P1,4,4"], "columns k and category"),
                            (["participant,delta,n,category", "P1,4,4,5"], "category"),
                            (["participant,x,n,k", "P1,4,4,2"], "unknown column")):
            done = self.calc(lines, "--task", "same-different", code=3)
            self.assertEqual((done.stdout, len(done.stderr.splitlines())), ("", 1))
            self.assertIn(part, done.stderr)
        done = self.calc([head, "P1,S,0,4,2"], "--task", "same-different", "--drift", code=3)
        self.assertIn("half", done.stderr)
        good = [head, "P1,S,0,4,1", "P1,S,9,4,3"]
        for options, part in ((("--task", "same-different", "--random", "tu,zz"), "zz is none of"),
                              (("--task", "same-different", "--random", "tw,rho"), "goes with tu and tw"),
                              (("--task", "same-different", "--lapse", "1"), "--lapse"),
                              (("--task", "same-different", "--drift", "--bootstrap", "9"), "a fixed --lapse"),
                              (("--task", "which"), "--standard is needed"),
                              (("--task", "which", "--observer", "differencing"), "--observer goes with"),
                              (("--task", "same-different", "--sureness", "c"), "--sureness goes with --trials"),
                              (("--task", "same-different", "--trials", "--block", "c"), "--block goes with"),
                              (("--task", "same-different", "--bootstrap", "9"), "--bootstrap tests one JND"),
                              (("--task", "same-different", "--check=-3"), "--check=N"),
                              ((), "--task")):
            done = self.calc(good, *options, code=2)
            self.assertIn(part, done.stderr)


if __name__ == "__main__":
    program.main()
