#!/usr/bin/env python3
"""Experiment 2 from outside: free interaction and its questionnaire, simulated, analysed, exported, verified."""
import csv
import itertools
import os
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

PROTOCOL = "chinello2017-experiment2"
SIMULATE = ("simulate", PROTOCOL, "--participants", 12, "--seed", 1)
ITEMS = [f"QB{i}" for i in range(1, 10)] + [f"QC{i}" for i in range(1, 4)] + [f"QD{i}" for i in range(1, 6)]


def exact_p(differences):
    """Two-sided permutation p of the signed-rank sum with midranks, by enumeration."""
    kept = [d for d in differences if d != 0]
    sizes = sorted(abs(d) for d in kept)
    rank = {s: (2 * sizes.index(s) + sizes.count(s) + 1) / 2 for s in sizes}
    ranks = [rank[abs(d)] for d in kept]
    middle = sum(ranks) / 2
    found = abs(sum(r for r, d in zip(ranks, kept) if d > 0) - middle)
    extreme = sum(abs(sum(r for r, s in zip(ranks, signs) if s) - middle) >= found - 1e-9
                  for signs in itertools.product((0, 1), repeat=len(ranks)))
    return extreme / 2 ** len(ranks)


class Experiment2(program.Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.said = cls.jnd(*SIMULATE, "--study", "e2.sqlite").stdout

    def analysis(self, study="e2.sqlite"):
        return self.jnd("analyze", study, "--json").json

    def ratings(self):
        """Item -> condition -> participant -> rating, out of the exported answers."""
        if not os.path.exists(self.folder / "out"):
            self.jnd("export", "e2.sqlite", "--to", "out")
        found = {}
        for row in self.rows("out", "answers.csv"):
            if row["question"].startswith("Q"):
                found.setdefault(row["question"], {}).setdefault(row["condition"], {})[row["participant"]] = int(row["answer"])
        return found

    def test_everybody_explores_everything_for_its_time(self):
        self.assertIn("48 explorations, 0 voided", self.said)
        exposure = self.analysis()["exposure"]
        self.assertEqual({(row["condition"], row["object"]) for row in exposure},
                         {(c, o) for c in "CN" for o in ("baseball", "teddy-bear")})
        for row in exposure:
            self.assertEqual(row["n"], 12)
            self.assertAlmostEqual(row["mean_s"], 150, places=6)
            self.assertAlmostEqual(row["shortest_s"], 150, places=6)

    def test_the_layout_is_the_papers(self):
        items = self.analysis()["items"]
        self.assertEqual([row["item"] for row in items if row["condition"] == "C"], ITEMS)
        once = [row["item"] for row in items if row["condition"] is None]
        self.assertEqual(once, ["age", "QA1", "QA2", "QA3", "QA4"])
        age = items[0]
        self.assertEqual((age["n"], age["n_below"]), (12, None))  # a number is no rating: its range has no middle
        self.assertTrue(age["ci_low"] < age["mean"] < age["ci_high"])
        ratings = self.ratings()
        for item in ITEMS:
            self.assertEqual({c: len(r) for c, r in ratings[item].items()}, {"C": 12, "N": 12})
        for item in once[1:]:
            self.assertEqual({c: len(r) for c, r in ratings[item].items()}, {"": 12})
        values = [v for item in ratings.values() for by in item.values() for v in by.values()]
        self.assertTrue(all(1 <= v <= 9 for v in values))

    def test_the_tests_are_wilcoxons_and_their_corrections_are_there(self):
        result, ratings = self.analysis(), self.ratings()
        means = {row["item"]: row["mean"] for row in result["items"] if row["condition"] == "C"}
        p = {}
        for pair in result["ratings"]:
            by = ratings[pair["item"]]
            differences = [by["C"][who] - by["N"][who] for who in sorted(by["C"])]
            p[pair["item"]] = exact_p(differences)
            self.assertAlmostEqual(pair["p_exact_permutation"], p[pair["item"]], places=12)
            self.assertEqual(pair["zeros"], differences.count(0))
            self.assertAlmostEqual(means[pair["item"]], sum(by["C"].values()) / 12, places=12)
        self.assertEqual([*p], ITEMS)
        order = sorted(p, key=p.get)
        worst, best = 0, 1
        holm, bh = {}, {}
        for i, item in enumerate(order):
            worst = holm[item] = min(1, max(worst, (17 - i) * p[item]))
        for i, item in reversed(list(enumerate(order))):
            best = bh[item] = min(best, 17 / (i + 1) * p[item])
        for pair in result["ratings"]:
            self.assertAlmostEqual(pair["p_exact_holm"], holm[pair["item"]], places=12)
            self.assertAlmostEqual(pair["p_exact_bh"], bh[pair["item"]], places=12)
        found, kept = (sum(v < 0.05 for v in values.values()) for values in (p, holm))
        self.says(result["verdict"], f"{found} of 17 Wilcoxon tests", f"{kept} with Holm's")

    def test_all_prefer_the_devices_as_published(self):
        options = self.analysis()["choices"]
        self.assertEqual([option["count"] for option in options], [12, 0])
        self.assertAlmostEqual(options[0]["ci_low"], 0.025 ** (1 / 12), places=10)
        self.assertEqual(options[0]["ci_high"], 1)

    def test_tables_export_report_and_methods(self):
        text = self.jnd("analyze", "e2.sqlite", "--methods", "methods.md").stdout
        self.says(text, "Free interaction", "Answers to the questions", "asked once", "Answers compared between conditions", "Of 17 tests, below 0.05",
                  "6.7 ± 7.6")
        self.assertNotIn("JND", text.split("\n", 2)[2].replace("jnd", ""))
        self.assertIn("The 17 tests are one family", self.read("methods.md"))
        self.ratings()
        self.assertEqual(len(self.rows("out", "items.csv")), 17 * 2 + 5)
        self.assertEqual(len(self.rows("out", "ratings.csv")), 17)
        described = {(row["file"], row["column"]) for row in self.rows("out", "dictionary.csv")}
        for name in ("items.csv", "choices.csv", "exposure.csv", "answers.csv"):
            for column in next(csv.reader(self.read("out", name).splitlines())):
                self.assertIn((name, column), described)
        self.jnd("export", "e2.sqlite", "--to", "out", "--replace")  # knows its own files again
        self.jnd("report", "e2.sqlite", "--to", "page.html")
        page = self.read("page.html")
        self.assertIn("after free interaction", page)
        self.assertIn("Answers compared between conditions", page)

    def test_other_commands_know_it(self):
        self.assertIn("every planned stimulus agrees", self.jnd("verify", "e2.sqlite").stdout)
        self.assertIn("4 of 4", self.jnd("status", "e2.sqlite").stdout)
        self.jnd("plan", PROTOCOL, "--participant", "1")
        self.jnd("plan", PROTOCOL, "--cohort", "12")

    def test_an_interrupted_simulation_goes_on_to_the_same_study(self):
        for _ in range(3):
            with program.start(*SIMULATE, "--study", "again.sqlite", folder=self.folder) as running:
                program.kill_within(running, 0.7)
        self.jnd(*SIMULATE, "--study", "again.sqlite")
        self.jnd("verify", "again.sqlite")
        self.assertEqual(self.analysis("again.sqlite"), self.analysis())


if __name__ == "__main__":
    program.main()
