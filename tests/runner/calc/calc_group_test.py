#!/usr/bin/env python3
"""jnd calc compare, wilcoxon, ptukey, qtukey and shapiro from outside: shapes, numbers, messages, exit codes."""
import json
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REFERENCE = json.loads((program.ROOT / "analysis/selftest/group_reference.json").read_text())


def long_format(dataset):
    lines = ["participant,condition,value"]
    for number, row in enumerate(dataset["data"], 1):
        lines += [f"P{number},{name},{value}" for name, value in zip(dataset["conditions"], row)]
    return lines


class CalcGroup(program.Case):
    def calc(self, command, lines, *more, code=0):
        return program.run("calc", command, "-", *more, input=lines, code=code)

    def json_lines(self, command, lines, *more):
        return self.calc(command, lines, *more, "--json").lines

    def near(self, found, expected, tolerance):
        self.assertLessEqual(abs(found - expected), tolerance)

    def relative(self, found, expected, tolerance=1e-9):
        self.assertLessEqual(abs(found - expected), tolerance * abs(expected))

    def test_compare_agrees_with_the_reference(self):
        for dataset in REFERENCE["datasets"]:
            (found,) = self.json_lines("compare", long_format(dataset))
            self.assertEqual(found["n"], len(dataset["data"]))
            self.assertEqual(found["conditions"], dataset["conditions"])
            for j, row in enumerate(found["descriptives"]):
                self.assertEqual(row["condition"], dataset["conditions"][j])
                self.relative(row["mean"], dataset["mean"][j])
                self.relative(row["sd"], dataset["sd"][j])
                self.relative(row["ci_high"] - row["mean"], dataset["ci95_halfwidth_t"][j])
                self.relative(row["mean"] - row["ci_within_low"], dataset["ci95_within_morey"][j])
                self.near(row["shapiro"]["w"], dataset["shapiro"][j]["W"], 1e-8)
                self.near(row["shapiro"]["p"], dataset["shapiro"][j]["p"], 1e-6)
            anova, expected = found["anova"], dataset["rm_anova"]
            self.relative(anova["f"], expected["F"])
            for name in ("df1", "df2"):
                self.assertEqual(anova[name], expected[name])
            for name in ("p", "p_gg", "p_hf"):
                self.near(anova[name], expected[name], 1e-9)
            self.relative(found["epsilons"]["gg"], expected["eps_gg"])
            self.relative(found["epsilons"]["hf"], expected["eps_hf"])
            self.relative(found["mauchly"]["w"], dataset["mauchly"]["W"])
            self.near(found["mauchly"]["p"], dataset["mauchly"]["p"], 1e-9)
            self.relative(found["effect"]["eta2_generalised"], expected["eta2_generalized"])
            self.relative(found["effect"]["eta2_partial"], expected["eta2_partial"])
            for name, key in (("chi2", "chi2"), ("kendall_w", "kendall_W")):
                self.relative(found["friedman"][name], dataset["friedman"][key])
            self.near(found["friedman"]["p"], dataset["friedman"]["p"], 1e-9)
            for i, pair in enumerate(found["pairs"]):
                self.assertEqual(f"{pair['a']}-{pair['b']}", dataset["paired_t"][i]["pair"])
                self.relative(pair["mean_difference"], dataset["paired_t"][i]["diff"])
                self.relative(pair["t"]["t"], dataset["paired_t"][i]["t"])
                self.near(pair["t"]["p_holm"], dataset["paired_t"][i]["p_holm"], 1e-9)
                self.relative(pair["games_howell"]["q"], dataset["games_howell"][i]["q"])
                self.relative(pair["games_howell"]["df"], dataset["games_howell"][i]["df"])
                self.near(pair["games_howell"]["p"], dataset["games_howell"][i]["p"], 1e-6)
                self.near(pair["tukey"]["p"], dataset["tukey_rm"][i]["p"], 1e-6)
                self.assertEqual(pair["wilcoxon"]["v"], dataset["wilcoxon"][i]["V"])
                self.near(pair["wilcoxon"]["p"], dataset["wilcoxon"][i]["R_default_p"], 1e-12)

    def test_compare_takes_columns_and_rows_in_any_order(self):
        lines = long_format(REFERENCE["datasets"][0])
        (plain,) = self.json_lines("compare", lines)
        turned = [",".join(reversed(line.split(","))) for line in lines]
        self.assertEqual(self.json_lines("compare", turned), [plain])
        shuffled = lines[:1] + lines[:0:-1]  # the conditions appear as SV, V, S
        (other,) = self.json_lines("compare", shuffled)
        self.assertEqual(other["conditions"], ["SV", "V", "S"])
        self.relative(other["anova"]["f"], plain["anova"]["f"], 1e-12)

    def test_compare_refuses_incomplete_participants_with_one_message(self):
        lines = long_format(REFERENCE["datasets"][0])
        message = self.calc("compare", lines[:6] + lines[7:20] + lines[22:], code=3).stderr
        self.assertEqual(len(message.splitlines()), 1, message)
        self.says(message, ":5:1:", "2 of 18 participants", "P2 (no SV)", "P7 (no V, no SV)", "add the missing rows")
        message = self.calc("compare", lines + ["P3,V,300"], code=3).stderr
        self.assertEqual(len(message.splitlines()), 1, message)
        self.says(message, ":56:1:", "P3 has a second value under V", "keep one row")

    def test_bad_input_is_named_with_its_place(self):
        head = "participant,condition,value"
        for lines, part in (([head, "P1,S,1", "P2,S,2"], "S is the only condition"),
                            ([head, "P1,S,x"], ":2:"), ([head, "P1,,3"], "is empty"), ([head, ",S,3"], "is empty"),
                            ([head, "P1,S,1e300"], ":2:"), ([head], ""), (["participant,value", "P1,3"], "condition")):
            message = self.calc("compare", lines, code=3).stderr
            self.assertIn(part, message)
        self.calc("wilcoxon", ["x,y", "1,"], code=3)
        self.calc("qtukey", ["p", "1.5"], "--groups", "3", "--df", "5", code=3)
        for arguments in (("--groups", "1", "--df", "5"), ("--groups", "3", "--df", "0.5"), ("--groups", "3"),
                          ("--groups", "3", "--df", "nan")):
            self.calc("ptukey", ["q", "3"], *arguments, code=2)

    def test_what_is_undefined_is_null_with_a_status(self):
        head = "participant,condition,value"
        (found,) = self.json_lines("compare", [head, "P1,S,1", "P1,V,2"])
        self.assertEqual((found["status"], found["anova"]["f"], found["mauchly"]["w"]), ("too_few", None, None))
        (found,) = self.json_lines("compare", [head, "P1,S,1", "P1,V,2", "P2,S,3", "P2,V,7", "P3,S,2", "P3,V,8"])
        self.assertEqual(found["status"], "ok")
        self.assertEqual(found["mauchly"], {"w": None, "p": None, "status": "not_applicable"})
        self.near(found["anova"]["p"], found["pairs"][0]["t"]["p"], 1e-12)
        (found,) = self.json_lines("compare", [head, "P1,S,1", "P1,V,2", "P2,S,3", "P2,V,4"])
        self.assertEqual((found["anova"]["status"], found["anova"]["p"]), ("no_variance", None))
        self.assertEqual(found["pairs"][0]["t"]["status"], "no_variance")
        (found,) = self.json_lines("shapiro", ["x", "1", "2"])
        self.assertEqual(found, {"n": 2, "w": None, "p": None, "status": "too_few"})

    def test_wilcoxon_line_by_line(self):
        for one in REFERENCE["wilcoxon_extra"]:
            lines = ["x,y"] + [f"{x},{y}" for x, y in zip(one["x"], one["y"])]
            (found,) = self.json_lines("wilcoxon", lines)
            self.assertEqual((found["item"], found["n"], found["zeros"], found["ties"], found["v"]),
                             (None, one["n"], one["n_zero"], one["ties"], one["V"]))
            self.near(found["p"], one["R_default_p"], 1e-12)
            self.near(found["p_exact_permutation"], one["perm_exact_p_zeros_dropped"], 1e-12)
            self.near(found["rank_biserial"], one["rank_biserial_matched"], 1e-12)
            self.assertEqual(found["p_holm"], found["p"])
            self.assertEqual(found["method"], "exact" if "exact" in one["R_default_method"] else "normal")

    def test_ties_are_those_of_the_decimals(self):
        # R: example(wilcox.test), p of digits.rank = 9 and of the tenfold values.
        for unit in (0.1, 1, 100):
            lines = ["x,y"] + [f"{round(unit * x, 1)},{round(unit * (x - 1), 1)}" for x in (4, 3, 2)]
            (found,) = self.json_lines("wilcoxon", lines)
            self.assertEqual((found["ties"], found["method"], found["v"]), (True, "normal", 6))
            self.near(found["p"], 0.148914673178766, 1e-14)
            self.near(found["pratt"]["p_exact_permutation"], 0.25, 1e-15)
        rows = [f"P{i},{c},{v}" for i, pair in enumerate(((0.4, 0.3), (0.3, 0.2), (0.2, 0.1))) for c, v in zip("AB", pair)]
        (found,) = self.json_lines("compare", ["participant,condition,value"] + rows)
        self.near(found["pairs"][0]["wilcoxon"]["p"], 0.148914673178766, 1e-14)
        for command in ("wilcoxon", "compare"):
            self.assertIn("digits.rank", program.run("calc", command, "--help").stdout)

    def test_wilcoxon_corrects_over_the_items(self):
        ratings = REFERENCE["datasets"][1]["data"]
        lines = ["item,x,y"] + [f"Q{j},{row[0]},{row[j]}" for row in ratings for j in (1, 2)] + ["same,4,4", "same,5,5"]
        first, second, same = self.json_lines("wilcoxon", lines)
        self.assertEqual([first["item"], second["item"], same["item"]], ["Q1", "Q2", "same"])
        self.near(first["p_holm"], 2 * first["p"], 1e-15)
        self.assertEqual(second["p_holm"], max(second["p"], first["p_holm"]))
        self.assertEqual((same["zeros"], same["p"], same["p_holm"], same["method"], same["status"]),
                         (2, None, None, None, "no_variance"))

    def test_the_studentised_range(self):
        for one in REFERENCE["ptukey"]:
            (found,) = self.json_lines("ptukey", ["q", str(one["q"])], "--groups", str(one["k"]), "--df", str(one["df"]))
            self.near(found["p_upper"], one["upper_p"], 1e-9)
        for one in REFERENCE["qtukey"]:
            (found,) = self.json_lines("qtukey", ["p", str(one["p"])], "--groups", str(one["k"]), "--df", str(one["df"]))
            self.near(found["q"], one["q"], 1e-9)
        found = self.json_lines("qtukey", ["p", "0", "1"], "--groups", "4", "--df", "2")
        self.assertEqual(found, [{"p": 0, "q": 0}, {"p": 1, "q": "inf"}])

    def test_shapiro(self):
        for one in REFERENCE["shapiro_extra"]:
            (found,) = self.json_lines("shapiro", ["x"] + [str(x) for x in one["x"]])
            self.assertEqual(found["n"], one["n"])
            self.near(found["w"], one["W"], 1e-8)
            self.near(found["p"], one["p"], 1e-6)

    def test_people_get_tables(self):
        text = self.calc("compare", long_format(REFERENCE["datasets"][0])).stdout
        self.says(text, "18 of 18", "53.7", "2, 34", "V - SV", "Mauchly", "ignore the pairing")
        self.assertNotIn("nan", text)
        text = self.calc("compare", ["participant,condition,value", "P1,S,1", "P1,V,2"]).stdout
        self.assertIn("nothing can be tested", text)
        self.assertNotIn("nan", text)
        text = self.calc("wilcoxon", ["item,x,y", "A,1,2", "A,5,2", "B,1,1"]).stdout
        self.assertIn("rank-biserial", text)
        self.assertIn("nothing to test", text)
        self.assertIn("W = ", self.calc("shapiro", ["x", "1", "2", "5"]).stdout)
        self.assertIn("0.0355570", self.calc("ptukey", ["q", "3.5"], "--groups", "3", "--df", "inf").stdout)


if __name__ == "__main__":
    program.main()
