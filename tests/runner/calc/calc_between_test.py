#!/usr/bin/env python3
"""jnd calc compare with the column group from outside: groups alone, groups with conditions, messages, exit codes."""
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

HEAD = "participant,group,condition,value"
FIRST = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0]  # R's data set sleep
SECOND = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4]
MIXED = [HEAD, "P1,A,x,1", "P1,A,y,3", "P2,A,x,2", "P2,A,y,5", "P3,B,x,4", "P3,B,y,4.5", "P4,B,x,6", "P4,B,y,5",
         "P5,B,x,5", "P5,B,y,7"]


class CalcBetween(program.Case):
    def calc(self, lines, *more, code=0):
        return program.run("calc", "compare", "-", *more, input=lines, code=code)

    def json_of(self, lines):
        return self.calc(lines, "--json").json

    def test_groups_alone(self):
        lines = [HEAD] + [f"P{i},first,d,{v}" for i, v in enumerate(FIRST)]
        lines += [f"Q{i},second,d,{v}" for i, v in enumerate(SECOND)]
        found = self.json_of(lines)
        self.assertEqual((found["design"], found["n"], found["groups"]), ("between", 20, ["first", "second"]))
        (pair,) = found["pairs"]
        self.assertAlmostEqual(pair["welch"]["t"], -1.8608, delta=5e-5)  # as R's help pages print them
        self.assertAlmostEqual(pair["welch"]["p"], 0.07939, delta=5e-6)
        self.assertEqual((pair["mann_whitney"]["w"], pair["mann_whitney"]["method"]), (25.5, "normal"))
        self.assertAlmostEqual(pair["mann_whitney"]["p"], 0.06933, delta=5e-6)
        (group,) = found["anova"]
        self.assertEqual((group["effect"], group["df1"], group["df2"]), ("group", 1, 18))
        # Of two groups of one size F is the square of t.
        self.assertAlmostEqual(group["f"], pair["welch"]["t"] ** 2, delta=1e-12)
        self.assertEqual(self.json_of([line.replace(",d,", ",").replace(",condition", "") for line in lines]) | {"conditions": ["d"]}, found)
        self.assertIn('there is no column "condition"', self.calc(["participant,value", "P1,3"], code=3).stderr)

    def test_groups_with_conditions(self):
        found = self.json_of(MIXED)
        self.assertEqual((found["design"], found["conditions"], found["cautions"]),
                         ("mixed", ["x", "y"], ["unequal_groups"]))
        anova = {row["effect"]: row for row in found["anova"]}
        for name, ss, error, f in (("group", 15, 5.5, 90 / 11), ("condition", 4.225, 2.5, 5.07),
                                   ("group x condition", 2.4, 2.5, 2.88)):  # by hand
            self.assertAlmostEqual(anova[name]["ss"], ss, delta=1e-12)
            self.assertAlmostEqual(anova[name]["ss_error"], error, delta=1e-12)
            self.assertAlmostEqual(anova[name]["f"], f, delta=1e-11)
            self.assertEqual((anova[name]["df1"], anova[name]["df2"]), (1, 3))
        self.assertEqual([(p["condition"], p["mann_whitney"]["method"]) for p in found["pairs"]],
                         [("x", "exact"), ("y", "normal")])
        self.assertAlmostEqual(found["pairs"][0]["mann_whitney"]["p"], 0.2, delta=1e-15)
        self.assertEqual(self.json_of(MIXED[:9])["cautions"], [])

    def test_without_groups_nothing_changes(self):
        found = self.json_of(["participant,condition,value", "P1,S,1", "P1,V,2", "P2,S,3", "P2,V,7"])
        self.assertNotIn("design", found)

    def test_what_is_undefined_is_null_with_a_status(self):
        found = self.json_of([HEAD, "P1,A,x,1", "P2,B,x,2"])
        self.assertEqual((found["anova"][0]["f"], found["anova"][0]["status"]), (None, "too_few"))
        self.assertEqual((found["pairs"][0]["welch"]["p"], found["pairs"][0]["welch"]["status"]), (None, "too_few"))
        found = self.json_of([HEAD, "P1,A,x,1", "P2,A,x,1", "P3,B,x,1", "P4,B,x,1"])
        self.assertEqual(found["anova"][0]["status"], "no_variance")
        self.assertEqual(found["pairs"][0]["mann_whitney"]["status"], "no_variance")

    def test_files_that_cannot_be_used(self):
        for lines, part in ((MIXED[:3] + ["P1,B,z,4"], "P1 is in two groups: A and B"), (MIXED[:5], "A is the only group"),
                            (MIXED[:-1], "P5 (no y)"), (MIXED + ["P5,B,y,8"], "a second value under y"),
                            ([HEAD, "P1,A,x,1", "P2,A,y,1", "P3,B,x,1"], "group A has x and y"),
                            ([HEAD, "P1,,x,1"], "every row names its group")):
            done = self.calc(lines, code=3)
            self.assertEqual((done.stdout, len(done.stderr.splitlines())), ("", 1))
            self.assertIn(part, done.stderr)

    def test_people_get_tables(self):
        text = self.calc(MIXED).stdout
        self.says(text, "5 participants", "group x condition", "Mann-Whitney W", "type I")
        self.assertNotIn("nan", text)
        self.assertIn("too few participants in the groups", self.calc([HEAD, "P1,A,x,1", "P2,B,x,2"]).stdout)


if __name__ == "__main__":
    program.main()
