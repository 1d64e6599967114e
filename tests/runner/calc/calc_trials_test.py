#!/usr/bin/env python3
"""`jnd calc ... --trials`: single trials from the table of any program, beside the same answers as counts."""
import csv
import io
import random
import re
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

COLUMNS = ("--trials", "--participant", "subj", "--condition", "cond", "--level", "stim", "--answer", "resp")


def table(rows, header="trial,subj,cond,stim,resp", separator=","):
    """Shuffled rows, each with its number and a column that nobody asks for."""
    rows = [separator.join(map(str, row)) for row in rows]
    random.Random(1).shuffle(rows)
    return header.replace(",", separator) + "\n" + "".join(f"{i}{separator}{row}\n" for i, row in enumerate(rows))


def trials(counts, yes, no):
    """counts: (subj, cond, stim, n, k)."""
    return [(subj, cond, stim, yes if i < k else no) for subj, cond, stim, n, k in counts for i in range(n)]


CHOICES = [("P01", "V", x, 20, k) for x, k in ((800, 3), (900, 9), (1000, 18))]
CHOICES += [("P02", "V", x, 20, k) for x, k in ((800, 1), (900, 12), (1000, 20))]
DIFFERENCES = [("P01", "S", 0, 40, 9), ("P01", "S", 200, 20, 11), ("P01", "S", 400, 20, 17)]

FIT = ("--function", "gaussian", "--guess", "0", "--lapse", "0")


class Trials(program.Case):
    def lines(self, command, *arguments, text):
        return self.jnd("calc", command, "-", *arguments, "--json", input=text).lines

    def refused(self, *words, text, arguments=(*COLUMNS, "--standard", "900"), command="which", code=3):
        super().refused(self.jnd("calc", command, "-", *arguments, input=text, code=code), *words)

    def same_numbers(self, ours, theirs, leave=()):
        for key, value in theirs.items():
            if key not in leave:
                self.assertEqual(ours[key], value, key)

    def test_which_as_from_counts(self):
        counts = "group,x,n,k\n" + "".join(f"{s},{x},{n},{k}\n" for s, _, x, n, k in CHOICES)
        theirs = {line["group"]: line for line in self.lines("which", "--standard", "900", text=counts)}
        for yes, no, more in (("1", "0", ()), ("comparison", "standard", ()), ("B", "A", ("--positive", "B"))):
            lines = self.lines("which", *COLUMNS, "--standard", "900", *more, text=table(trials(CHOICES, yes, no)))
            self.assertEqual(sorted(line["group"] for line in lines), ["P01 / V", "P02 / V"])
            for line in lines:
                self.assertEqual(line["condition"], "V")
                self.same_numbers(line, theirs[line["participant"]], leave=("group",))

    def test_trials_without_an_answer_are_left_out_and_counted(self):
        counted = trials(CHOICES, "1", "0")
        theirs = self.lines("which", *COLUMNS, "--standard", "900", text=table(counted))
        for missing in ("-1", "NA", ""):
            done = self.jnd("calc", "which", "-", *COLUMNS, "--standard", "900", "--no-answer", missing, "--json",
                            input=table(counted + [("P01", "V", "", missing)] * 7))
            self.assertEqual(sorted(done.lines, key=str), sorted(theirs, key=str))
            self.assertIn(f'7 of {len(counted) + 7} trials have no answer ("{missing}") and are left out', done.stderr)
        self.refused("the word for no answer is said with --no-answer", text=table(counted + [("P01", "V", 900, "-1")]))
        self.refused("no trial has an answer", text=table([("P01", "V", 900, "-1")]), arguments=(*COLUMNS, "--standard", "900", "--no-answer", "-1"))
        self.refused("--no-answer goes with --trials", text="x,n,k\n1,2,1\n", arguments=("--standard", "9", "--no-answer", "-1"), code=2)

    def test_a_standard_a_column(self):
        rows = [(subj, cond, stim, answer, standard, "x") for standard in (900, 1800)
                for subj, cond, stim, answer in trials(CHOICES[:3], 1, 0)]
        lines = self.lines("which", *COLUMNS, "--standard", "std",
                           text=table(rows, "trial,subj,cond,stim,resp,std,note"))
        self.assertEqual(sorted((line["group"], line["standard"]) for line in lines),
                         [("P01 / V / 1800", 1800), ("P01 / V / 900", 900)])
        self.assertAlmostEqual(lines[0]["weber_75"] * lines[0]["standard"], lines[1]["weber_75"] * lines[1]["standard"])

    def test_the_interval_that_was_chosen(self):
        by_order, by_word = [], []
        for subj, cond, stim, chosen in trials(CHOICES, True, False):
            order = 1 if (stim + len(by_order)) % 2 else -1
            by_word.append((subj, cond, stim, "yes" if chosen else "no", order))
            by_order.append((subj, cond, stim, "second" if chosen == (order == 1) else "first",
                             "second" if order == 1 else "first"))
        header = "trial,subj,cond,stim,resp,place"
        arguments = ("which", *COLUMNS, "--standard", "900", "--order", "place")
        self.assertEqual(sorted(map(str, self.lines(*arguments, text=table(by_order, header)))),
                         sorted(map(str, self.lines(*arguments, text=table(by_word, header)))))

    def test_fit_sdt_and_jnd_as_from_counts(self):
        text = "x,n,k\n" + "".join(f"{x},{n},{k}\n" for _, _, x, n, k in CHOICES[:3])
        theirs, = self.lines("fit", *FIT, text=text)
        ours, = self.lines("fit", *FIT, *COLUMNS, text=table(trials(CHOICES[:3], "yes", "no")))
        self.assertEqual(ours["group"], "P01 / V")
        self.same_numbers(ours, theirs, leave=("group",))

        answers = table(trials(DIFFERENCES, "different", "same"))
        theirs = self.lines("sdt", text="id,n_diff,hits,n_same,false_alarms\nP01 / S / 200,20,11,40,9\n"
                                        "P01 / S / 400,20,17,40,9\n")
        for one, other in zip(self.lines("sdt", *COLUMNS, text=answers), theirs):
            self.same_numbers(one, other)

        counts = ("participant,condition,delta,n_diff,hits,n_same,false_alarms\n"
                  "P01,S,200,20,11,{},{}\nP01,S,400,20,17,{},{}\n")
        ours, = self.lines("jnd", "--reference", "900", *COLUMNS, text=answers)
        each, = self.lines("jnd", "--reference", "900", text=counts.format(40, 9, 40, 9))
        once, = self.lines("jnd", "--reference", "900", text=counts.format(20, 4, 20, 5))
        for method in ("least_squares", "weighted", "inverse_mean_slope", "mean_of_ratios"):
            self.assertEqual(ours[method], each[method])
        for method in ("ml_yes_no_common", "ml_differencing_common"):
            self.assertAlmostEqual(ours[method]["jnd"], once[method]["jnd"], places=6)
            self.assertAlmostEqual(ours[method]["ci_high"], once[method]["ci_high"], places=4)
        self.assertEqual(ours["ml_yes_no_series"]["status"], "shared_same_trials")
        self.assertIsNone(ours["ml_yes_no_series"]["jnd"])

        few = [("P01", "S", x, 1, k) for x, k in ((0, 0), (0, 1), (100, 0), (200, 1), (300, 1))]  # 2 same, 3 differences
        ours, = self.lines("jnd", "--reference", "900", *COLUMNS, text=table(trials(few, "different", "same")))
        # The maximum by Newton's method, to a gradient of 1e-14; R's glm(binomial(probit)) ends 2e-6 before it.
        self.assertAlmostEqual(ours["ml_yes_no_common"]["jnd"], 146.8387051148563, places=9)

    def test_absolute_levels_are_differences_from_the_standard(self):
        rows = [(subj, cond, 900 + stim, answer) for subj, cond, stim, answer in
                trials(DIFFERENCES, "different", "same")]
        differences, = self.lines("jnd", "--reference", "900", *COLUMNS,
                                  text=table(trials(DIFFERENCES, "different", "same")))
        absolute, = self.lines("jnd", *COLUMNS, "--standard", "900", text=table(rows))
        self.assertEqual(absolute, differences)

    def exported(self, protocol, participants=2):
        """trials.csv of a simulated study, in a folder of the protocol's name."""
        self.jnd("simulate", protocol, "--participants", participants, "--seed", 1, "--study", f"{protocol}.sqlite")
        self.jnd("export", f"{protocol}.sqlite", "--to", protocol)
        return self.read(protocol, "trials.csv")

    def test_an_export_of_same_different_needs_no_names(self):
        text = self.exported("tutorial")
        rows = [row for row in csv.DictReader(io.StringIO(text)) if row["practice"] == "0"]
        self.assertLess(len(rows), len(text.splitlines()) - 1)  # there is practice, which does not count
        plain = table([(row["participant"], row["condition"], abs(float(row["stimulus_1_n_per_m"]) - float(row["stimulus_2_n_per_m"])), row["answer"])
                       for row in rows])
        for command, *more in (("sdt",), ("jnd", "--reference", "900"), ("fit", *FIT)):
            key = lambda line: str([line.get(name) for name in ("participant", "condition", "id")])
            ours = sorted(self.lines(command, *more, "--trials", text=text), key=key)
            theirs = sorted(self.lines(command, *more, *COLUMNS, "--positive", "different", text=plain), key=key)
            self.assertEqual(len(ours), len(theirs))
            for one, other in zip(ours, theirs):
                self.assertEqual(one, other)

    def test_an_export_of_which_has_more_gives_the_numbers_of_its_study(self):
        for protocol, same, *more in (("leib2015", {"pse": "pse", "jnd_75": "jnd"}), ("jones1997-viscosity", {"jnd_75": "jnd"}, "--pse-is-standard")):
            text = self.exported(protocol)
            lines = {(line["participant"], line["condition"], line["standard"]): line for line in self.lines("which", *more, "--trials", text=text)}
            estimates = self.rows(protocol, "estimates.csv")
            self.assertEqual(len(lines), len(estimates))
            for row in estimates:
                standard = float(next(row[name] for name in row if name.startswith("standard_")))
                line = lines[row["participant"], row["condition"], standard]
                for ours, theirs in same.items():
                    self.assertAlmostEqual(line[ours], float(row[theirs]), places=6)
                self.assertEqual(line["trials"], int(row["trials"]))

    def test_an_export_of_another_task_is_refused_and_says_what_takes_it(self):
        same_different = self.exported("tutorial", 1)
        which = self.exported("leib2015", 1)
        self.refused("an export of another task", "which and fit trials of", text=same_different, arguments=("--trials",))
        for command in ("sdt", "jnd"):
            self.refused("an export of another task", text=which, arguments=("--trials", "--reference", "85")[:1 if command == "sdt" else 3], command=command)
        self.assertTrue(self.lines("fit", *FIT, "--trials", text=which))
        self.refused("no trial that counts", text=re.sub(r"(?m)^(\w+,\w+,1,simulated,\w+,\d+,[^,]*,\d+,\d+),0,", r"\1,1,", same_different), arguments=("--trials",), command="sdt")
        sealed = "\n".join(",".join(cell for i, cell in enumerate(line.split(",")) if i not in (14, 15)) for line in same_different.splitlines()) + "\n"
        self.refused("an export without stimuli", text=sealed, arguments=("--trials",), command="sdt")
        self.refused("--trials needs --level and --answer", "has the columns trial, subj, cond, stim, resp", text=table(trials(CHOICES, 1, 0)),
                     arguments=("--trials",), code=2)

    def test_spreadsheets(self):
        rows = [(subj, cond, f"{stim / 1000}".replace(".", ","), answer) for subj, cond, stim, answer in
                trials(CHOICES, 1, 0)]
        lines = self.lines("which", *COLUMNS, "--standard", "0.9", text=table(rows, separator=";"))
        self.assertEqual(len(lines), 2)
        self.refused("between commas, numbers have a decimal point", text=table(rows))

    def test_mistakes(self):
        good = table(trials(CHOICES, 1, 0))
        self.refused('there is no column "stim" (did you mean "stym"?)', text=good.replace("stim", "stym"))
        self.refused('there is no column "resp" (its columns are trial, subj, cond, stim, zzzzz)',
                     text=good.replace("resp", "zzzzz"))
        self.refused('column "stim" is there 2 times', text=good.replace("cond", "stim", 1),
                     arguments=("--trials", "--level", "stim", "--answer", "resp", "--standard", "900"))
        self.refused("standard input:122:5: resp: ", '"maybe" is neither', "in every row",
                     text=good + "120,P02,V,1000,maybe\n")
        self.refused("standard input:122:5: resp: is empty", '--no-answer ""', text=good + "120,P02,V,1000,\n")
        self.refused("standard input:122:4: stim: ", text=good + "120,P02,V,soft,1\n")
        words = table(trials(CHOICES, "left", "right"))
        self.refused('which answer in column "resp" says that the comparison was chosen?', "--positive", text=words)
        self.refused('no answer in column "resp" is "up", which --positive names',
                     arguments=(*COLUMNS, "--standard", "900", "--positive", "up"), text=words)
        self.refused("write 1 or second where the comparison came second",
                     arguments=(*COLUMNS, "--standard", "900", "--order", "trial"), text=good)
        self.refused("--trials needs --level and --answer", arguments=("--trials", "--standard", "900"), text=good,
                     code=2)
        self.refused("--answer goes with --trials", arguments=("--answer", "resp"), command="sdt", text=good, code=2)
        self.refused("column stim is named for two things", text=good, code=2,
                     arguments=("--trials", "--level", "stim", "--answer", "stim", "--standard", "900"))
        self.refused("standard input: P01 / S: -100 is not a difference between two stimuli", command="jnd",
                     arguments=(*COLUMNS, "--reference", "900"),
                     text=table(trials([("P01", "S", -100, 9, 4), ("P01", "S", 0, 9, 4)], "different", "same")))
        self.refused("--reference is required", command="jnd", arguments=COLUMNS, code=2,
                     text=table(trials(DIFFERENCES, "different", "same")))


if __name__ == "__main__":
    program.main()
