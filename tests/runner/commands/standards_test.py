#!/usr/bin/env python3
"""Studies of several standards from outside: conditions that are compared at one of them or by the mean over all, published values of one, and
questions that are asked after each; held against what is computed here from the exported estimates and answers."""
import json
import math
import sys
from statistics import mean, median, stdev

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

# By study: what is registered, and how the titles of the compared outcome begin and end.
STUDIES = {"mean": ({}, "", ", mean over 4 standards"), "one": ({"standard": "k1000"}, "", " at k1000"),
           "log": ({"standard": "k1000", "tests": {"on": "logarithm"}}, "logarithm of the ", " at k1000")}
CONTRASTS = [("tool", "arms"), ("glove", "tool")]
PUBLISHED = [{"condition": "arms", "quantity": "weber", "value": 0.23},
             {"condition": "arms", "standard": "k2000", "quantity": "weber", "value": 0.125, "ci95_half_width": 0.0625},
             {"condition": "tool", "standard": "k500", "quantity": "jnd", "value": 61}]
BY_HAND = ("--kind", "pilot", "--rig", "specimens", "--plain", "--override-readiness", "a machine that runs tests")


def shipped(name, **changes):
    return json.loads((program.ROOT / f"protocols/studies/{name}.json").read_text()) | {"assumed": [], "published": []} | changes


class Standards(program.Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, (analysis, *_) in STUDIES.items():
            cls.jnd("simulate", cls.protocol(**analysis), "--participants", 5, "--study", f"{name}.sqlite", "--seed", 3)
            cls.jnd("export", f"{name}.sqlite", "--to", name)

    @classmethod
    def protocol(cls, *published, **analysis):
        return cls.write("protocol.json", shipped(
            "jones-hunter1990", published=PUBLISHED + [*published], analysis={"outcome": "weber", "contrasts": CONTRASTS, **analysis},
            conditions=[{"name": name, "label": name, "parameters": {"by": name}} for name in ("arms", "tool", "glove")]))

    def table(self, *names, key):
        return {tuple(row[name] for name in key.split()): row for row in self.rows(*names)}

    def near(self, row, **expected):
        for name, value in expected.items():
            self.assertAlmostEqual(float(row[name]), value, delta=1e-9 * max(1, abs(value)), msg=f"{name} of {row}")

    def test_conditions_are_compared_at_the_registered_standard(self):
        first = set()
        for study, (_, begin, end) in STUDIES.items():
            with self.subTest(study):
                name, scale, title = "ln_weber" if begin else "weber", math.log if begin else float, f"{begin}Weber fraction{end}"
                estimates = self.table(study, "estimates.csv", key="participant condition standard")
                people, conditions, standards = (list(dict.fromkeys(one)) for one in zip(*estimates))
                self.assertEqual((len(people), len(conditions), len(standards), len(estimates)), (5, 3, 4, 60))
                weber, jnd = ({c: [mean(to(float(estimates[who, c, one][outcome])) for one in (standards if study == "mean" else ["k1000"]))
                                   for who in people] for c in conditions} for outcome, to in (("weber", scale), ("jnd", float)))
                first.add(weber["arms"][0])
                values, summary, test, contrasts = (self.table(study, f"{file}.csv", key=key) for file, key in (
                    ("values", "outcome participant condition"), ("conditions", "outcome condition"), ("tests", "outcome"),
                    ("contrasts", "a b registered")))
                centre, between, error = mean(map(mean, weber.values())), 0, 0
                for c, own in weber.items():
                    self.near(summary[name, c], mean=mean(own), sd=stdev(own), median=median(own), n=5)
                    between += 5 * (mean(own) - centre) ** 2
                    for who, value, all_own in zip(people, own, zip(*weber.values())):
                        self.near(values[name, who, c], value=value, tested=1)
                        error += (value - mean(own) - mean(all_own) + centre) ** 2
                self.near(test[name,], anova_f=(between / 2) / (error / 8), n=5)
                p = {}
                for a, b in CONTRASTS:
                    for registered, of in (("0", jnd), ("1", weber)):
                        d = [x - y for x, y in zip(of[a], of[b])]
                        t = abs(mean(d)) / stdev(d) * math.sqrt(5)
                        x = t / math.sqrt(1 + t * t / 4)
                        p[a, b] = 1 - 0.75 * x * (1 - x * x / 12)  # of Student's t with 4 degrees of freedom
                        self.near(contrasts[a, b, registered], mean_difference=mean(d), sd=stdev(d), n=5, p=p[a, b])
                    self.assertEqual([contrasts[a, b, one]["title"] for one in "10"], [title, "JND" + end])
                low, high = sorted(p, key=p.get)
                self.near(contrasts[(*low, "1")], p_registered=min(1, 2 * p[low]))
                self.near(contrasts[(*high, "1")], p_registered=min(1, max(p[high], 2 * p[low])))
                said = self.jnd("analyze", f"{study}.sqlite", "--json").json
                for block in ("contrasts", "conditions", "tests"):
                    self.assertEqual({row["title"] for row in said[block] if row["outcome"] == name}, {title}, block)
                self.assertEqual([row["value"] for row in said["values"]], [float(row["value"]) for row in values.values()])
                self.says(self.read(study, "methods.md"), title)
                self.jnd(self.folder / study / "recompute.py", program=sys.executable)
                self.says(" ".join(self.jnd("analyze", f"{study}.sqlite").stdout.split()), f"Registered contrasts: {title}")
        self.assertEqual(len(first), 3)  # else nothing was told apart

    def test_a_published_value_of_a_standard_stands_beside_its_row_alone(self):
        group = self.table("one", "group.csv", key="condition standard outcome")
        self.assertEqual({key: (row["published"], row["published_half_width"]) for key, row in group.items() if row["published"]},
                         {("arms", "k2000", "weber"): ("0.125", "0.0625"), ("tool", "k500", "jnd"): ("61", ""),
                          **{("arms", one, "weber"): ("0.23", "") for one in ("k500", "k1000", "k4000")}})  # of all others
        self.jnd("check", self.protocol(PUBLISHED[2] | {"standard": "k1000"}))
        self.refused(self.jnd("simulate", self.protocol(PUBLISHED[2]), "--no-study", code=3), '$.published[3]: the jnd of "tool" is given twice')

    def test_a_standard_that_is_none_is_refused_in_one_message(self):
        for path, protocol in (("$.analysis.standard", lambda: self.protocol(standard="k700")),
                               ("$.published[3].standard", lambda: self.protocol(PUBLISHED[1] | {"standard": "k700"}))):
            done = self.jnd("simulate", protocol(), "--participants", 1, "--study", "none.sqlite", code=3)
            self.refused(done, f'{path}: "k700" is not known', '"k500", "k1000", "k2000" or "k4000"')
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertFalse((self.folder / "none.sqlite").exists())

    def test_a_question_after_each_series_has_a_row_for_each(self):
        asked = {"when": "after-series", "text": "How?", "min": 1, "max": 9}
        protocol = shipped("bergmann-tiest2009", instructions=[], blinding="open", levels={"absolute": [1200]},
                           standards=[{"name": "s800", "value": 800}, {"name": "s950", "value": 950}],
                           questions=[asked | {"id": "effort", "kind": "rating", "low": "none", "high": "much"},
                                      asked | {"id": "count", "kind": "number", "required": False}],
                           published=[{"condition": "hand", "standard": "s950", "quantity": "rating", "question": "effort", "value": 5.5}])
        protocol["trial"].update(explore_s=0.5, gap_s=0, between_trials_s=0, cues={name: {"kind": "none"} for name in protocol["trial"]["cues"]})
        protocol["design"].update(trials_per_cell=1, sampling="random", order={"series": "permuted", "conditions": "fixed"})
        # After each of two trials a rating and, but for one, a number: a simulated participant would give the same ones again.
        for who, keys in (("P01", ("2\n3\n", "9\n8\n")), ("P02", ("1\n4\n", "6\n\n")), ("P03", ("7\n2\n", "3\n9\n"))):
            self.jnd("run", self.write("hand.json", protocol), "--study", "hand.sqlite", "--participant", who, "--seed", 4, *BY_HAND,
                     input="".join("   1" + one for one in keys))
        self.jnd("export", "hand.sqlite", "--to", "hand", "--kind", "pilot")
        series, given = {}, {}
        for row in self.rows("hand", "trials.csv"):
            series.setdefault(row["participant"], []).append(row["series"])
        self.assertEqual({tuple(own) for own in series.values()}, {("s800", "s950"), ("s950", "s800")})
        for row in self.rows("hand", "answers.csv"):
            if row["answered"] == "1":
                given.setdefault((row["question"], series[row["participant"]][int(row["after_trial"]) - 1]), []).append(float(row["answer"]))
        self.assertEqual(sorted(map(len, given.values())), [2, 3, 3, 3])
        for found in self.rows("hand", "items.csv"), self.jnd("analyze", "hand.sqlite", "--kind", "pilot", "--json").json["items"]:
            self.assertEqual([(row["item"], row["series"]) for row in found], [(q, one) for q in ("effort", "count") for one in ("s800", "s950")])
            self.assertEqual([row["published"] for row in found if row["published"]], [found[1]["published"]])
            self.assertEqual(float(found[1]["published"]), 5.5)
            for row in found:
                own = given[row["item"], row["series"]]
                self.near(row, n=len(own), mean=mean(own), sd=stdev(own), median=median(own))


if __name__ == "__main__":
    program.main()
