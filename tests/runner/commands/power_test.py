#!/usr/bin/env python3
"""jnd plan --power and jnd combine: what a user meets. Shards are killed at any moment, and add up to the same bytes."""
import os
import pathlib
import random
import signal
import sys
import xml.dom.minidom

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

jnd = program.run


def power(*arguments, code=0):
    return jnd("plan", "chinello2017", "--power", *arguments, code=code)


class PowerTest(program.Case):
    def test_tables_and_files(self):
        options = ["--studies", 12, "--participants", "6,9", "--trials", "12,24", "--effect", "0,1"]
        csv_file, ademp = self.folder / "power.csv", self.folder / "ademp.md"
        figure = self.folder / "power.svg"
        text = power(*options, "--csv", csv_file, "--ademp", ademp, "--figure", figure).stdout
        self.says(text, "Power at 0.05", "of effect 0 the rate of false findings", "V - SV", "1.683", "hierarchical",
                  "The smallest of these designs with a power of 80 %", "common random numbers")
        rows = self.rows("power.csv")
        designs = {(row["participants"], row["trials"], row["effect"]) for row in rows}
        self.assertEqual(len(designs), 8)
        document = power(*options, "--json").json
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

    def test_few_studies_claim_little(self):
        """All of 10 studies, or of 1, leave much open, and no design is picked for that."""
        for studies, low, words in ((10, 0.6915, "100.0 % (69.2 to 100.0)"), (1, 0.025, "100.0 % (2.5 to 100.0)")):
            options = ("--participants", 18, "--trials", 12, "--effect", 5, "--analysis", "hierarchical", "--studies", studies)
            document = power(*options, "--json").json
            shares = [row["power"] for row in document["contrasts"]]
            self.assertEqual({share["value"] for share in shares}, {1})
            self.assertEqual({share["mc_error"] for share in shares}, {None})
            self.assertEqual({round(share["ci95"][0], 4) for share in shares}, {low})
            self.assertEqual({row["design"] for row in map(dict, document["smallest"])}, {None})
            self.says(power(*options).stdout, words, "even at the low end of its interval")

    def test_shares_that_are_killed(self):
        """A shard killed at random moments, until it is there; the result is that of one run without shards."""
        options = ["--studies", 60, "--participants", 6, "--effect", 1, "--threads", 1]
        whole = power(*options).stdout
        files = []
        generator = random.Random(4)
        for shard in range(1, 4):
            files.append(self.folder / f"{shard}.json")
            kills = 0
            while not files[-1].exists():
                part = ("plan", "chinello2017", "--power", *options, "--shard", f"{shard}/3", "--to", files[-1])
                if kills < 4:
                    with program.start(*part) as running:
                        program.kill_within(running, generator.uniform(0.0, 0.12))
                    kills += 1
                else:
                    jnd(*part)
        self.assertEqual(jnd("combine", *reversed(files)).stdout, whole)
        left = {file.name for file in self.folder.iterdir() if not file.name.endswith(".json")}
        self.assertFalse({name for name in left if name.endswith(".part")}, left)
        self.assertIn("it was there already", power(*options, "--shard", "2/3", "--to", files[1]).stdout)
        missing = jnd("combine", files[0], files[2], code=3)
        self.assertEqual(missing.stdout, "")
        self.assertIn("shard 2 of 3 is missing", missing.stderr)

    def test_many_studies(self):
        """The same study many times: tables, and shards that are killed and come to the same files."""
        options = ["tutorial", "--participants", 2, "--studies", 4, "--threads", 1]
        text = jnd("simulate", *options, "--csv", self.folder / "whole").stdout
        self.assertIn("4 studies of 2 participants", text)
        rows = self.rows("whole", "estimates.csv")
        self.assertEqual([row["study"] for row in rows], sorted(row["study"] for row in rows))
        seeds = {row["study"]: row["seed"] for row in rows}
        self.assertEqual(len(set(seeds.values())), 4)
        # One of them again.
        jnd("simulate", "tutorial", "--participants", 2, "--seed", seeds["3"], "--study", self.folder / "third.sqlite")
        jnd("analyze", self.folder / "third.sqlite", "--csv", self.folder / "third")
        again = self.rows("third", "estimates.csv")
        self.assertEqual([dict(row, study="3", seed=seeds["3"]) for row in again], [row for row in rows if row["study"] == "3"])
        files = []
        for shard in range(1, 4):
            files.append(self.folder / f"{shard}.json")
            part = ("simulate", *options, "--shard", f"{shard}/3", "--to", files[-1])
            with program.start(*part) as running:
                program.kill_within(running, 0.05)
            jnd(*part)
        jnd("combine", files[2], files[0], files[1], "--csv", self.folder / "combined")
        self.assertEqual({file.name: file.read_bytes() for file in (self.folder / "whole").iterdir()},
                         {file.name: file.read_bytes() for file in (self.folder / "combined").iterdir()})
        self.assertIn("--csv FOLDER", jnd("combine", *files, code=2).stderr)
        self.assertIn("plan --power", jnd("combine", *files, "--json", code=2).stderr)
        self.assertIn("is missing", jnd("combine", *files[1:], "--csv", self.folder / "none", code=3).stderr)
        self.assertFalse((self.folder / "none").exists())

    def test_many_studies_refused_or_interrupted(self):
        for arguments in (["--studies", 2], ["--studies", 2, "--no-study", "--csv", self.folder / "x"], ["--csv", self.folder / "x"],
                          ["--studies", 2, "--csv", self.folder / "x", "--to", self.folder / "y"], ["--studies", 0, "--csv", "x"],
                          ["--studies", 2, "--shard", "1/2"], ["--studies", 2, "--shard", "3/2", "--to", self.folder / "y"]):
            self.assertIn("jnd", jnd("simulate", "tutorial", *arguments, code=2).stderr)
        self.interrupted("simulate", "tutorial", "--studies", "100000", "--csv", self.folder / "x")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_interrupted(self):
        file = self.folder / "shard.json"
        self.interrupted("plan", "chinello2017", "--power", "--studies", "100000", "--to", file)
        self.assertFalse(file.exists())

    def interrupted(self, *arguments):
        """Ctrl-C in the middle of the work: after a third of a second of processor time."""
        process = self.started(*arguments)
        program.until_it_handles(signal.SIGINT, process)
        stat = pathlib.Path(f"/proc/{process.pid}/stat")
        worked = lambda: sum(map(int, stat.read_text().rpartition(")")[2].split()[11:13])) / os.sysconf("SC_CLK_TCK")
        program.until(lambda: worked() > 0.3, "work", process)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=program.GUARD_S)
        self.assertEqual(process.returncode, 130, arguments)

    def test_refusals(self):
        for arguments, words in (
                (["--shard", "1/2"], "--to"),
                (["--shard", "3/2", "--to", self.folder / "x"], "K/N"),
                (["--shard", "0/2", "--to", self.folder / "x"], "K/N"),
                (["--shard", "1", "--to", self.folder / "x"], "K/N"),
                (["--trials", "0"], "--trials"),
                (["--jnd", "250"], "nothing to find"),
                (["--profile", "chinello2017"], "--physics"),
                (["--physics", "--effect", "1"], "do not go with it"),
                (["--group-factor", "patients=2"], "no groups"),
                (["--precision"], "--precision"),
                (["--analysis", "anova"], "--analysis")):
            done = power("--studies", 2, *arguments, code=None)
            self.assertNotIn(done.returncode, (0, 1), arguments)
            self.refused(done, words)
        for protocol, words in (("carpenter2018-oddity", '"oddity"'), ("jones1997-viscosity", "one condition"),
                                ("adaptive-staircase", "--trials")):
            done = jnd("plan", protocol, "--power", "--trials", 8, code=2)
            self.assertIn(words, done.stderr)
        self.assertIn("--precision or --power", jnd("plan", "chinello2017", "--participants", "12", code=2).stderr)
        self.assertIn("several designs", jnd("plan", "chinello2017", "--precision", "--participants", "12,18", code=2).stderr)

    def test_through_the_rig(self):
        """Two studies through the model of the device: what the counts say is what jnd simulate counts."""
        document = power("--physics", "--participants", 3, "--studies", 2, "--json").json
        self.assertEqual(document["question"]["profile"], "chinello2017")
        for row in document["contrasts"]:
            self.assertIsNone(row["true_ratio"])
            self.assertIsNone(row["coverage"]["value"])
            self.assertIsNotNone(row["mean"]["value"])

    def test_procedures_and_choices_through_the_rig(self):
        for protocol in ("adaptive-staircase", "maereg2017"):
            arguments = ["plan", protocol, "--power", "--physics", "--participants", 2, "--studies", 1, "--analysis", "registered"]
            document = jnd(*arguments, "--json").json
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
    program.main()
