#!/usr/bin/env python3
"""`jnd calc fit` from outside: shapes, reference numbers, statuses, and one located message for a mistake."""
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

LEVELS = "x,n,k\n600,20,1\n700,20,2\n800,20,6\n850,20,7\n900,20,11\n950,20,14\n1000,20,15\n1100,20,18\n1200,20,20\n"
FORCED = "k,x,n\n27,15,50\n15,30,32\n40,60,64\n28,90,40\n52,120,64\n21,180,24\n47,260,50\n47,400,50\n"
TWO = "group,x,n,k\n" + "".join(
    f"{group},{x},20,{k}\n"
    for group, ks in (("A", (1, 2, 6, 7, 11, 14, 15, 18, 20)), ("B", (0, 4, 9, 12, 14, 15, 18, 20, 20)))
    for x, k in zip((600, 700, 800, 850, 900, 950, 1000, 1100, 1200), ks))


class Fit(program.Case):
    def run_fit(self, text, *arguments, code=0):
        return self.jnd("calc", "fit", self.write("levels.csv", text), *arguments, code=code)

    def lines(self, text, *arguments):
        return self.run_fit(text, *arguments, "--json").lines

    def close(self, ours, theirs, relative=1e-8):
        self.assertTrue(math.isclose(ours, theirs, rel_tol=relative), (ours, theirs))

    def test_agrees_with_r(self):
        (fit,) = self.lines(LEVELS, "--function", "gaussian", "--guess", "0", "--lapse", "0")
        self.assertLessEqual({"group", "function", "parameters", "se", "guess", "lapse", "log_likelihood", "deviance",
                              "deviance_p", "pse", "jnd", "slope", "ci", "status"}, set(fit))
        self.assertIsNone(fit["group"])
        self.assertEqual(fit["status"], "ok")
        self.assertEqual(list(fit["parameters"]), ["mu", "sigma"])
        self.assertEqual((fit["guess"], fit["lapse"]), (0, 0))
        self.close(fit["parameters"]["mu"], 885.659870846223)
        self.close(fit["parameters"]["sigma"], 152.922531298339)
        self.close(fit["se"]["mu"], 17.3487526693139)
        self.close(fit["se"]["sigma"], 20.3996186848241)
        self.close(fit["log_likelihood"], -80.1815263004447)
        self.close(fit["deviance"], 1.62983693666607)
        self.close(fit["jnd"], 103.144679934769)
        for name in ("pse", "jnd"):
            low, high = fit["ci"][name]
            self.assertLess(low, fit[name])
            self.assertGreater(high, fit[name])

    def test_single_trials_have_no_chi_square_p(self):
        trials = "level,answer\n" + "".join(f"{i},{int(i % 4 < i // 10)}\n" for i in range(40))
        options = ("--trials", "--level", "level", "--answer", "answer", "--positive", "1", "--function", "gaussian",
                   "--guess", "0", "--lapse", "0")
        self.says(self.run_fit(trials, *options).stdout, "few_trials", "--interval bootstrap")
        (fit,) = self.lines(trials, *options)
        self.assertEqual((fit["deviance_p"], fit["deviance_p_status"], fit["falling"]), (None, "few_trials", False))

    def test_answers_that_fall_are_named(self):
        done = self.run_fit("x,n,k\n1,20,18\n2,20,10\n3,20,2\n", "--function", "gaussian", "--guess", "0",
                            "--lapse", "0", "--json")
        self.assertTrue(done.lines[0]["falling"])
        self.says(done.stderr, "from 18 of 20 at 1 to 2 of 20 at 3", "coded the other way round", "--positive")

    def test_a_free_lapse_is_a_parameter(self):
        (fit,) = self.lines(FORCED, "--function", "weibull", "--guess", "0.5", "--lapse", "free")
        self.assertEqual(list(fit["parameters"]), ["scale", "shape", "lapse"])
        self.close(fit["parameters"]["scale"], 112.482097666683)
        self.close(fit["parameters"]["shape"], 1.87620550295309)
        self.close(fit["lapse"], 0.0601994519422996)
        self.close(fit["se"]["lapse"], 0.0270375378456534)
        (prior,) = self.lines(FORCED, "--function", "weibull", "--guess", "0.5", "--lapse", "free", "--estimator", "map")
        self.assertEqual(prior["estimator"], "map")
        self.assertLess(prior["lapse"], fit["lapse"])
        self.assertLess(prior["log_likelihood"], fit["log_likelihood"])

    def test_bootstrap_repeats_itself_and_fits_alone_as_among_others(self):
        options = ("--function", "logistic", "--guess", "0", "--lapse", "0", "--interval", "bootstrap", "--replicates",
                   "300", "--seed", "7")
        (alone,) = self.lines(LEVELS, *options)
        among = self.lines(TWO, *options)
        self.assertEqual(alone["ci"], among[0]["ci"])
        self.assertEqual(alone["interval"], "bootstrap")
        self.assertEqual(alone["bootstrap"]["replicates"], 300)
        (other,) = self.lines(LEVELS, *options[:-1], "8")
        self.assertNotEqual(alone["ci"], other["ci"])
        self.assertTrue(0 < alone["bootstrap"]["deviance_p"] <= 1)

    def test_groups_are_compared(self):
        a, b, comparison = self.lines(TWO, "--function", "gaussian", "--guess", "0", "--lapse", "0", "--compare")
        self.assertEqual((a["group"], b["group"]), ("A", "B"))
        models = {model["model"]: model for model in comparison["comparison"]["models"]}
        self.assertEqual(list(models), ["same_function", "own_location", "own_slope", "own_function"])
        self.close(models["own_function"]["log_likelihood"], a["log_likelihood"] + b["log_likelihood"], 1e-12)
        tests = comparison["comparison"]["tests"]
        self.assertEqual([test["df"] for test in tests], [1, 1, 2, 1, 1])
        for test in tests:
            difference = (models[test["general"]]["log_likelihood"] - models[test["simpler"]]["log_likelihood"])
            self.close(test["chi2"], 2 * difference, 1e-9)
            expected = math.exp(-test["chi2"] / 2) if test["df"] == 2 else math.erfc(math.sqrt(test["chi2"] / 2))
            self.close(test["p"], expected, 1e-9)
        message = self.run_fit(LEVELS, "--function", "gaussian", "--guess", "0", "--lapse", "0", "--compare", code=3)
        self.assertIn("group", message.stderr)

    def test_statuses_and_nulls(self):
        data = ("group,x,n,k\nflat,1,10,5\nflat,2,10,5\nflat,3,10,5\nzero,1,10,0\nzero,2,10,0\none,1,10,4\n"
                "step,1,10,0\nstep,2,10,0\nstep,3,10,10\nstep,4,10,10\n")
        fits = {fit["group"]: fit for fit in
                self.lines(data, "--function", "logistic", "--guess", "0", "--lapse", "0")}
        self.assertEqual({name: fit["status"] for name, fit in fits.items()},
                         {"flat": "not_increasing", "zero": "no_information", "one": "not_identified",
                          "step": "separated"})
        for name in ("flat", "zero", "one"):
            self.assertIsNone(fits[name]["pse"])
            self.assertIsNone(fits[name]["jnd"])
            self.assertIsNone(fits[name]["parameters"]["beta"])
        self.assertEqual(fits["step"]["jnd"], 0)
        self.assertEqual(fits["step"]["slope"], "inf")
        self.assertIsNone(fits["step"]["pse"])
        self.assertEqual(fits["step"]["ci"]["slope"][1], "inf")
        self.assertEqual(fits["zero"]["ci"]["jnd"], [None, None])
        self.assertEqual(fits["zero"]["guess"], 0)

    def test_mistakes_are_one_located_message(self):
        options = ("--function", "weibull", "--guess", "0.5", "--lapse", "free")
        for text, place in (("x,n,k\n1,10,5\n2,10,11\n", ":3:3: k: "), ("x,n,k\n1,-1,0\n", ":2:2: n: "),
                            ("x,n,k\n1,10,5\n0,10,5\n", ":3:1: x: "), ("x,n,k\n1,10,many\n", ":2:3: k: "),
                            ("x,n,k\n1,10.5,5\n", ":2:2: n: "), ("x,n,k\n1,10,-1\n", ":2:3: k: "),
                            ("x,n\n1,10\n", ":1:"), ("x,n,k,z\n1,10,5,1\n", ":1:4:"), ("x,n,k\n", ":1:")):
            done = self.run_fit(text, *options, code=3)
            self.assertIn(place, done.stderr, text)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertEqual(done.stdout, "")
        linear = ("--function", "gumbel", "--guess", "0.5", "--lapse", "free")
        self.run_fit("x,n,k\n-1,10,5\n0,10,6\n1,10,9\n", *linear)

    def test_usage(self):
        for options in (("--function", "cubic", "--guess", "0", "--lapse", "0"), ("--guess", "0", "--lapse", "0"),
                        ("--function", "logistic", "--guess", "1", "--lapse", "0"),
                        ("--function", "logistic", "--guess", "some", "--lapse", "0"),
                        ("--function", "logistic", "--guess", "0.6", "--lapse", "0.5"),
                        ("--function", "logistic", "--guess", "0", "--lapse", "0", "--estimator", "map"),
                        ("--function", "logistic", "--guess", "0", "--lapse", "0", "--interval", "wald")):
            self.run_fit(LEVELS, *options, code=2)

    def test_a_person_reads_tables(self):
        out = self.run_fit(TWO, "--function", "gaussian", "--guess", "0", "--lapse", "free", "--compare").stdout
        self.says(out, "gaussian function, guess 0, lapse free", "886", "846 to 920", "95 % profile", "own_location", "chi-square", "lapse_at_bound: ")
        self.assertNotIn("\x1b", out)
        self.assertNotIn("nan", out)


if __name__ == "__main__":
    program.main()
