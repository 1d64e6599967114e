#!/usr/bin/env python3
"""jnd plan --power and jnd combine: what a user meets. Shards are killed at any moment, and add up to the same bytes.

Usage: power_test.py JND"""
import csv
import json
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.dom.minidom

JND = None


def jnd(*arguments, code=0):
    done = subprocess.run([JND, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == code, (arguments, done.returncode, done.stdout[-2000:], done.stderr[-2000:])
    return done


def power(*arguments, code=0):
    return jnd("plan", "chinello2017", "--power", *arguments, code=code)


class PowerTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def test_tables_and_files(self):
        options = ["--studies", 12, "--participants", "6,9", "--trials", "12,24", "--effect", "0,1"]
        csv_file, ademp = self.path / "power.csv", self.path / "ademp.md"
        figure = self.path / "power.svg"
        text = power(*options, "--csv", csv_file, "--ademp", ademp, "--figure", figure).stdout
        for words in ("Power at 0.05", "of effect 0 the rate of false findings", "V - SV", "1.683", "hierarchical",
                      "The smallest of these designs with a power of 80 %", "common random numbers"):
            self.assertIn(words, text)
        with open(csv_file, encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        designs = {(row["participants"], row["trials"], row["effect"]) for row in rows}
        self.assertEqual(len(designs), 8)
        document = json.loads(power(*options, "--json").stdout)
        self.assertEqual(document["studies"], 12)
        self.assertEqual(len(document["contrasts"]), 8 * 3 * 2)
        told = {(r["participants"], r["trials"], r["effect"], r["analysis"], r["contrast"]): r["power"]["value"]
                for r in document["contrasts"]}
        for row in rows:
            if row["number"] == "power":
                key = (int(row["participants"]), int(row["trials"]), float(row["effect"]), row["analysis"], row["name"])
                self.assertEqual(float(row["value"]), told[key])
        # A mark for every power, each with its words.
        drawn = xml.dom.minidom.parse(str(figure))
        marks = [title.firstChild.data for title in drawn.getElementsByTagName("title") if "participants" in title.firstChild.data]
        self.assertEqual(len(marks), 8 * 3 * 2)
        # A row of every number, and none that is not a number.
        self.assertNotIn("nan", csv_file.read_text(encoding="utf-8").lower())
        for part in ("Aims", "Data-generating mechanisms", "Estimands", "Methods", "Performance measures"):
            self.assertIn(f"**{part}**", ademp.read_text(encoding="utf-8"))
        # What is there is not written over, and that is said before the work begins.
        before = csv_file.read_bytes()
        self.assertIn("is there already", power("--studies", 100000000, "--csv", csv_file, code=3).stderr)
        self.assertEqual(csv_file.read_bytes(), before)

    def test_shares_that_are_killed(self):
        """A shard killed at random moments, until it is there; the result is that of one run without shards."""
        options = ["--studies", 60, "--participants", 6, "--effect", 1, "--threads", 1]
        whole = power(*options).stdout
        files = []
        generator = random.Random(4)
        for shard in range(1, 4):
            files.append(self.path / f"{shard}.json")
            kills = 0
            while not files[-1].exists():
                run = subprocess.Popen([JND, "plan", "chinello2017", "--power", *map(str, options), "--shard", f"{shard}/3",
                                        "--to", str(files[-1])], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                if kills < 4:
                    time.sleep(generator.uniform(0.0, 0.12))
                    run.send_signal(signal.SIGKILL)
                    kills += 1
                run.wait()
        self.assertEqual(jnd("combine", *reversed(files)).stdout, whole)
        left = {file.name for file in self.path.iterdir() if not file.name.endswith(".json")}
        self.assertFalse({name for name in left if name.endswith(".part")}, left)
        self.assertIn("it was there already", power(*options, "--shard", "2/3", "--to", files[1]).stdout)
        missing = jnd("combine", files[0], files[2], code=3)
        self.assertEqual(missing.stdout, "")
        self.assertIn("shard 2 of 3 is missing", missing.stderr)

    def test_many_studies(self):
        """The same study many times: tables, and shards that are killed and come to the same files."""
        options = ["tutorial", "--participants", 2, "--studies", 4, "--threads", 1]
        text = jnd("simulate", *options, "--csv", self.path / "whole").stdout
        self.assertIn("4 studies of 2 participants", text)
        with open(self.path / "whole" / "thresholds.csv", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([row["study"] for row in rows], sorted(row["study"] for row in rows))
        seeds = {row["study"]: row["seed"] for row in rows}
        self.assertEqual(len(set(seeds.values())), 4)
        # One of them again.
        jnd("simulate", "tutorial", "--participants", 2, "--seed", seeds["3"], "--study", self.path / "third.sqlite")
        jnd("analyze", self.path / "third.sqlite", "--csv", self.path / "third")
        with open(self.path / "third" / "thresholds.csv", encoding="utf-8") as stream:
            again = list(csv.DictReader(stream))
        self.assertEqual([dict(row, study="3", seed=seeds["3"]) for row in again], [row for row in rows if row["study"] == "3"])
        files = []
        for shard in range(1, 4):
            files.append(self.path / f"{shard}.json")
            for kill in (True, False):
                run = subprocess.Popen([JND, "simulate", *map(str, options), "--shard", f"{shard}/3", "--to", str(files[-1])],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                if kill:
                    time.sleep(0.05)
                    run.send_signal(signal.SIGKILL)
                run.wait()
        jnd("combine", files[2], files[0], files[1], "--csv", self.path / "combined")
        self.assertEqual({file.name: file.read_bytes() for file in (self.path / "whole").iterdir()},
                         {file.name: file.read_bytes() for file in (self.path / "combined").iterdir()})
        self.assertIn("--csv FOLDER", jnd("combine", *files, code=2).stderr)
        self.assertIn("plan --power", jnd("combine", *files, "--json", code=2).stderr)
        self.assertIn("is missing", jnd("combine", *files[1:], "--csv", self.path / "none", code=3).stderr)
        self.assertFalse((self.path / "none").exists())

    def test_many_studies_refused_or_interrupted(self):
        for arguments in (["--studies", 2], ["--studies", 2, "--no-study", "--csv", self.path / "x"], ["--csv", self.path / "x"],
                          ["--studies", 2, "--csv", self.path / "x", "--to", self.path / "y"], ["--studies", 0, "--csv", "x"],
                          ["--studies", 2, "--shard", "1/2"], ["--studies", 2, "--shard", "3/2", "--to", self.path / "y"]):
            self.assertIn("jnd", jnd("simulate", "tutorial", *arguments, code=2).stderr)
        self.interrupted("simulate", "tutorial", "--studies", "100000", "--csv", self.path / "x")
        self.assertEqual(list(self.path.iterdir()), [])

    def test_interrupted(self):
        file = self.path / "shard.json"
        self.interrupted("plan", "chinello2017", "--power", "--studies", "100000", "--to", file)
        self.assertFalse(file.exists())

    def interrupted(self, *arguments):
        """Ctrl-C half a second after the program heeds it, which a loaded machine may take long for."""
        run = subprocess.Popen([JND, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        status = pathlib.Path(f"/proc/{run.pid}/status")
        while not int(re.search(r"SigCgt:\s*(\w+)", status.read_text(encoding="ascii"))[1], 16) >> (signal.SIGINT - 1) & 1:
            self.assertIsNone(run.poll(), arguments)
            time.sleep(0.01)
        time.sleep(0.5)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130, arguments)

    def test_refusals(self):
        for arguments, words in (
                (["--shard", "1/2"], "--to"),
                (["--shard", "3/2", "--to", self.path / "x"], "K/N"),
                (["--shard", "0/2", "--to", self.path / "x"], "K/N"),
                (["--shard", "1", "--to", self.path / "x"], "K/N"),
                (["--trials", "0"], "--trials"),
                (["--jnd", "250"], "nothing to find"),
                (["--profile", "chinello2017"], "--physics"),
                (["--physics", "--effect", "1"], "do not go with it"),
                (["--group-factor", "patients=2"], "no groups"),
                (["--precision"], "--precision"),
                (["--analysis", "anova"], "--analysis")):
            done = subprocess.run([JND, "plan", "chinello2017", "--power", "--studies", "2", *map(str, arguments)],
                                  capture_output=True, text=True, check=False)
            self.assertNotIn(done.returncode, (0, 1), arguments)
            self.assertIn(words, done.stderr)
            self.assertEqual(done.stdout, "")
        for protocol, words in (("carpenter2018-oddity", '"oddity"'), ("jones1997-viscosity", "one condition"),
                                ("adaptive-staircase", "--trials")):
            done = jnd("plan", protocol, "--power", "--trials", 8, code=2)
            self.assertIn(words, done.stderr)
        self.assertIn("--precision or --power", jnd("plan", "chinello2017", "--participants", "12", code=2).stderr)
        self.assertIn("several designs", jnd("plan", "chinello2017", "--precision", "--participants", "12,18", code=2).stderr)

    def test_through_the_rig(self):
        """Two studies through the model of the device: what the counts say is what jnd simulate counts."""
        document = json.loads(power("--physics", "--participants", 3, "--studies", 2, "--json").stdout)
        self.assertEqual(document["question"]["profile"], "chinello2017")
        for row in document["contrasts"]:
            self.assertIsNone(row["true_ratio"])
            self.assertIsNone(row["coverage"]["value"])
            self.assertIsNotNone(row["mean"]["value"])

    def test_procedures_and_choices_through_the_rig(self):
        for protocol in ("adaptive-staircase", "maereg2017"):
            arguments = ["plan", protocol, "--power", "--physics", "--participants", 2, "--studies", 1, "--analysis", "registered"]
            document = json.loads(jnd(*arguments, "--json").stdout)
            self.assertEqual(len(document["contrasts"]), 3)
            self.assertIsNotNone(document["question"]["profile"])

    def test_choices_and_procedures(self):
        done = jnd("plan", "leib2015", "--power", "--jnd", "none=33", "--jnd", "delay=50", "--studies", 4, "--effect", 1,
                   "--participants", 6)
        self.assertIn("choices, probit", done.stdout)
        self.assertIn("registered is left out", done.stderr)
        staircase = jnd("plan", "adaptive-staircase", "--power", "--studies", 2, "--participants", 4).stdout
        self.assertIn("threshold", staircase)


if __name__ == "__main__":
    JND = sys.argv.pop(1)
    unittest.main()
