#!/usr/bin/env python3
"""jnd calc mafc, oddity, duo-trio, abx and reminder from outside: shapes, numbers of R, statuses, messages."""
import math
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

RATES = "n_signal,hits,n_noise,false_alarms\n"


def run(command, *arguments, text, code=0):
    return program.run("calc", command, "-", *arguments, input=text, code=code)


def lines(*arguments, text):
    return run(*arguments, "--json", text=text).lines


class Counts(program.Case):
    def near(self, row, dprime, se, low, high):
        for ours, reference in zip((row["dprime"], row["se"], *row["dprime_ci"]), (dprime, se, low, high)):
            self.assertAlmostEqual(ours, reference, delta=1e-6)

    def test_numbers(self):
        # R 4.2.2 with psyphy and sensR.
        def one(*arguments, n, correct):
            return lines(*arguments, text="n,correct\n%d,%d\n" % (n, correct))[0]
        self.near(one("mafc", "--alternatives", "2", n=40, correct=30),
                  0.9538725524089856, 0.3046939012443772, 0.36915952891483195, 1.5663110478117797)
        self.near(one("mafc", "--alternatives", "3", n=36, correct=25),
                  1.2172091665956888, 0.2854714861769388, 0.6677445228251893, 1.7891400210884238)
        self.near(one("mafc", "--alternatives", "4", n=48, correct=20),
                  0.5748495809200007, 0.22663868435459963, 0.12878065797135677, 1.0181353769705812)
        self.near(one("oddity", n=36, correct=22), 2.03209941467165, 0.4143497914475807, 1.1832484011895092, 2.851523052943194)
        self.near(one("duo-trio", n=40, correct=30), 2.0200391930396098, 0.4327356792770312, 1.1341421061868162, 2.8959767860917833)
        self.near(one("abx", "--strategy", "differencing", n=48, correct=35),
                  1.8906562331718137, 0.3920464566084786, 1.074561416732029, 2.670049820282897)
        self.near(one("abx", "--strategy", "independent", n=48, correct=35),
                  1.6798499067799237, 0.33633080147556027, 0.965827548922818, 2.3325710615176813)

    def test_shape_and_statuses(self):
        rows = lines("mafc", "--alternatives", "3", text="id,n,correct\nall,36,36\nnone,36,0\nempty,0,0\n")
        self.assertEqual(list(rows[0]), ["id", "n", "correct", "pc", "dprime", "se", "loglik", "dprime_ci", "status"])
        self.assertEqual([row["id"] for row in rows], ["all", "none", "empty"])
        self.assertEqual([row["status"] for row in rows], ["ceiling", "floor", "missing"])
        self.assertEqual((rows[0]["dprime"], rows[0]["dprime_ci"][1], rows[0]["se"]), ("inf", "inf", None))
        self.assertAlmostEqual(rows[0]["dprime_ci"][0], 2.685378592194619, delta=1e-6)
        self.assertEqual((rows[1]["dprime"], rows[1]["dprime_ci"][0]), ("-inf", "-inf"))
        self.assertEqual((rows[2]["dprime"], rows[2]["dprime_ci"]), (None, [None, None]))

    def test_chance(self):
        row, = lines("oddity", text="n,correct\n36,10\n")
        self.assertEqual((row["id"], row["dprime"], row["se"], row["status"]), (None, 0, None, "not_above_chance"))
        self.assertEqual(row["dprime_ci"][0], 0)
        self.assertAlmostEqual(row["dprime_ci"][1], 1.1746432141816538, delta=1e-6)
        self.assertAlmostEqual(row["loglik"], -21.52821569749337, delta=1e-9)
        row, = lines("mafc", "--alternatives", "2", text="n,correct\n40,10\n")
        self.assertAlmostEqual(row["dprime"], -0.9538725524089856, delta=1e-6)  # signed

    def test_table(self):
        done = run("mafc", "--alternatives", "3", text="id,n,correct\nP01,36,25\nP02,36,36\n")
        self.says(done.stdout, "3 alternatives", "P01", "25/36", "1.22", "0.67 to 1.79", "inf", "ceiling: every answer was right")

    def test_refusals(self):
        for arguments, text, code, parts in (
                (("mafc", "--alternatives", "3"), "n,correct\n12,5\n12,13\n", 3, ("input:3:2: correct", "at most n")),
                (("mafc", "--alternatives", "3"), "n,correct\n12,-1\n", 3, ("input:2:2: correct",)),
                (("mafc", "--alternatives", "3"), "n,right\n12,1\n", 3, ("right",)),
                (("mafc", "--alternatives", "5"), "n,correct\n12,5\n", 2, ("--alternatives",)),
                (("mafc", "-"), "n,correct\n12,5\n", 2, ("--alternatives",)),
                (("abx",), "n,correct\n12,5\n", 2, ("--strategy", "--rates")),
                (("abx", "--strategy", "differencing", "--rates"), RATES + "12,5,12,3\n", 2, ("--strategy", "--rates")),
                (("abx", "--strategy", "guessing"), "n,correct\n12,5\n", 2, ("--strategy",)),
                (("abx", "--rates"), RATES + "12,13,12,3\n", 3, ("input:2:2: hits", "n_signal")),
                (("reminder", "--intervals", "1"), RATES + "12,3,12,13\n", 3, ("false_alarms", "n_noise")),
                (("reminder", "--intervals", "3"), RATES + "12,3,12,1\n", 2, ("--intervals",))):
            with self.subTest(arguments=arguments, text=text):
                self.refused(run(*arguments, text=text, code=code), *parts)


class Rates(program.Case):
    def test_abx(self):
        row, = lines("abx", "--rates", text="id," + RATES + "P01,48,38,48,12\n")
        self.assertEqual((row["id"], row["n_signal"], row["hits"], row["n_noise"], row["false_alarms"], row["status"]),
                         ("P01", 48, 38, 48, 12, "ok"))
        # R 4.2.2.
        for part, key, reference in (("raw", "z_difference", 1.4867075516959947), ("raw", "pc_unbiased", 0.7713662390152576),
                                     ("raw", "dprime_differencing", 2.158066138230442),
                                     ("raw", "dprime_independent", 1.9074689571056493),
                                     ("loglinear", "H", 0.7857142857142857), ("loglinear", "F", 0.25510204081632654),
                                     ("loglinear", "dprime_differencing", 2.121478497388611),
                                     ("loglinear", "dprime_independent", 1.876542632678937)):
            self.assertAlmostEqual(row[part][key], reference, delta=1e-8)
        low, high = row["dprime_differencing_ci"]
        self.assertLess(low, row["raw"]["dprime_differencing"])
        self.assertGreater(high, row["raw"]["dprime_differencing"])

    def test_reminder(self):
        one, = lines("reminder", "--intervals", "1", text=RATES + "40,30,40,9\n")
        self.assertAlmostEqual(one["raw"]["dprime_independent"], 1.4299047765565511, delta=1e-9)
        self.assertAlmostEqual(one["raw"]["dprime_differencing"], 2.022190727908345, delta=1e-9)
        self.assertAlmostEqual(one["loglinear"]["dprime_differencing"], 1.9638607991988486, delta=1e-9)
        self.assertNotIn("pc_unbiased", one["raw"])
        two, = lines("reminder", "--intervals", "2", text=RATES + "40,30,40,9\n")
        self.assertAlmostEqual(two["raw"]["dprime"], 1.4299047765565511 / math.sqrt(2), delta=1e-9)
        self.assertEqual(two["raw"]["dprime"], two["raw"]["dprime_independent"])

    def test_undefined(self):
        rows = lines("abx", "--rates", text=RATES + "12,12,12,0\n12,12,12,12\n0,0,12,3\n12,3,12,8\n")
        self.assertEqual([row["status"] for row in rows], ["ok", "no_information", "missing", "ok"])
        self.assertEqual((rows[0]["raw"]["z_difference"], rows[0]["raw"]["dprime_independent"]), ("inf", "inf"))
        self.assertEqual(rows[1]["raw"]["z_difference"], None)
        self.assertEqual(rows[1]["dprime_differencing_ci"], [0, "inf"])
        self.assertEqual(rows[2]["loglinear"]["dprime_differencing"], None)
        self.assertEqual(rows[3]["raw"]["dprime_differencing"], 0)

    def test_tables(self):
        self.says(run("abx", "--rates", text=RATES + "48,38,48,12\n").stdout, "ABX", "38/48", "12/48", "2.12", "1.88")
        self.assertIn("reminder, then both stimuli", run("reminder", "--intervals", "2", text=RATES + "48,38,48,12\n").stdout)


if __name__ == "__main__":
    program.main()
