#!/usr/bin/env python3
"""Kills sessions on an external rig with SIGKILL at random instants and runs the same command again, until they are complete.

After every kill: each answer that the program had acknowledged is in the study, `jnd verify` agrees, and the program of the rig is
gone with its session. At the end every trial is there once, with the planned stimuli, and was delivered by the rig.
The rig and the program have minutes for each other's words: what a busy machine does to them is no matter here.

Usage: kill_external_sessions.py JND PATIENT_RIG [--seed N]        8 kills, times JND_CAMPAIGN"""
import argparse
import contextlib
import json
import os
import pathlib
import random
import re
import select
import sqlite3
import subprocess
import sys
import tempfile
import time

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

PATIENT_RIG = program.argument()
ROOT = program.ROOT
RIG = ROOT / "devices/external/examples/plain_rig.py"
SAVED = re.compile(r"saved: trial (\d+), (\w+)")
FINISHED_BEFORE = "has finished this study"
TRIALS = 4


def write_inputs(folder):
    """A small design of `which`, and a rig file whose command can be told from every other process."""
    protocol = json.loads((ROOT / "protocols/studies/maereg2017.json").read_text(encoding="utf-8"))
    for part in ("assumed", "instructions", "published", "notes"):
        protocol.pop(part, None)
    protocol["trial"].update(explore_s=60, interval_end="contacts", contacts=1, gap_s=0, between_trials_s=0)
    for cue in protocol["trial"]["cues"].values():
        cue["kind"] = "none"
    protocol.update(levels={"absolute": [300, 500]},
                    conditions=[{"name": "thumb", "label": "thumb", "parameters": {"finger": "thumb"}}])
    protocol["design"].update(trials_per_cell=TRIALS // 2, order={"series": "fixed", "conditions": "fixed"})
    protocol["analysis"]["contrasts"] = []
    (folder / "which.json").write_text(json.dumps(protocol), encoding="utf-8")
    text = RIG.read_text(encoding="utf-8").replace("heard > 0.1", f"heard > {program.GUARD_S}")
    text = text.replace("abs(elapsed_s % 1.0", "abs(10 * elapsed_s % 1.0")  # ten presses a second: sessions are over soon
    (folder / "rig.py").write_text(text, encoding="utf-8")
    (folder / "rig.json").write_text(json.dumps({"format": 1, "title": "plain rig", "external": {
        "command": [sys.executable, str(folder / "rig.py")], "hello_s": program.GUARD_S, "prepare_s": program.GUARD_S}}), encoding="utf-8")


def running(text):
    """Processes whose command line has that text in it."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if entry.name.isdigit() and text.encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
    return found


class Campaign:
    def __init__(self, folder, seed):
        self.folder, self.generator = folder, random.Random(seed)
        self.kills = self.studies = self.acknowledged = self.voided = 0
        self.wrong = []

    def session(self, study, kill_after):
        """None where it was killed, else its exit code; with what it printed."""
        with program.start("rig.json", "run", "./which.json", "--study", study, "--participant", "P01", "--plain", "--seed", "4",
                           "--responder", "chinello2017", "--override-readiness", "a machine that runs tests",
                           program=PATIENT_RIG, folder=self.folder, stderr=subprocess.STDOUT) as process:
            killed, said = program.kill_within(process, kill_after)
        return None if killed else process.returncode, said

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
            verify = program.run("verify", study, "--deep", folder=self.folder, code=None)
            if verify.returncode != 0:
                self.wrong.append(f"{study}: {verify.said}")
        for left in running(str(self.folder / "rig.py")):
            with contextlib.suppress(ProcessLookupError):
                with open(os.pidfd_open(left), "rb") as process:  # can be read once it has ended
                    if not select.select([process], [], [], program.GUARD_S)[0]:
                        self.wrong.append(f"{study}: the rig's process {left} is still there")

    def run(self, kills):
        began = time.monotonic()
        code, said = self.session("whole.sqlite", None)
        whole_s = time.monotonic() - began  # kills come while a session goes on, however fast the machine is just now
        if code != 0:
            self.wrong.append(f"a session without a kill ended with {code}: {said[-800:]}")
        while self.kills < kills and not self.wrong:
            self.studies += 1
            study, acknowledged = f"{self.studies}.sqlite", {}
            for _ in range(1000):
                code, said = self.session(study, self.generator.uniform(0.02, whole_s) if self.kills < kills else None)
                acknowledged.update((int(number), answer) for number, answer in SAVED.findall(said))
                self.kills += code is None
                self.look_at(study, acknowledged)
                if code == 0 or FINISHED_BEFORE in said or self.wrong:
                    break
                if code is not None:
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
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(pathlib.Path(folder), options.seed)
        write_inputs(campaign.folder)
        campaign.run(program.campaign(8))
    print(f"{campaign.kills} kills in {campaign.studies} studies, {campaign.acknowledged} answers acknowledged, "
          f"{len(campaign.wrong)} faults found")
    for wrong in campaign.wrong:
        print("FAILED:", wrong)
    sys.exit(bool(campaign.wrong))


main()
