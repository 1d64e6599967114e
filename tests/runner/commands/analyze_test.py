#!/usr/bin/env python3
"""The analysis of a study from outside: tables, JSON, CSV, methods in words, refusals; adaptive studies too.

Usage: analyze_test.py JND
"""
import csv
import fcntl
import json
import os
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

JND = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else None


class Analyze(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        # In that of the staircases some tracks end before their reversals.
        for protocol, participants, seed in (("chinello2017", "4", "3"), ("adaptive-staircase", "6", "2"),
                                             ("adaptive-posterior", "4", "3"), ("adaptive-staircase-90", "4", "3")):
            subprocess.run([JND, "simulate", protocol, "--participants", participants, "--study", f"{protocol}.sqlite",
                            "--seed", seed], cwd=cls.folder.name, check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def jnd(self, *arguments, code=0):
        done = subprocess.run([JND, *arguments], capture_output=True, text=True, cwd=self.folder.name)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout}{done.stderr}")
        return done

    def path(self, *names):
        return os.path.join(self.folder.name, *names)

    def analysis(self, *arguments):
        out = self.jnd("analyze", *arguments, "--json").stdout
        return json.loads(out, parse_constant=lambda name: self.fail(f"{arguments} print {name}"))

    def test_every_number_names_what_it_rests_on(self):
        result = self.analysis("chinello2017.sqlite")
        self.assertEqual((result["model"], result["correction"], result["jnd_method"]), ("yes-no", "loglinear", "least_squares"))
        registered = result["comparisons"][0]
        self.assertEqual((registered["outcome"], registered["registered"], registered["n"]), ("slope", True, 4))
        # The test is on the slopes that the participants' rows print.
        slopes = {c: [] for c in ("S", "V", "SV")}
        for row in result["participants"]:
            slopes[row["condition"]].append(row["slope"])
        for row in registered["comparison"]["descriptives"]:
            self.assertAlmostEqual(row["mean"], sum(slopes[row["condition"]]) / 4, places=12)
        self.assertTrue(result["sensitivity"][0]["registered"])
        self.assertEqual(sum(row["registered"] for row in result["sensitivity"]), 1)
        self.assertEqual({row["condition"] for row in result["cue_strategy"]}, {"S", "V", "SV"})
        self.assertEqual(len(result["behaviour"]), 3 + 4)

    def test_p_values_of_behaviour_have_their_correction(self):
        rows = self.analysis("chinello2017.sqlite")["behaviour"]
        for part in ([row for row in rows if row["participant"] is None], [row for row in rows if row["participant"]]):
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
                    self.assertAlmostEqual(block["holm"]["p"], largest, places=12)

    def test_tracks_without_a_threshold_are_a_caution(self):
        result = self.analysis("adaptive-staircase.sqlite")
        whole = {(row["participant"], row["condition"]) for row in result["rows"] if row["track"] is None and row["status"] == "ok"}
        tracks = [row for row in result["rows"] if row["track"] is not None]
        without = [row for row in tracks if row["status"] != "ok" and (row["participant"], row["condition"]) in whole]
        self.assertGreater(len(without), 0)  # of this seed
        said = [caution for caution in result["cautions"] if "tracks have no threshold" in caution]
        self.assertEqual(len(said), 1)
        self.assertTrue(said[0].startswith(f"{len(without)} of {len(tracks)} "), said)
        self.assertNotIn("tracks have no threshold", str(self.analysis("adaptive-posterior.sqlite")["cautions"]))

    def test_a_row_of_the_contrasts_is_on_one_scale(self):
        result = self.analysis("chinello2017.sqlite")
        rows = [row for row in result["contrasts"] if (row["a"], row["b"]) == ("S", "V")]
        self.assertEqual([(row["outcome"], row["unit"], row["registered"]) for row in rows],
                         [("slope", "per N/m", True), ("jnd", "N/m", False)])
        slopes = {c: {r["participant"]: r["slope"] for r in result["participants"] if r["condition"] == c} for c in "SV"}
        mean = sum(slopes["S"][who] - slopes["V"][who] for who in slopes["S"]) / 4
        self.assertAlmostEqual(rows[0]["difference"]["mean"], mean, places=12)
        self.assertIsNotNone(rows[0]["p"])
        self.assertIsNone(rows[1]["p"])
        self.jnd("export", "chinello2017.sqlite", "--to", "scales")
        with open(self.path("scales", "contrasts.csv"), newline="", encoding="utf-8") as file:
            table = list(csv.DictReader(file))
        self.assertEqual([(r["outcome"], r["p"] != "") for r in table], [("slope", True), ("jnd", False)] * 3)
        self.assertAlmostEqual(float(table[0]["difference_mean"]), mean, places=12)

    def test_it_opens_with_the_answer_and_shows_the_rest_on_request(self):
        before = sorted(os.listdir(self.folder.name))
        text = self.jnd("analyze", "chinello2017.sqlite").stdout
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)  # nothing is written unasked
        self.assertLessEqual(max(len(line) for line in text.splitlines()), 80)
        for part in ("JND by condition", "Registered contrasts: d' per 100 N/m", "registered contrast", "caution: ",
                     "More: --participants, --tests, --models"):
            self.assertIn(part, text)
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
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        done = subprocess.Popen([JND, *arguments], cwd=self.folder.name, stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
                                env={**os.environ, "NO_COLOR": "1", "JND_PAGER": "cat", **environment})
        os.close(theirs)
        text = b""
        while True:
            try:
                read = os.read(ours, 65536)
            except OSError:  # the end, on Linux
                break
            if not read:
                break
            text += read
        os.close(ours)
        self.assertEqual(done.wait(), 0)
        text = text.decode().replace("\r\n", "\n")
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
        with open(self.path("paged.txt"), encoding="utf-8") as file:
            self.assertEqual(file.read(), whole)
        self.assertEqual(self.on_terminal(24, 80, *tests, JND_PAGER="true"), "")  # left at once: no error
        os.mkfifo(self.path("no-program"))  # which is found and cannot be started: exit code 126
        for pager in ("", "no-such-pager 2> /dev/null", "./no-program 2> /dev/null"):
            self.assertEqual(self.on_terminal(24, 80, *tests, JND_PAGER=pager), whole)

    def test_all_models_stand_beside_the_registered_one(self):
        models = self.analysis("chinello2017.sqlite", "--models")["models"]
        self.assertEqual(len(models["thresholds"]), 4 * 3 * 11)
        self.assertEqual(len(models["cells"]), 4 * 9)
        for cell in models["cells"]:
            rates = cell["raw"]
            self.assertAlmostEqual(rates["hit_rate"], cell["hits"] / cell["n_diff"], places=12)
        self.assertNotIn("models", self.analysis("chinello2017.sqlite"))

    def test_another_axis_is_a_deviation(self):
        self.assertEqual(self.analysis("chinello2017.sqlite")["deviations"], [])
        by = self.analysis("chinello2017.sqlite", "--by", "delivered")
        self.assertIn("over delivered ones", by["deviations"][0])

    def test_nothing_stays_behind_where_one_of_two_outputs_cannot_be_written(self):
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "alone", "--methods", "no-such-folder/m.md", code=5)
        self.assertFalse(os.path.exists(self.path("alone")))

    def test_results_as_csv_have_a_dictionary(self):
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", "--models")
        with open(self.path("out", "dictionary.csv"), newline="", encoding="utf-8") as file:
            described = {(row["file"], row["column"]) for row in csv.DictReader(file)}
        for name in set(os.listdir(self.path("out"))) - {"SHA256SUMS", "datapackage.json"}:
            with open(self.path("out", name), newline="", encoding="utf-8") as file:
                for column in csv.DictReader(file).fieldnames:
                    self.assertIn((name, column), described)
        self.assertIn("models.csv", os.listdir(self.path("out")))
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", code=5)
        self.jnd("analyze", "chinello2017.sqlite", "--csv", "out", "--replace")

    def test_methods_in_words_never_replace_a_foreign_file(self):
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md")
        with open(self.path("words.md"), encoding="utf-8") as file:
            text = file.read()
        status = json.loads(self.jnd("status", "chinello2017.sqlite", "--json").stdout)
        for part in [status["protocol_sha256"], "Seed of the study: 3", "jnd 0."] + [s["head"] for s in status["sessions"]]:
            self.assertIn(part, text)
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md")  # its own file
        with open(self.path("words.md"), "a", encoding="utf-8") as file:
            file.write("my own paragraph\n")
        refused = self.jnd("analyze", "chinello2017.sqlite", "--methods", "words.md", code=5).stderr
        self.assertIn("was changed after jnd analyze had written it", refused)
        with open(self.path("words.md"), encoding="utf-8") as file:
            self.assertTrue(file.read().endswith("my own paragraph\n"))
        with open(self.path("mine.md"), "w", encoding="utf-8") as file:
            file.write("my notes\n")
        self.jnd("analyze", "chinello2017.sqlite", "--methods", "mine.md", code=5)
        with open(self.path("mine.md"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "my notes\n")

    def test_thresholds_that_the_answers_set(self):
        result = self.analysis("adaptive-staircase.sqlite")
        self.assertEqual([row["condition"] for row in result["group"]], ["S", "V", "SV"])
        self.assertEqual(result["comparisons"][0]["outcome"], "threshold")
        self.jnd("export", "adaptive-staircase.sqlite", "--to", "adaptive")
        with open(self.path("adaptive", "tracks.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), sum(1 for _ in result["rows"]))
        for name in ("thresholds.csv", "cells.csv"):  # there is no d' of a cell: nothing pretends to be one
            self.assertFalse(os.path.exists(self.path("adaptive", name)))
        with open(self.path("adaptive", "group.csv"), newline="", encoding="utf-8") as file:
            group = list(csv.DictReader(file))
        self.assertEqual([(row["condition"], int(row["participants"]), float(row["threshold_mean"])) for row in group],
                         [(row["condition"], row["of"], row["threshold_mean"]) for row in result["group"]])

    def test_jnds_of_the_posterior_of_all_answers(self):
        for name, kind in (("adaptive-posterior", "posterior"), ("adaptive-staircase-90", "staircase")):
            study = f"{name}.sqlite"
            self.jnd("verify", study, "--deep")
            result = self.analysis(study)
            self.assertEqual(result["procedure"]["kind"], kind)
            whole = [row for row in result["rows"] if row["track"] is None]
            self.assertEqual(len(whole), 4 * 3)
            for row in whole:
                self.assertEqual(row["n"], row["trials"] + row["catch_trials"])
                if row["status"] == "ok":
                    self.assertLess(row["ci_low"], row["threshold"])
                    self.assertLess(row["threshold"], row["ci_high"])
            self.assertGreater(sum(row["status"] == "ok" for row in whole), 8)
            if kind == "posterior":
                self.assertEqual({level % 25 for row in result["rows"] for level in row.get("levels", [])}, {0})
            self.jnd("export", study, "--to", name)
            with open(self.path(name, "tracks.csv"), newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), len(result["rows"]))
            self.assertIn("ci95_low", rows[0])
            with open(self.path(name, "methods.md"), encoding="utf-8") as file:
                self.assertIn("Kontsevich" if kind == "posterior" else "by the response model", file.read())
            self.assertNotIn("moves with the criterion", self.jnd("analyze", study).stdout)
            plan = json.loads(self.jnd("plan", name, "--json").stdout)["trials"]
            self.assertIn(None, [stimulus for trial in plan for stimulus in trial["stimuli"]])
            precision = json.loads(self.jnd("plan", name, "--precision", "--jnd", "250", "--simulated", "30", "--json").stdout)
            self.assertEqual([row["outcome"] for row in precision["precision"]], ["threshold", "weber"])
            self.assertTrue(120 < precision["precision"][0]["median"] < 500)

    def test_the_page_is_opened_on_request(self):
        opener = self.path("opener.sh")
        with open(opener, "w", encoding="utf-8") as file:
            file.write('#!/bin/sh\nbasename "$1" > opened.new && mv opened.new opened.txt\n')
        os.chmod(opener, 0o755)
        for arguments, browser in ((("--to", "o.html", "--open"), opener), (("--to", "o.html", "--replace", "--open"), "/no/such")):
            done = subprocess.run([JND, "report", "chinello2017.sqlite", *arguments], capture_output=True, text=True,
                                  cwd=self.folder.name, env={**os.environ, "BROWSER": browser})
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("no browser could be started" in done.stderr, browser == "/no/such")
        for _ in range(200):
            if os.path.exists(self.path("opened.txt")):
                break
            time.sleep(0.05)
        with open(self.path("opened.txt"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "o.html\n")

    def test_the_page_is_written_once_and_whole(self):
        for study in ("chinello2017", "adaptive-staircase", "adaptive-posterior", "adaptive-staircase-90"):
            self.jnd("report", f"{study}.sqlite", "--to", f"{study}.html")
            with open(self.path(f"{study}.html"), encoding="utf-8") as file:
                page = file.read()
            self.assertIsNone(re.search(r"<script|https?://(?!doi\.org)[^\"]*\.(js|css)", page))
            self.assertIn("</html>", page)
            self.jnd("report", f"{study}.sqlite", "--to", f"{study}.html", code=5)


if __name__ == "__main__":
    unittest.main()
