#!/usr/bin/env python3
"""The planner from outside: jnd plan --precision, and the same block in jnd check."""
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class Precision(program.Shared):
    def plan(self, *arguments):
        return self.jnd("plan", "chinello2017", "--precision", "--json", *arguments).json["precision"]

    def condition(self, block, name):
        return next(row for row in block["conditions"] if row["condition"] == name)

    def test_without_a_protocol_it_is_the_published_design(self):
        out = self.jnd("plan", "--precision", "--jnd", "208.5", "--trials", "12", "--json").json
        self.assertEqual(out["precision"]["conditions"], self.plan("--jnd", "208.5", "--trials", "12")["conditions"])
        self.jnd("plan", "--participant", "1", code=2)

    def test_the_published_design(self):
        block = self.plan()
        sv = self.condition(block, "SV")
        self.assertEqual((sv["true_jnd"], sv["jnd_source"], sv["method"], sv["replicates"]), (208.5, "published", "enumeration", 0))
        self.assertAlmostEqual(sv["any_extreme_rate"], 0.82, delta=0.005)
        self.assertAlmostEqual(sv["estimate"]["median"], 228, delta=1.5)
        for name, share, trials in (("SV", 0.15, 122), ("S", 0.30, 200), ("V", 0.41, 293)):
            row = self.condition(block, name)
            self.assertAlmostEqual(row["any_dprime_not_positive"], share, delta=0.01)
            self.assertAlmostEqual(row["trials_for_cv"], trials, delta=1)
            self.assertAlmostEqual(sum(row["status"].values()), 1, places=9)
            self.assertAlmostEqual(row["bias_of_median"], row["estimate"]["median"] - row["true_jnd"], places=9)
        self.assertEqual((block["trials_per_cell"], block["sampling"], block["participants"]), (12, "random", 18))
        self.assertEqual(block["group"]["method"], "simulation")
        self.assertEqual([(c["a"], c["b"]) for c in block["group"]["contrasts"]], [("S", "V"), ("S", "SV"), ("V", "SV")])
        for contrast in block["group"]["contrasts"]:
            self.assertGreater(contrast["power_of_slopes"], contrast["power"])

    def test_options_change_the_question(self):
        block = self.plan("--jnd", "208.5", "--jnd", "V=351", "--trials", "40", "--participants", "12", "--cv", "0.2", "--between-cv", "0.2")
        self.assertEqual([row["true_jnd"] for row in block["conditions"]], [208.5, 351, 208.5])
        self.assertEqual({row["jnd_source"] for row in block["conditions"]}, {"asked"})
        self.assertEqual((block["trials_per_cell"], block["participants"], block["wanted_cv"], block["between_cv"]), (40, 12, 0.2, 0.2))
        sv = self.condition(block, "SV")
        self.assertEqual(sv["method"], "simulation")
        self.assertGreater(sv["replicates"], 0)
        self.assertGreater(sv["median_se"], 0)
        self.assertAlmostEqual(sv["trials_for_cv"], 122 / 4, delta=1)
        # The name wins over the value for all, whatever the order.
        other = self.plan("--jnd", "V=351", "--jnd", "208.5", "--trials", "40", "--participants", "12", "--cv", "0.2", "--between-cv", "0.2")
        self.assertEqual(other, block)

    def test_it_says_what_it_assumes_of_participants(self):
        text = self.jnd("plan", "chinello2017", "--precision").stdout
        self.assertRegex(text, r"(?m)^assumed: .*Phi\(\(difference - criterion\) / JND\), without bias .*without lapses.*; everyone has the true JND$")
        spread = self.jnd("plan", "chinello2017", "--precision", "--between-cv", "0.2").stdout
        self.assertRegex(spread, r"(?m)^assumed: .*; in the group true JNDs spread by 20 %$")
        self.assertIn("without lapses", self.plan()["assumed"])
        tasks = self.jnd("plan", "leib2015", "--precision", "--simulated", "20")
        self.assertRegex(tasks.stdout, r"(?m)^assumed: what is felt is the value plus normal noise.*without bias, without lapses")
        posterior = ("plan", "adaptive-posterior", "--precision", "--jnd", "300", "--simulated", "20")
        self.assertRegex(self.jnd(*posterior).stdout, r"(?m)^assumed: .*Phi\(difference / noise - [\d.]+\)")
        self.assertIn("criterion", self.jnd(*posterior, "--json").json["assumed"])

    def test_the_seed_decides(self):
        one, same, other = self.plan("--seed", "5"), self.plan("--seed", "5"), self.plan("--seed", "6")
        self.assertEqual(one, same)
        self.assertNotEqual(one["group"], other["group"])
        # What is enumerated does not depend on it.
        self.assertEqual(one["conditions"][0]["estimate"], other["conditions"][0]["estimate"])

    def test_extremes_have_no_bare_nan(self):
        for arguments in (("--trials", "1"), ("--jnd", "0.001"), ("--jnd", "1000000"), ("--participants", "1"), ("--trials", "2000", "--participants", "2")):
            block = self.plan(*arguments)
            self.assertEqual(len(block["conditions"]), 3)
        self.assertEqual(self.plan("--jnd", "1000000")["conditions"][0]["estimate"]["median"], "inf")
        self.assertIsNone(self.plan("--jnd", "0.001")["conditions"][0]["trials_for_cv"])
        self.assertIsNone(self.plan("--participants", "1")["group"]["conditions"][0]["ci_width"])

    def test_tables_for_people(self):
        out = self.jnd("plan", "chinello2017", "--precision").stdout
        self.assertIn("trials per cell for a CV of 10 %", out)
        self.assertIn("V - SV", out)
        self.assertNotIn("\x1b", out)
        self.assertNotIn("nan", out)
        markdown = self.jnd("plan", "chinello2017", "--precision", "--markdown").stdout
        rows = [line for line in markdown.splitlines() if line.startswith("|")]
        self.assertEqual(sum(line.startswith("|---") for line in rows), 4)
        self.assertTrue(any(line.startswith("| SV | 208.5 |") for line in rows))

    def test_wrong_options_are_told(self):
        for arguments, part in ((("--jnd", "X=5"), "S, V, SV"), (("--jnd", "SV=-5"), "above 0"), (("--jnd", "big"), "208.5"), (("--jnd", "S="), "above 0")):
            self.assertIn(part, self.jnd("plan", "chinello2017", "--precision", *arguments, code=2).stderr)
        self.assertIn("multiple of 4", self.jnd("plan", "chinello2017-balanced", "--precision", "--trials", "10", code=2).stderr)
        self.jnd("plan", "chinello2017", "--trials", "10", code=2)  # without --precision
        for arguments in (("--trials", "0"), ("--participants", "0"), ("--cv", "0"), ("--between-cv", "-1")):
            self.jnd("plan", "chinello2017", "--precision", *arguments, code=2)

    def test_check_has_the_same_block(self):
        for name in ("chinello2017", "chinello2017-balanced", "tutorial", "mckibben-stiffness", "cutaneous-kinaesthetic"):
            checked = self.jnd("check", name, "--json").json["precision"]
            planned = self.jnd("plan", name, "--precision", "--json").json["precision"]
            self.assertEqual(set(checked), set(planned))
            for one, other in zip(checked["conditions"], planned["conditions"]):
                self.assertEqual(one["condition"], other["condition"])
                self.assertEqual(one["any_extreme_rate"], other["any_extreme_rate"])
                self.assertEqual(one["trials_for_cv"], other["trials_for_cv"])
                if one["method"] == "enumeration":
                    self.assertEqual(one["estimate"], other["estimate"])
        text = self.jnd("check", "chinello2017").stdout
        self.says(text, "d' of 0 or less in some series", "coefficient of variation", "trials per cell for 10 %", "independent draws")

    def test_a_protocol_with_errors_has_no_precision(self):
        path = self.write("bad.json", "{}")
        self.assertIsNone(self.jnd("check", "--json", path, code=3).json["precision"])


if __name__ == "__main__":
    program.main()
