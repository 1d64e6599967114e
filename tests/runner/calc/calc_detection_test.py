#!/usr/bin/env python3
"""`jnd calc sdt` and `jnd calc coverage` from outside: shapes, statuses, numbers of R and sensR, messages."""
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

HEADER = "id,n_diff,hits,n_same,false_alarms\n"
EXTENDED = {"hit_rate", "false_alarm_rate", "z_hit", "z_false_alarm", "dprime", "criterion", "ln_beta", "se", "ci_low", "ci_high"}


def sdt(*rows):
    """The JSON lines of rows of (n_diff, hits, n_same, false_alarms)."""
    text = HEADER + "".join("row %d,%d,%d,%d,%d\n" % (i, *row) for i, row in enumerate(rows))
    return program.run("calc", "sdt", "-", "--json", input=text).lines


def leaves(value):
    if isinstance(value, dict):
        return [leaf for part in value.values() for leaf in leaves(part)]
    return [value]


class Sdt(program.Case):
    def near(self, ours, reference, tolerance=1e-9):
        self.assertLessEqual(abs(ours - reference), tolerance, (ours, reference))

    def test_shape(self):
        row, = sdt((6, 5, 6, 1))
        self.assertEqual(list(row)[:7], ["id", "n_diff", "hits", "n_same", "false_alarms", "status", "raw"])
        self.assertEqual((row["id"], row["n_diff"], row["hits"], row["n_same"], row["false_alarms"], row["status"]),
                         ("row 0", 6, 5, 6, 1, "ok"))
        for correction in ("none", "loglinear", "half"):
            self.assertEqual(set(row["yes_no"][correction]), EXTENDED)
        self.assertLessEqual({"dprime", "ci_low", "ci_high", "log_likelihood", "p_value", "status"}, set(row["yes_no"]["profile"]))
        self.assertLessEqual({"status", "dprime", "tau", "se_dprime", "se_tau", "log_likelihood", "ci_low", "ci_high", "p_value"},
                             set(row["differencing"]))
        self.assertLessEqual({"status", "dprime", "tau"}, set(row["differencing_loglinear"]))
        for correction in ("loglinear", "half"):
            self.assertLessEqual({"unit_slope", "exact"}, set(row["independent"][correction]))
        self.assertLessEqual({"mean", "sd", "q025", "q975"}, set(row["bootstrap"]))

    def test_numbers(self):
        # R 4.2.2 and sensR 1.5-3.
        row, = sdt((18, 15, 18, 4))
        self.near(row["raw"]["hit_rate"], 15 / 18)
        self.near(row["yes_no"]["loglinear"]["dprime"], 1.61593240784523)
        self.near(row["yes_no"]["loglinear"]["se"], 0.472461994115541)
        self.near(row["yes_no"]["none"]["ci_high"], 2.67592354935962)
        self.near(row["yes_no"]["half"]["ln_beta"], -0.175561800688093)
        self.near(row["yes_no"]["profile"]["ci_low"], 0.818272809007637, 1e-6)
        self.near(row["yes_no"]["profile"]["ci_high"], 2.7134918962175, 1e-6)
        self.near(row["yes_no"]["profile"]["p_value"], 2 * row["differencing"]["p_value"], 1e-15)
        self.near(row["differencing"]["dprime"], 3.09253182304492, 1e-8)
        self.near(row["differencing"]["se_dprime"], 0.620813785088044, 1e-8)
        self.near(row["differencing"]["ci_low"], 1.89905433470809, 1e-6)
        self.near(row["differencing"]["p_value"], 6.98642630661678e-05)
        self.near(row["differencing_loglinear"]["dprime"], 2.94196682273808, 1e-8)
        self.near(row["independent"]["loglinear"]["unit_slope"], 2.36081276573941)
        self.near(row["independent"]["half"]["exact"], 2.46837894988155, 1e-6)
        self.near(row["bootstrap"]["q975"], 2.53114595996872)

    def test_infinities_are_words(self):
        row, = sdt((6, 5, 6, 0))
        self.assertEqual(row["status"], "ok")
        none = row["yes_no"]["none"]
        self.assertEqual((none["dprime"], none["z_false_alarm"], none["se"], none["ci_low"]), ("inf", "-inf", None, None))
        self.assertEqual(row["yes_no"]["profile"]["ci_high"], "inf")
        self.assertEqual((row["differencing"]["dprime"], row["differencing"]["tau"]), ("inf", "inf"))
        self.near(row["differencing"]["ci_low"], 2.27112678695645, 1e-6)
        self.assertIsNone(row["differencing"]["se_tau"])

    def test_hits_rarer_than_false_alarms(self):
        row, = sdt((6, 2, 6, 4))
        self.assertEqual(row["status"], "ok")
        self.assertEqual((row["differencing"]["dprime"], row["differencing"]["p_value"], row["differencing"]["ci_low"]), (0, 0.5, 0))
        self.assertEqual((row["differencing_loglinear"]["status"], row["differencing_loglinear"]["dprime"]), ("no_sensitivity", 0))
        self.near(row["independent"]["loglinear"]["unit_slope"], -1.45971426967316)
        self.assertIsNone(row["independent"]["loglinear"]["exact"])

    def test_one_answer_throughout(self):
        for row in sdt((6, 0, 6, 0), (6, 6, 6, 6)):
            self.assertEqual(row["status"], "no_information")
            self.assertEqual(row["yes_no"]["loglinear"]["dprime"], 0)
            self.assertEqual(row["yes_no"]["half"]["dprime"], 0)
            self.assertIsNone(row["yes_no"]["none"]["dprime"])
            profile = row["yes_no"]["profile"]
            self.assertEqual((profile["dprime"], profile["ci_low"], profile["ci_high"]), (None, "-inf", "inf"))
            self.assertEqual(row["differencing"].pop("status"), "no_information")
            self.assertEqual(set(row["differencing"].values()), {None})
            self.assertEqual(row["differencing_loglinear"]["dprime"], 0)
            self.near(row["bootstrap"]["sd"], 0.535236972127489)

    def test_an_empty_class_has_no_number_at_all(self):
        for row in sdt((12, 7, 0, 0), (0, 0, 12, 3), (0, 0, 0, 0)):
            self.assertEqual(row["status"], "missing")
            for key in ("raw", "yes_no", "differencing", "differencing_loglinear", "independent", "bootstrap"):
                self.assertLessEqual(set(leaves(row[key])), {None, "missing"}, key)

    def test_very_many_trials(self):
        row, = sdt((1000000000, 999999999, 1000000000, 999999998))
        self.near(row["differencing"]["dprime"], 1.6651092223153955, 1e-9)
        for value in leaves(row):
            self.assertFalse(isinstance(value, float) and not math.isfinite(value))

    def test_columns_in_any_order_and_a_file(self):
        path = self.write("counts.csv", 'false_alarms,id,n_same,hits,n_diff\n1,"S, 500",6,5,6\n')
        row = self.jnd("calc", "sdt", path, "--json").json
        self.assertEqual((row["id"], row["hits"]), ("S, 500", 5))

    def test_a_person_reads_tables(self):
        done = self.jnd("calc", "sdt", "-", input=HEADER + "P01,6,5,6,1\nP02,6,6,6,6\nP03,6,2,0,0\n")
        self.says(done.stdout, "yes-no model, log-linear correction", "1.6     0.3 to 3.8", "3.3     1.2 to 5.7", "no_information", "missing",
                  "1 of 3 rows lack a class")
        self.assertNotIn("nan", done.stdout)

    def test_mistakes_are_one_located_message(self):
        for row, place, words in (("x,6,7,6,1", "standard input:2:3", "7 hits of 6"),
                                  ("x,6,5,6,8", "standard input:2:5", "8 false alarms of 6"),
                                  ("x,-6,5,6,1", "standard input:2:2", "n_diff"),
                                  ("x,6,five,6,1", "standard input:2:3", "hits"),
                                  ("x,6,5.5,6,1", "standard input:2:3", "hits"),
                                  ("x,6,,6,1", "standard input:2:3", "hits")):
            with self.subTest(row):
                done = self.jnd("calc", "sdt", "-", "--json", input=HEADER + row + "\n", code=3)
                self.refused(done, place, words)
                self.assertEqual(len(done.stderr.strip().splitlines()), 1)

    def test_a_mistake_in_the_last_row_prints_no_half_an_answer(self):
        done = self.jnd("calc", "sdt", "-", "--json", input=HEADER + "a,6,5,6,1\nb,6,7,6,1\n", code=3)
        self.refused(done, "standard input:3:3")


class Coverage(program.Case):
    def test_table(self):
        done = self.jnd("calc", "coverage", "--trials", "6,48")
        rows = [line.split() for line in done.stdout.splitlines() if line.split()[:1] in (["6"], ["48"])]
        self.assertEqual([len(row) for row in rows], 6 * [7] + 6 * [6])

    def test_json(self):
        lines = self.jnd("calc", "coverage", "--trials", "48", "--json").lines
        self.assertEqual([line["criterion"] for line in lines], [-0.5, 0, 0.5])
        for line in lines:
            for cell in line["coverage"]:
                self.assertTrue(0.93 < cell["profile"] < 0.97, line)

    def test_numbers_of_trials_have_bounds(self):
        for trials in ("0", "100000"):
            self.assertNotEqual(self.jnd("calc", "coverage", "--trials", trials, code=None).returncode, 0)


if __name__ == "__main__":
    program.main()
