#!/usr/bin/env python3
"""jnd calc jnd from outside: its JSON lines, its numbers, its table, and the mistakes that it locates."""
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

HEADER = "participant,condition,delta,n_diff,hits,n_same,false_alarms\n"
METHODS = ("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios",
           "ml_yes_no_common", "ml_yes_no_series", "ml_differencing_common", "ml_differencing_series",
           "least_squares_independent")
# Two participants whose rows are mixed, a participant at the ceiling, one without information, one with a missing series.
COUNTS = HEADER + """P1,S,400,6,6,6,1
P2,S,400,6,6,6,0
P1,S,300,6,5,6,1
P2,S,300,6,6,6,0
P1,V,400,6,4,6,2
P1,S,200,6,4,6,2
P2,S,200,6,6,6,0
P1,V,300,6,3,6,3
P1,V,200,6,2,6,4
P3,S,400,6,0,6,0
P3,S,200,6,0,6,0
P4,S,400,12,10,0,0
P4,S,300,6,5,6,1
"""


def run(*arguments, text=COUNTS, code=0):
    return program.run("calc", "jnd", *arguments, input=text, code=code)


class CalcJnd(program.Case):
    def lines(self, *arguments, text=COUNTS):
        return run("-", "--reference", "900", "--json", *arguments, text=text).lines

    def located(self, row, *words, header=HEADER, arguments=("-", "--reference", "900")):
        done = run(*arguments, text=header + row, code=3)
        self.refused(done, *words)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)

    def test_a_line_a_group_in_order_of_first_appearance(self):
        lines = self.lines()
        self.assertEqual([(line["participant"], line["condition"], line["series"]) for line in lines],
                         [("P1", "S", 3), ("P2", "S", 3), ("P1", "V", 3), ("P3", "S", 2), ("P4", "S", 2)])
        for line in lines:
            self.assertEqual(list(line), ["participant", "condition", "reference", "series", "falling", *METHODS])
            self.assertEqual(line["reference"], 900)
            for method in METHODS:
                self.assertEqual(list(line[method])[:8],
                                 ["slope", "jnd", "weber", "ci_low", "ci_high", "log_likelihood", "status", "cautions"])

    def test_the_numbers_of_the_reference(self):
        # An independent numpy model, 15 digits.
        first, ceiling, poor = self.lines()[:3]
        for method, jnd in (("least_squares", 190.266907183593), ("weighted", 194.741608535778),
                            ("inverse_mean_slope", 205.749529493637), ("mean_of_ratios", 213.287165567313)):
            self.assertAlmostEqual(first[method]["jnd"], jnd, delta=1e-8)
            self.assertAlmostEqual(first[method]["weber"], jnd / 900, delta=1e-10)
            self.assertAlmostEqual(first[method]["slope"] * first[method]["jnd"], 1, delta=1e-12)
            self.assertIsNone(first[method]["ci_low"])
            self.assertIsNone(first[method]["log_likelihood"])
        for method, slope, low, high, likelihood in (
                ("ml_yes_no_common", 0.00648446486716621, 96.3146737765987, 312.024430008863, -16.3341820585522),
                ("ml_yes_no_series", 0.00661934956538834, 93.7153672197046, 303.561427325185, -16.173647526906),
                ("ml_differencing_common", 0.0113570437622036, 59.9194096070565, 145.296506186354, -16.2644338517912),
                ("ml_differencing_series", 0.0114947732042757, 58.9365504341544, 142.228917539107, -15.9890299808434)):
            found = first[method]
            self.assertTrue(math.isclose(found["slope"], slope, rel_tol=1e-6), method)
            self.assertTrue(math.isclose(found["ci_low"], low, rel_tol=1e-5), method)
            self.assertTrue(math.isclose(found["ci_high"], high, rel_tol=1e-5), method)
            self.assertAlmostEqual(found["log_likelihood"], likelihood, delta=1e-9)
            self.assertEqual(found["status"], "ok")
        self.assertEqual(ceiling["ml_yes_no_series"]["slope"], "inf")
        self.assertEqual(ceiling["ml_yes_no_series"]["jnd"], 0)
        self.assertEqual(ceiling["ml_yes_no_series"]["ci_low"], 0)
        self.assertAlmostEqual(ceiling["ml_yes_no_series"]["ci_high"], 82.0700875052771, delta=1e-3)
        self.assertEqual(ceiling["ml_yes_no_series"]["status"], "ceiling")
        self.assertIn("floor", ceiling["least_squares"]["cautions"])
        self.assertEqual(poor["mean_of_ratios"]["status"], "no_sensitivity")
        self.assertIsNone(poor["mean_of_ratios"]["jnd"])
        self.assertEqual(poor["ml_yes_no_common"]["ci_high"], "inf")

    def test_no_information_and_missing_series_say_so(self):
        none, missing = self.lines()[3:]
        for method in METHODS:
            self.assertEqual(none[method]["status"], "no_information")
            self.assertIsNone(none[method]["slope"])
            self.assertIsNone(none[method]["jnd"])
            self.assertIn("series_missing", missing[method]["cautions"])
            self.assertEqual(missing[method]["series_used"], 1)

    def test_correction_and_reference_are_obeyed(self):
        row = HEADER + "P1,S,400,6,5,6,1\nP1,S,200,6,4,6,2\n"
        z = {(5, 6): 0.967421566101701, (4, 6): 0.430727299295457}
        slope = (400 * 2 * z[5, 6] + 200 * 2 * z[4, 6]) / (400**2 + 200**2)
        found = self.lines("--correction", "none", text=row)[0]["least_squares"]
        self.assertAlmostEqual(found["slope"], slope, delta=1e-12)
        done = run("-", "--reference", "450", "--json", "--correction", "none", text=row)
        self.assertAlmostEqual(done.json["least_squares"]["weber"], 1 / slope / 450, delta=1e-10)

    def test_bootstrap_gives_least_squares_an_interval_that_a_seed_repeats(self):
        once = self.lines("--bootstrap", "200", "--seed", "7")
        self.assertEqual(once, self.lines("--bootstrap", "200", "--seed", "7"))
        self.assertNotEqual(once, self.lines("--bootstrap", "200", "--seed", "8"))
        found = once[0]["least_squares"]
        self.assertLess(found["ci_low"], found["jnd"])
        self.assertEqual(sum(found["bootstrap"][status] for status in ("ok", "no_sensitivity", "ceiling", "no_information")), 200)
        fit = once[0]["ml_yes_no_series"]["fit"]
        self.assertEqual((fit["status"], fit["df"], fit["replicates"]), ("ok", 2, 200))
        self.assertTrue(0 < fit["deviance_p_bootstrap"] <= 1)
        self.assertIsNone(self.lines()[0]["ml_yes_no_series"]["fit"]["deviance_p_bootstrap"])

    def test_answers_that_fall_are_named(self):
        text = HEADER + "P1,S,100,12,8,12,11\nP1,S,200,12,4,12,10\nP1,S,300,12,1,12,11\n"
        done = run("-", "--reference", "900", "--json", text=text)
        self.assertTrue(done.json["falling"])
        self.assertIn("P1 S: the counted answers fall with the level, from 32 of 36 at 0 to 1 of 12 at 300", done.stderr)

    def test_the_same_difference_twice_is_two_series(self):
        line = self.lines(text=HEADER + "P1,S,300,6,5,6,1\nP1,S,300,6,4,6,2\n")[0]
        self.assertEqual(line["series"], 2)
        self.assertEqual(line["ml_yes_no_series"]["fit"]["df"], 1)

    def test_mistakes_are_one_located_message(self):
        self.located("P1,S,400,6,7,6,1\n", "standard input:2:5", "hits", "7 hits of 6")
        self.located("P1,S,400,6,5,6,9\n", "standard input:2:7", "false_alarms")
        self.located("P1,S,300,6,5,6,1\nP1,S,0,6,5,6,1\n", "standard input:3:3", "delta")
        self.located("P1,S,-200,6,5,6,1\n", "standard input:2:3", "delta")
        self.located("P1,S,many,6,5,6,1\n", "standard input:2:3", "many")
        self.located("P1,S,300,-6,0,6,1\n", "standard input:2:4", "n_diff")
        self.located("P1,S,300,6.5,0,6,1\n", "whole number")
        self.located("P1,S,300,6,5,6\n", "standard input:2")
        self.located("P1,S,300,6,5,6,1,2\n", "delta_k", header=HEADER.strip() + ",delta_k\n")
        self.located("P1,300,6,5,6,1\n", "condition", header=HEADER.replace("condition,", ""))
        self.located("", "no row")
        self.located("", "nothing.csv", arguments=("nothing.csv", "--reference", "900"))

    def test_usage_errors_exit_with_2(self):
        for arguments in (("-",), ("-", "--reference", "0"), ("-", "--reference", "-900"), ("-", "--reference", "nan"),
                          ("-", "--reference", "x"), ("-", "--reference", "900", "--correction", "log"),
                          ("-", "--reference", "900", "--bootstrap", "-1"), ("--reference", "900")):
            self.refused(run(*arguments, code=2))
        self.assertIn("above 0", run("-", "--reference", "0", code=2).stderr)

    def test_a_table_for_people(self):
        done = run("-", "--reference", "900")
        self.says(done.stdout, "P1", "ml_differencing_series", "190", "96 to 312", "ceiling", "no_information", "JND / 900")
        self.assertNotIn("\x1b", done.stdout)
        self.assertNotIn("nan", done.stdout)
        hostile = run("-", "--reference", "900", text=HEADER + '"\x1b[2J",S,300,6,5,6,1\n')
        self.assertNotIn("\x1b", hostile.stdout)

    def test_help_has_an_example(self):
        self.assertIn("jnd calc jnd counts.csv --reference 900", run("--help").stdout)


if __name__ == "__main__":
    program.main()
