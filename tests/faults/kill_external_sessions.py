#!/usr/bin/env python3
"""Kills sessions on an external rig with SIGKILL at random instants and runs the same command again, until they are complete.

After every kill: each answer that the program had acknowledged is in the study, `jnd verify` agrees, and the program of the rig is
gone with its session. At the end every trial is there once, with the planned stimuli, and was delivered by the rig.

Usage: kill_external_sessions.py JND [--kills N] [--seed N]        --kills 100 is the long form
"""
import argparse
import contextlib
import json
import os
import pathlib
import random
import re
import sqlite3
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
RIG = ROOT / "devices/external/examples/plain_rig.py"
SAVED = re.compile(r"saved: trial (\d+), (\w+)")
FINISHED_BEFORE = "has finished this study"
TRIALS = 4
LONGEST_S = 5  # of a session that is to be killed
RIG_ENDS_WITHIN_S = 10


def write_inputs(folder):
    """A small design of `which`, and a rig file whose command can be told from every other process."""
    protocol = json.loads((ROOT / "protocols/studies/maereg2017.json").read_text(encoding="utf-8"))
    for part in ("assumed", "instructions", "published", "notes"):
        protocol.pop(part, None)
    protocol["trial"].update(explore_s=0.5, gap_s=0, between_trials_s=0)
    for cue in protocol["trial"]["cues"].values():
        cue["kind"] = "none"
    protocol.update(levels={"absolute": [300, 500]},
                    conditions=[{"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}])
    protocol["design"].update(trials_per_cell=TRIALS // 2, order={"series": "fixed", "conditions": "fixed"})
    protocol["analysis"]["contrasts"] = []
    (folder / "which.json").write_text(json.dumps(protocol), encoding="utf-8")
    (folder / "rig.py").write_text(RIG.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "rig.json").write_text(json.dumps(
        {"format": 1, "title": "plain rig", "external": {"command": [sys.executable, str(folder / "rig.py")]}}), encoding="utf-8")


def running(text):
    """Processes whose command line has that text in it."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if entry.name.isdigit() and text.encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
    return found


class Campaign:
    def __init__(self, jnd, folder, seed):
        self.jnd, self.folder, self.generator = jnd, folder, random.Random(seed)
        self.kills = self.studies = self.acknowledged = self.voided = 0
        self.wrong = []

    def session(self, study, kill_after):
        """None where it was killed, else its exit code; with what it printed."""
        process = subprocess.Popen(
            [self.jnd, "run", "./which.json", "--study", study, "--participant", "P01", "--rig", "rig.json", "--plain", "--seed", "4",
             "--responder", "chinello2017", "--override-readiness", "a machine that runs tests"],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True)
        try:
            said, _ = process.communicate(timeout=kill_after)
            return process.returncode, said
        except subprocess.TimeoutExpired:
            process.kill()
            said, _ = process.communicate()
            return None, said

    def answers(self, study):
        """By their place in the session, which is what the screen names: a trial that was interrupted comes later."""
        if not (self.folder / study).exists():
            return {}
        with contextlib.closing(sqlite3.connect(self.folder / study)) as connection:
            bodies = [json.loads(body) for (body,) in connection.execute(
                "SELECT body FROM event WHERE kind = 'trial.completed' ORDER BY seq")]
        indices = [body["index"] for body in bodies]
        if len(set(indices)) < len(indices):
            self.wrong.append(f"{study}: a trial is there twice: {indices}")
        return {place: body["answer"] for place, body in enumerate(bodies, 1)}

    def look_at(self, study, acknowledged):
        answers = self.answers(study)
        for number, answer in acknowledged.items():
            if answers.get(number) != answer:
                self.wrong.append(f"{study}: answer {number}, {answer}, was acknowledged; the study has {answers.get(number)}")
        if (self.folder / study).exists():
            verify = subprocess.run([self.jnd, "verify", study, "--deep"], cwd=self.folder, capture_output=True, text=True)
            if verify.returncode != 0:
                self.wrong.append(f"{study}: {verify.stdout}{verify.stderr}")
        began = time.monotonic()
        while left := running(str(self.folder / "rig.py")):
            if time.monotonic() - began > RIG_ENDS_WITHIN_S:
                self.wrong.append(f"{study}: the rig's process {left} is still there")
                return
            time.sleep(0.02)

    def run(self, kills):
        while self.kills < kills and not self.wrong:
            self.studies += 1
            study, acknowledged = f"{self.studies}.sqlite", {}
            for _ in range(1000):
                code, said = self.session(study, self.generator.uniform(0.02, LONGEST_S) if self.kills < kills else None)
                acknowledged.update((int(number), answer) for number, answer in SAVED.findall(said))
                self.kills += code is None
                self.look_at(study, acknowledged)
                if code == 0 or FINISHED_BEFORE in said or self.wrong:
                    break
                # On a busy machine the rig may be silent for too long, until no attempt is left: the next run goes on.
                if code is not None and "silent" not in said:
                    self.wrong.append(f"{study}: ended with {code}: {said[-800:]}")
            if len(self.answers(study)) != TRIALS:
                self.wrong.append(f"{study}: {len(self.answers(study))} of {TRIALS} trials")
            self.acknowledged += len(acknowledged)
            self.look_at_whole(study)

    def look_at_whole(self, study):
        """Every planned trial, delivered as planned by the rig's own word."""
        with contextlib.closing(sqlite3.connect(self.folder / study)) as connection:
            bodies = [json.loads(body) for (body,) in connection.execute("SELECT body FROM event WHERE kind = 'trial.completed'")]
        for body in bodies:
            for presentation, value in zip(body["presentations"], (body["stimulus_1_n_per_m"], body["stimulus_2_n_per_m"])):
                if presentation.get("delivered") is None or abs(presentation["delivered"] - value) > 0.01 * value:
                    self.wrong.append(f"{study}: {presentation.get('delivered')} delivered for {value}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("jnd")
    parser.add_argument("--kills", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(os.path.abspath(options.jnd), pathlib.Path(folder), options.seed)
        write_inputs(campaign.folder)
        campaign.run(options.kills)
    print(f"{campaign.kills} kills in {campaign.studies} studies, {campaign.acknowledged} answers acknowledged, "
          f"{len(campaign.wrong)} faults found")
    for wrong in campaign.wrong:
        print("FAILED:", wrong)
    sys.exit(bool(campaign.wrong))


main()
