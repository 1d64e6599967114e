#!/usr/bin/env python3
"""jnd calc identify, ratings and sureness from outside: shapes, numbers of R, statuses, messages."""
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


def run(command, *arguments, text, code=0):
    return program.run("calc", command, "-", *arguments, input=text, code=code)


def lines(*arguments, text):
    return run(*arguments, "--json", text=text).lines


def confusion_csv(names, matrix):
    return "stimulus,response,n\n" + "".join(
        "%s,%s,%d\n" % (stimulus, response, n)
        for stimulus, row in zip(names, matrix) for response, n in zip(names, row))


def ratings_csv(noise, signal):
    return "class,category,n\n" + "".join(
        "%s,%d,%d\n" % (name, j + 1, n) for name, row in (("noise", noise), ("signal", signal)) for j, n in enumerate(row))


def sureness_csv(deltas, counts):
    return "delta,category,n\n" + "".join(
        "%s,%d,%d\n" % (delta, j + 1, n) for delta, row in zip(deltas, counts) for j, n in enumerate(row))


class Ratings(program.Case):
    def near(self, ours, reference, tolerance=1e-6):
        self.assertLessEqual(abs(ours - reference), tolerance * max(1, abs(reference)), (ours, reference))

    def refused(self, command, text, code, *parts, options=()):
        super().refused(run(command, *options, text=text, code=code), *parts)

    # R 4.2.2, ordinal::clm, in each of the three.

    def test_identify(self):
        matrix = [[20, 8, 2], [6, 17, 7], [1, 9, 20]]
        row, = lines("identify", text=confusion_csv("ABC", matrix))
        self.assertEqual((row["group"], row["classes"], row["n"], row["status"]), (None, ["A", "B", "C"], 90, "ok"))
        self.near(row["information_bits"], 0.36071170681933906, 1e-12)
        self.near(row["miller_madow_bits"], 0.32865181702180657, 1e-12)
        self.near(row["relative"], 0.2275837482938654, 1e-12)
        self.near(row["equivalent_classes"], 1.2840591903090295, 1e-12)
        self.near(row["adjacent_loglinear"][0], 1.2235282623097516, 1e-12)
        self.near(row["ml"]["loglik"], -76.49764540232114)
        self.near(row["ml"]["mu"][2], 2.1890650622677357)
        self.near(row["ml"]["adjacent"][1]["dprime"], 1.0738692121232658)
        self.near(row["ml"]["adjacent"][1]["se"], 0.31255368205090034)
        self.near(row["ml"]["criteria"][0], 0.36872123354359176)
        self.assertEqual(row["ml"]["categories_used"], [1, 2, 3])
        # Numbers go by size; --classes has the last word.
        row, = lines("identify", text=confusion_csv(("9", "10", "200"), matrix))
        self.assertEqual(row["classes"], ["9", "10", "200"])
        turned, = lines("identify", "--classes", "200,10,9", text=confusion_csv(("9", "10", "200"), matrix))
        self.assertEqual(turned["classes"], ["200", "10", "9"])
        self.near(turned["ml"]["total_dprime"], row["ml"]["total_dprime"])  # both names are turned round
        self.near(turned["ml"]["adjacent"][0]["dprime"], row["ml"]["adjacent"][1]["dprime"])

    def test_identify_separated(self):
        row, = lines("identify", text=confusion_csv("AB", [[10, 0], [0, 10]]))
        self.assertEqual((row["status"], row["ml"]["total_dprime"], row["information_bits"]), ("separated", "inf", 1))
        self.assertEqual(row["ml"]["adjacent"], [{"dprime": "inf", "se": None}])
        row, = lines("identify", "--classes", "A,B,C", text=confusion_csv("AB", [[10, 2], [3, 10]]))
        self.assertEqual(row["adjacent_loglinear"][1], None)  # C was never presented
        done = run("identify", text=confusion_csv("AB", [[10, 0], [0, 10]]))
        self.assertIn("separated: groups of stimuli", done.stdout)

    def test_ratings(self):
        row, = lines("ratings", text=ratings_csv([60, 40, 25, 15, 7, 3], [20, 14, 12, 16, 28, 60]))
        self.assertEqual((row["categories_used"], row["status"]), ([1, 2, 3, 4, 5, 6], "ok"))
        equal, unequal = row["equal_variance"], row["unequal_variance"]
        self.near(equal["loglik"], -471.47759101098063, 1e-9)
        self.near(equal["dprime"], 1.2946107901192163)
        self.near(equal["A_z_se"], 0.024717396111754192)
        self.near(equal["criteria_se"][4], 0.12668140393850116)
        self.near(unequal["sigma"], 1.7921661118401637)
        self.near(unequal["d_a"], 1.2284915557764986)
        self.near(unequal["d_a_se"], 0.13953528804015897)
        self.near(unequal["lr_equal_variance"], 17.4498922961061)
        self.near(row["auc_trapezoid"], 0.8052444444444444, 1e-12)
        self.near(row["auc_delong_se"], 0.025468978139305782, 1e-12)

    def test_ratings_without_a_model(self):
        two, = lines("ratings", text=ratings_csv([22, 15], [5, 8]))
        self.assertEqual((two["unequal_variance"], two["unequal_variance_status"]), (None, "not_applicable"))
        self.assertEqual(two["status"], "ok")
        apart, = lines("ratings", text=ratings_csv([9, 1, 0, 0], [0, 0, 1, 9]))
        self.assertEqual((apart["status"], apart["equal_variance"]["dprime"], apart["equal_variance"]["A_z"]),
                         ("separated", "inf", 1))
        missing, = lines("ratings", text="class,category,n\nsignal,1,3\nsignal,2,4\n")
        self.assertEqual((missing["status"], missing["auc_trapezoid"]), ("missing", None))
        unbounded, = lines("ratings", text=ratings_csv([10, 10, 10, 10], [10, 0, 0, 10]))
        self.assertEqual((unbounded["unequal_variance_status"], unbounded["unequal_variance"]["sigma"]), ("unbounded", None))

    def test_sureness(self):
        row, = lines("sureness", text=sureness_csv((0, 250), [[14, 6, 3, 1], [4, 5, 7, 8]]))
        self.assertEqual((row["dK"], row["counts"][0], row["status"]), ([0, 250], [14, 6, 3, 1], "ok"))
        self.near(row["sigma"], 201.72002363674375)
        self.near(row["sigma_ci"][0], 130.97174219979865)
        self.near(row["sigma_ci"][1], 430.94427055958994)
        self.near(row["criteria"][2], 1.6848314059178502)
        self.near(row["ln_sigma_se"], 0.27335786826153385)
        self.near(row["lr_zero_slope"], 13.732792731260787)
        flat, = lines("sureness", text=sureness_csv((0, 150, 300), [[6, 6, 8, 10], [5, 3, 2, 2], [6, 3, 2, 1]]))
        self.assertEqual((flat["status"], flat["sigma"], flat["sigma_ci"][1], flat["ln_sigma_se"]), ("flat", "inf", "inf", None))
        self.near(flat["sigma_ci"][0], 1190.7599462987519, 1e-5)
        apart, = lines("sureness", text=sureness_csv((0, 250), [[10, 5, 0, 0], [0, 0, 4, 8]]))
        self.assertEqual((apart["status"], apart["sigma"], apart["sigma_ci"][0], apart["criteria"]), ("separated", 0, 0, []))
        single, = lines("sureness", text=sureness_csv((100,), [[10, 5, 2, 1]]))
        self.assertEqual((single["status"], single["sigma"]), ("not_identified", None))

    def test_groups(self):
        text = "group,delta,category,n\nP2,0,1,9\nP1,0,1,5\nP2,0,2,3\nP1,0,2,6\nP2,1,1,2\nP2,1,2,9\nP1,1,1,3\nP1,1,2,8\n"
        rows = lines("sureness", text=text)
        self.assertEqual([row["group"] for row in rows], ["P2", "P1"])
        self.assertEqual(rows[1]["counts"], [[5, 6], [3, 8]])

    def test_tables(self):
        done = run("sureness", text=sureness_csv((0, 250), [[14, 6, 3, 1], [4, 5, 7, 8]]))
        self.says(done.stdout, "202", "131 to 431", "0.230 0.934 1.685")
        done = run("ratings", text=ratings_csv([22, 15, 9, 4], [5, 8, 14, 23]))
        self.says(done.stdout, "equal variances", "1.24 ± 0.232", "unequal variances", "1.24 ± 0.233", "0.790 ± 0.0442")
        done = run("identify", text=confusion_csv("ABC", [[20, 8, 2], [6, 17, 7], [1, 9, 20]]))
        self.says(done.stdout, "0.361", "0.329", "63.3 %", "1.12 ± 0.312", "1.22")

    def test_refusals(self):
        self.refused("ratings", "class,category,n\nnoise,1,2\nnose,1,2\n", 3, "input:3:1: class", "noise and signal")
        self.refused("ratings", "class,category,n\nnoise,0,2\n", 3, "input:2:2: category")
        self.refused("ratings", "class,category,n\nnoise,1,-2\n", 3, "input:2:3: n")
        self.refused("ratings", "class,category,n\nnoise,1,1000000000\nnoise,1,1\n", 3, "input:3:3: n", "thousand million")
        self.refused("sureness", "delta,category,n\n-1,1,2\n", 3, "input:2:1: delta")
        self.refused("sureness", "delta,category,n\n1,1.5,2\n", 3, "input:2:2: category")
        self.refused("sureness", "delta,n\n1,2\n", 3, "category")
        self.refused("identify", confusion_csv("AB", [[10, 0], [0, 10]]), 3, "response", "--classes", options=("--classes", "A,C"))
        self.refused("identify", "stimulus,response,n\nA,B,4\n,A,5\n", 3, "input:3:1: stimulus", "name is missing")
        self.refused("identify", confusion_csv("AB", [[10, 0], [0, 10]]), 2, "twice", options=("--classes", "A,B,A"))


if __name__ == "__main__":
    program.main()
