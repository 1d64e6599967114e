#!/usr/bin/env python3
"""jnd calc magnitude and adjust from outside: shapes, numbers, messages, exit codes."""
import json
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REFERENCE = json.loads((program.ROOT / "analysis/selftest/scaling_reference.json").read_text())["cases"]


def magnitude_lines(given):
    lines = ["participant,stimulus,answer"]
    for p, participant in enumerate(given["estimates"], 1):
        for stimulus, repeats in zip(given["stimuli"], participant):
            lines += [f"P{p},{stimulus},{answer}" for answer in repeats]
    return lines


def adjustment_lines(given):
    lines = ["start,setting,participant"]
    for p, one in enumerate(given["participants"], 1):
        lines += [f"{start},{setting},P{p}" for start, setting in zip(one["start"], one["setting"])]
    return lines


class CalcScaling(program.Case):
    def calc(self, command, lines, *more, code=0):
        return program.run("calc", command, "-", *more, input=lines, code=code)

    def json_of(self, command, lines, *more, code=0):
        return self.calc(command, lines, *more, "--json", code=code).json

    def agree(self, found, expected, where):
        """Every key of the reference, with its number; keys that the reference does not have may be there."""
        if isinstance(expected, dict):
            for key, value in expected.items():
                self.assertIn(key, found, where)
                if key in ("ci", "pse_ci") and None not in value:
                    # Relative to its width: one that ends near 0 has no digits of its own.
                    for one, other in zip(found[key], value):
                        self.assertLessEqual(abs(one - other), 1e-9 * (value[1] - value[0]), f"{where}.{key}")
                    continue
                self.agree(found[key], value, f"{where}.{key}")
        elif isinstance(expected, list):
            self.assertEqual(len(found), len(expected), where)
            for place, (one, other) in enumerate(zip(found, expected)):
                self.agree(one, other, f"{where}[{place}]")
        elif isinstance(expected, float):
            self.assertLessEqual(abs(found - expected), 1e-9 * abs(expected), where)
        else:
            self.assertEqual(found, expected, where)

    def test_every_reference_case(self):
        for case in REFERENCE:
            given, expected = case["input"], case["expected"]
            if "stimuli" in given:
                refused = expected["status"] == "refused"
                found = self.json_of("magnitude", magnitude_lines(given), code=3 if refused else 0)
            else:
                found = self.json_of("adjust", adjustment_lines(given), "--standard", str(given["standard"]))
            self.agree(found, expected, case["name"])

    def test_a_zero_refuses_the_set_with_its_places(self):
        lines = ["participant,stimulus,answer", "P1,100,4", "P1,200,0", "P2,100,3", "P2,200,6", "P2,200,-2"]
        done = self.calc("magnitude", lines, code=3)
        self.assertEqual(done.stdout, "")
        self.assertIn("-:3:", done.stderr.replace("standard input", "-").replace("<stdin>", "-"))
        self.says(done.stderr, "2 answers are not above 0", "P1, stimulus 200, answer 1: 0", "P2, stimulus 200, answer 2: -2")
        found = self.json_of("magnitude", lines, code=3)
        self.assertEqual(found, {"status": "refused", "not_positive": [[1, 2, 1, 0], [2, 2, 2, -2]]})

    def test_files_that_cannot_be_used(self):
        head = "participant,stimulus,answer"
        for lines, parts in (([head, "P1,0,4"], ("stimulus", "0 is not above 0")),
                             ([head, "P1,100,many"], ("answer", "many")),
                             ([head, ",100,4"], ("participant", "is empty")),
                             ([head, "P1,100,4", "P1,200,5", "P2,100,3"], ("P2 has no answer to 200",)),
                             (["stimulus,value", "1,2"], ("value",))):
            done = self.calc("magnitude", lines, code=3)
            self.assertEqual(len(done.stderr.splitlines()), 1)
            self.says(done.stderr, *parts)
        for lines, part in ((["setting,start", "4,0"], "is no side"), (["setting,start", "4,2"], "start"),
                            (["setting", "x"], "setting")):
            self.assertIn(part, self.calc("adjust", lines, "--standard", "4", code=3).stderr)
        self.calc("adjust", ["setting", "4"], code=2)
        self.calc("adjust", ["setting", "4"], "--standard", "0", code=2)

    def test_what_is_undefined_is_null_with_a_status(self):
        found = self.json_of("magnitude", ["stimulus,answer", "100,3", "400,3"])
        self.assertEqual(found["participants"][0]["participant"], None)
        law = found["group"]
        self.assertEqual((law["exponent"], law["r2"], law["r2_status"], law["se"], law["ci"], law["interval_status"]),
                         (0, None, "no_variance", None, [None, None], "too_few"))
        self.assertEqual(self.json_of("magnitude", ["stimulus,answer", "100,3"])["group"]["status"], "too_few")
        found = self.json_of("adjust", ["setting", "4"], "--standard", "5")
        one = found["participants"][0]
        self.assertEqual((one["n"], one["pse"], one["constant_error"], one["jnd"], one["pse_ci"], one["status"]),
                         (1, 4, -1, None, [None, None], "too_few"))
        self.assertEqual((one["start_status"], "start_effect" in one), ("not_applicable", False))
        self.assertEqual((found["group"]["ln_jnd_status"], found["group"]["constant_error_t"]), ("too_few", None))
        both = self.json_of("adjust", ["setting,start", "4,1", "4,1", "3,-1"], "--standard", "5")["participants"][0]
        self.assertEqual((both["start_effect"], both["variable_error"], both["start_test_status"], "start_t" in both),
                         (1, 0, "no_variance", False))

    def test_people_get_tables(self):
        text = self.calc("magnitude", magnitude_lines(REFERENCE[0]["input"])).stdout
        self.says(text, "exponent", "mean exponent 0.929, SD 0.0992", "5 participants", "group")
        self.assertNotIn("nan", text)
        text = self.calc("magnitude", ["stimulus,answer", "1,2", "2,2"]).stdout
        self.assertIn("Fewer than three stimuli", text)
        self.assertNotIn("nan", text)
        adjustments = next(case["input"] for case in REFERENCE if "standard" in case["input"])
        text = self.calc("adjust", adjustment_lines(adjustments), "--standard", "500").stdout
        self.says(text, "518", "23.2", "geometric mean of the JND 23.2", "start effect")
        self.assertNotIn("nan", self.calc("adjust", ["setting", "4"], "--standard", "5").stdout)


if __name__ == "__main__":
    program.main()
