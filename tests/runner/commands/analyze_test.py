#!/usr/bin/env python3
"""The analysis of a study from outside: tables, JSON, CSV, methods in words, refusals; adaptive studies too."""
import csv
import json
import os
import re
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program


class Analyze(program.Shared):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # In that of the staircases some tracks end before their reversals.
        for protocol, participants, seed in (("chinello2017", "4", "3"), ("adaptive-staircase", "3", "3"),
                                             ("adaptive-posterior", "3", "3"), ("adaptive-staircase-90", "3", "3")):
            short = program.short_protocol(protocol, cls.folder / f"{protocol}.json")
            cls.jnd("simulate", short, "--participants", participants, "--study", f"{protocol}.sqlite", "--seed", seed)

    def analysis(self, *arguments):
        return self.jnd("analyze", *arguments, "--json").json

    def test_every_number_names_what_it_rests_on(self):
        result = self.analysis("chinello2017.sqlite")
        for row in result["estimates"] + result["group"]:
            self.assertEqual((row["model"], row["correction"], row["method"]), ("yes-no", "loglinear", "least_squares"))
        registered = result["tests"][0]
        self.assertEqual((registered["outcome"], registered["registered"], registered["n"]), ("slope", True, 4))
        # The test is on the slopes that the participants' rows print.
        slopes = {c: [] for c in ("S", "V", "SV")}
        for row in result["estimates"]:
            slopes[row["condition"]].append(row["slope"])
        for row in result["conditions"][:3]:
            self.assertEqual(row["outcome"], "slope")
            self.assertAlmostEqual(row["mean"], sum(slopes[row["condition"]]) / 4, places=12)
        self.assertTrue(result["sensitivity"][0]["registered"])
        self.assertEqual({row["number"] for row in result["sensitivity"] if row["registered"]}, {1})
        self.assertEqual({row["condition"] for row in result["cues"]}, {"S", "V", "SV"})
        self.assertEqual(len(result["behaviour"]), 3 + 4)

    def test_p_values_of_behaviour_have_their_correction(self):
        rows = self.analysis("chinello2017.sqlite")["behaviour"]
        for part in ([row for row in rows if row["participant"] == "all"], [row for row in rows if row["participant"] != "all"]):
            self.assertGreater(len(part), 2)
            for path in (("order_effect",), ("response_bias",), ("drift", "dprime")):
                blocks = []
                for row in part:
                    block = row
                    for name in path:
                        block = block[name]
                    blocks.append(block)
                largest = 0
                for place, block in enumerate(sorted(blocks, key=lambda one: one["p"])):
                    largest = max(largest, min(1, (len(blocks) - place) * block["p"]))
                    self.assertAlmostEqual(block["p_holm"], largest, places=12)

    def test_tracks_without_a_threshold_are_a_caution(self):
        result = self.analysis("adaptive-staircase.sqlite")
        whole = {(row["participant"], row["condition"]) for row in result["tracks"] if row["track"] is None and row["status"] == "ok"}
        tracks = [row for row in result["tracks"] if row["track"] is not None]
        without = [row for row in tracks if row["status"] != "ok" and (row["participant"], row["condition"]) in whole]
        self.assertGreater(len(without), 0)  # of this seed
        said = [caution for caution in result["cautions"] if "tracks have no threshold" in caution]
        self.assertEqual(len(said), 1)
        self.assertTrue(said[0].startswith(f"{len(without)} of {len(tracks)} "), said)
        self.assertNotIn("tracks have no threshold", str(self.analysis("adaptive-posterior.sqlite")["cautions"]))

    def test_tracks_that_did_not_end_count_as_registered(self):
        for use in ("leave_out", "use"):
            protocol = json.loads((program.ROOT / "tests/protocols/corpus/good/task-across.json").read_text())
            protocol["design"]["procedure"].update(stop={"trials": 10}, averaged_reversals=6)
            protocol["analysis"]["unfinished_tracks"] = use
            file = self.write(f"across-{use}.json", json.dumps(protocol))
            self.jnd("simulate", file, "--participants", 4, "--study", f"{use}.sqlite", "--seed", 5)
            result = self.analysis(f"{use}.sqlite")
            people = result["estimates"]
            unfinished = sum(row["tracks_unfinished"] for row in people)
            said = [caution for caution in result["cautions"] if "did not end" in caution]
            self.assertEqual(len(said), 1)
            self.says(said[0], f"{unfinished} of 8 ", "fewer than 6 reversals",
                      "count with those that they have" if use == "use" else "are left out")
            self.assertTrue(0 < unfinished < 8)
            for row in people:
                self.assertEqual(row["tracks_used"], 2 if use == "use" else 2 - row["tracks_unfinished"])
                self.assertEqual(row["track_threshold"] is None, row["tracks_used"] == 0)

    def test_tests_of_estimates_with_a_prior_are_a_caution(self):
        said = [caution for caution in self.analysis("adaptive-posterior.sqlite")["cautions"] if "prior has more" in caution]
        self.assertEqual(len(said), 1)
        self.says(said[0], "of 9 (", "10 % of the weight", "hierarchical model")
        self.assertNotIn("prior has more", str(self.analysis("adaptive-staircase.sqlite")["cautions"]))

    def test_ranges_of_single_people_say_what_they_hold(self):
        self.says(self.jnd("analyze", "chinello2017.sqlite", "--participants").stdout.replace("\n  ", " "), "84 %", "88 %", "not of 95 %")
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "ranges")
        meaning = next(row["meaning"] for row in self.rows("ranges", "dictionary.csv") if row["column"] == "ln_jnd_sd")
        self.says(meaning, "84 to 88 %", "not of 95 %")

    def test_a_row_of_the_contrasts_is_on_one_scale(self):
        result = self.analysis("chinello2017.sqlite")
        rows = [row for row in result["contrasts"] if (row["a"], row["b"]) == ("S", "V")]
        self.assertEqual([(row["outcome"], row["unit"], row["registered"]) for row in rows],
                         [("slope", "per N/m", True), ("jnd", "N/m", False)])
        slopes = {c: {r["participant"]: r["slope"] for r in result["estimates"] if r["condition"] == c} for c in "SV"}
        mean = sum(slopes["S"][who] - slopes["V"][who] for who in slopes["S"]) / 4
        self.assertAlmostEqual(rows[0]["mean_difference"], mean, places=12)
        for row in rows:  # p belongs to the interval; that of the registered test has its correction
            self.assertEqual(row["p"] < 0.05, not row["ci_low"] < 0 < row["ci_high"])
            self.assertEqual(row["p_registered"] is not None, row["registered"])
        self.assertGreaterEqual(rows[0]["p_registered"], rows[0]["p"])
        self.jnd("export", "chinello2017.sqlite", "--to", "scales")
        table = self.rows("scales", "contrasts.csv")
        self.assertEqual([(r["outcome"], r["p_registered"] != "") for r in table], [("slope", True), ("jnd", False)] * 3)
        self.assertAlmostEqual(float(table[0]["mean_difference"]), mean, places=12)

    def test_it_opens_with_the_answer_and_shows_the_rest_on_request(self):
        before = sorted(os.listdir(self.folder))
        text = self.jnd("analyze", "chinello2017.sqlite").stdout
        self.assertEqual(sorted(os.listdir(self.folder)), before)  # nothing is written unasked
        self.assertLessEqual(max(len(line) for line in text.splitlines()), 80)
        self.says(text, "JND N/m by condition", "Registered contrasts: d' per 100 N/m", "registered contrast", "caution: ",
                  "More: --participants, --tests, --models")
        titles = {"--participants": "Participants", "--tests": "Pairs of conditions", "--models": "Every model",
                  "--behaviour": "How the answers were given", "--questions": "Answers to the questions", "--cells": "Cells"}
        for option in titles:
            shown = self.jnd("analyze", "chinello2017.sqlite", option).stdout
            self.assertEqual({title for title in titles.values() if f"\n{title}\n" in shown}, {titles[option]})
            self.assertTrue(shown.startswith(text[:text.index("More:")]))
        everything = self.jnd("analyze", "chinello2017.sqlite", "--all").stdout
        self.assertTrue(all(f"\n{title}\n" in everything for title in titles.values()))
        self.assertEqual(self.jnd("analyze", "chinello2017.sqlite", "--models", "all").stdout,
                         self.jnd("analyze", "chinello2017.sqlite", "--models").stdout)

    def on_terminal(self, rows, columns, *arguments, **environment):
        """What a terminal of this size shows of the command."""
        shown = program.Terminal(*arguments, rows=rows, columns=columns, folder=self.folder,
                                 env={"NO_COLOR": "1", "JND_PAGER": "cat", **environment})
        text = shown.ends().replace("\r\n", "\n")
        return re.sub(r"(\r[^\r\n]*\x1b\[K)+\n?", "", text)  # how long it works, which is said from a second on

    def test_on_a_terminal_tables_fit_and_long_output_is_paged(self):
        tests = ("analyze", "chinello2017.sqlite", "--tests")
        for columns, options in ((60, tests), (120, (*tests[:2], "--all"))):
            text = self.on_terminal(2000, columns, *options)
            self.assertIn("Pairs of conditions", text)
            self.assertEqual([line for line in text.splitlines()
                              if len(line) > columns and " " in line and "jnd report" not in line], [])
        whole = self.on_terminal(2000, 80, *tests)
        self.assertEqual(self.on_terminal(24, 80, *tests, JND_PAGER="cat > paged.txt"), "")
        self.assertEqual(self.read("paged.txt"), whole)
        self.assertEqual(self.on_terminal(24, 80, *tests, JND_PAGER="true"), "")  # left at once: no error
        os.mkfifo(self.folder / "no-program")  # which is found and cannot be started: exit code 126
        for pager in ("", "no-such-pager 2> /dev/null", "./no-program 2> /dev/null"):
            self.assertEqual(self.on_terminal(24, 80, *tests, JND_PAGER=pager), whole)

    def test_all_models_stand_beside_the_registered_one(self):
        result = self.analysis("chinello2017.sqlite", "--models")
        self.assertEqual(len(result["models"]), 4 * 3 * 11)
        self.assertEqual(len(result["model_cells"]), 4 * 9)
        for cell, registered in zip(result["model_cells"], result["cells"]):
            self.assertAlmostEqual(cell["raw"]["hit_rate"], cell["hits"] / cell["n_diff"], places=12)
            self.assertEqual(cell["yes_no"]["loglinear"]["dprime"], registered["dprime"])
        self.assertNotIn("models", self.analysis("chinello2017.sqlite"))

    def test_another_axis_is_a_deviation(self):
        self.assertEqual(self.analysis("chinello2017.sqlite")["deviations"], [])
        by = self.analysis("chinello2017.sqlite", "--by", "delivered")
        self.assertIn("over delivered ones", by["deviations"][0])

    def test_nothing_stays_behind_where_one_of_two_outputs_cannot_be_written(self):
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "alone", "--methods", "no-such-folder/m.md", code=5)
        self.assertFalse(os.path.exists(self.folder / "alone"))

    def test_results_as_csv_have_a_dictionary(self):
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", "--models")
        described = {(row["file"], row["column"]) for row in self.rows("out", "dictionary.csv")}
        for name in set(os.listdir(self.folder / "out")) - {"SHA256SUMS", "datapackage.json"}:
            for column in next(csv.reader(self.read("out", name).splitlines())):
                self.assertIn((name, column), described)
        self.assertIn("models.csv", os.listdir(self.folder / "out"))
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", code=5)
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", "--replace")

    def test_methods_in_words_never_replace_a_foreign_file(self):
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md")
        text = self.read("words.md")
        status = self.jnd("status", "chinello2017.sqlite", "--json").json
        self.says(text, status["protocol_sha256"], "Seed of the study: 3", "jnd 0.", *(s["head"] for s in status["sessions"]))
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md")  # its own file
        self.write("words.md", text + "my own paragraph\n")
        refused = self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md", code=5).stderr
        self.assertIn("was changed after jnd analyze had written it", refused)
        self.assertTrue(self.read("words.md").endswith("my own paragraph\n"))
        self.write("mine.md", "my notes\n")
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "mine.md", code=5)
        self.assertEqual(self.read("mine.md"), "my notes\n")

    def test_thresholds_that_the_answers_set(self):
        result = self.analysis("adaptive-staircase.sqlite")
        means = [row for row in result["group"] if row["outcome"] == "threshold"]
        self.assertEqual([row["condition"] for row in means], ["S", "V", "SV"])
        self.assertEqual(result["tests"][0]["outcome"], "threshold")
        self.jnd("export", "adaptive-staircase.sqlite", "--to", "adaptive")
        rows = self.rows("adaptive", "tracks.csv")
        self.assertEqual(len(rows), len(result["tracks"]))
        self.assertFalse(os.path.exists(self.folder / "adaptive/cells.csv"))  # there is no d' of a cell: nothing pretends to be one
        group = self.rows("adaptive", "group.csv")
        self.assertEqual([(row["condition"], int(row["participants"]), float(row["mean"])) for row in group if row["outcome"] == "threshold"],
                         [(row["condition"], row["participants"], row["mean"]) for row in means])

    def test_jnds_of_the_posterior_of_all_answers(self):
        for name, kind in (("adaptive-posterior", "posterior"), ("adaptive-staircase-90", "staircase")):
            study = f"{name}.sqlite"
            self.jnd("verify", study, "--deep")
            result = self.analysis(study)
            whole = [row for row in result["tracks"] if row["track"] is None]
            self.assertEqual(len(whole), 3 * 3)
            for row in whole:
                self.assertEqual(row["n"], row["trials"] + row["catch_trials"])
                if row["status"] == "ok":
                    self.assertLess(row["ci_low"], row["threshold"])
                    self.assertLess(row["threshold"], row["ci_high"])
            self.assertGreater(sum(row["status"] == "ok" for row in whole), 6)
            if kind == "posterior":
                self.assertEqual({level % 25 for row in result["tracks"] for level in row["levels"]}, {0})
            self.jnd("export", study, "--to", name)
            rows = self.rows(name, "tracks.csv")
            self.assertEqual(len(rows), len(result["tracks"]))
            self.assertIn("ci_low", rows[0])
            self.assertIn("Kontsevich" if kind == "posterior" else "by the response model", self.read(name, "methods.md"))
            self.assertNotIn("moves with the criterion", self.jnd("analyze", study).stdout)
            plan = self.jnd("plan", name, "--json").json["trials"]
            self.assertIn(None, [stimulus for trial in plan for stimulus in trial["stimuli"]])
            precision = self.jnd("plan", name, "--precision", "--jnd", "250", "--simulated", "30", "--json").json
            self.assertEqual([row["outcome"] for row in precision["precision"]], ["threshold", "weber"])
            self.assertTrue(120 < precision["precision"][0]["median"] < 500)

    def test_the_page_is_opened_on_request(self):
        opener = self.write("opener.sh", '#!/bin/sh\nbasename "$1" > opened.new && mv opened.new opened.txt\n')
        opener.chmod(0o755)
        for arguments, browser in ((("--to", "o.html", "--open"), opener), (("--to", "o.html", "--replace", "--open"), "/no/such")):
            done = self.jnd("report", "chinello2017.sqlite", *arguments, env={"BROWSER": str(browser)})
            self.assertEqual("no browser could be started" in done.stderr, browser == "/no/such")
        program.until((self.folder / "opened.txt").exists, "the browser")
        self.assertEqual(self.read("opened.txt"), "o.html\n")

    def test_the_page_is_written_once_and_whole(self):
        for study in ("chinello2017", "adaptive-staircase", "adaptive-posterior", "adaptive-staircase-90"):
            self.jnd("report", f"{study}.sqlite", "--to", f"{study}.html")
            page = self.read(f"{study}.html")
            self.assertIsNone(re.search(r"<script|https?://(?!doi\.org)[^\"]*\.(js|css)", page))
            self.assertIn("</html>", page)
            self.jnd("report", f"{study}.sqlite", "--to", f"{study}.html", code=5)


if __name__ == "__main__":
    program.main()
