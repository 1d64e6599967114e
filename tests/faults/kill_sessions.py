#!/usr/bin/env python3
"""Kills sessions with SIGKILL at random instants and runs the same command again, until the session is complete.

After every kill: each answer that the program had acknowledged is in the study, no trial is torn, every stimulus is the planned
one, and `jnd verify` agrees. At the end of a session its trials table equals an undisturbed run's (times aside). Four kinds of
session: simulated participants, the same with levels that their answers set by a staircase and by a posterior, and a person at
a pseudo-terminal. A person's trial that was felt and not answered comes again at the end of its block, so there the tables are
compared trial by trial, and answers with what the program said it saved.

Usage: kill_sessions.py JND [--seed N]        36 kills, times JND_CAMPAIGN"""
import argparse
import contextlib
import json
import os
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

# What the line mode of `jnd run` says.
TRIAL = re.compile(r"Trial (\d+) of")
WAITS_FOR_SPACE = "[space]"
ASKS = "[s] same"
SAVED = re.compile(r"\s+saved: \w+ \d+, (\w+)")
FINISHED_BEFORE = "has finished this study"
PRESSED_AGAIN_AFTER_S = 2  # without a word from the program: keys pressed before a prompt do not count

PLAN = ("participant", "trial", "block", "practice", "series", "condition", "stimulus_1_n_per_m", "stimulus_2_n_per_m", "same")
ANSWER = ("attempt", "answer", "correct")


class Tally:
    """What went wrong; nothing should."""

    NAMES = ("acknowledged answers lost", "torn trials", "plan differences", "verify failures", "final tables that differ",
             "unexpected endings")

    def __init__(self):
        self.wrong = dict.fromkeys(self.NAMES, 0)
        self.kills = self.studies = self.acknowledged = 0

    def count(self, name, condition, message):
        if not condition:
            self.wrong[name] += 1
            print(f"FAILED, {name}: {message}", flush=True)


def query(study, sql):
    with contextlib.closing(sqlite3.connect(study)) as connection:
        return connection.execute(sql).fetchall()


def plan_of(study):
    """Every answered trial's place and stimuli, by participant and trial."""
    return {row[:2]: row for row in query(study, f"SELECT {', '.join(PLAN)} FROM trials ORDER BY participant, trial")}


def answers_in_order(study):
    return query(study, f"SELECT {', '.join(PLAN + ANSWER)} FROM trials ORDER BY participant, seq")


def torn(study):
    """Answered trials whose event is not whole."""
    count = 0
    for (body,) in query(study, "SELECT body FROM event WHERE kind = 'trial.completed'"):
        event = json.loads(body)
        whole = len(event["presentations"]) == 2 and all(p["fingers"] for p in event["presentations"])
        count += not (whole and event["answer"] in ("same", "different"))
    return count


def check_study(study, session, expected, tally, name):
    """Everything that must hold whenever the program is not running."""
    if not os.path.exists(study):
        tally.count("acknowledged answers lost", not session.acknowledged, f"{name}: there is no study")
        return
    verify = program.run("verify", study, "--json", code=None)
    tally.count("verify failures", verify.returncode == 0, f"{name}: {verify.said}")
    tally.count("torn trials", torn(study) == 0, name)
    for key, row in plan_of(study).items():
        tally.count("plan differences", expected.get(key) == row, f"{name}: {row} instead of {expected.get(key)}")
    said = [row[len(PLAN) + 1] for row in answers_in_order(study)] if session.acknowledged else []
    for number, answer in session.acknowledged.items():
        tally.count("acknowledged answers lost", said[number - 1:number] == [answer], f"{name}: answer {number}, {answer}")


def small_protocol(folder, name="chinello2017"):
    """A shipped design, shortened to 8 trials a cell, 4 reversals or 12 trials a track, and short explorations."""
    path = os.path.join(folder, f"small-{name}.json")
    program.run("new", path, "--from", name)
    with open(path) as file:
        protocol = json.load(file)
    for part in ("assumed", "practice", "checklist", "consent", "instructions", "translations"):
        protocol.pop(part, None)
    if protocol["design"].get("procedure", {}).get("kind") == "posterior":
        protocol["design"]["procedure"].update(stop={"precision": 0.5, "at_most": 12})
    elif "procedure" in protocol["design"]:
        protocol["design"]["procedure"].update(stop={"reversals": 4, "at_most": 12}, averaged_reversals=2)
    else:
        protocol["design"]["trials_per_cell"] = 8
    protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1)
    protocol["questions"] = []
    with open(path, "w") as file:
        json.dump(protocol, file)
    return path


class Simulated:
    """Eight simulated participants on two threads."""

    by_trial = False  # whether trials may come in another order after a kill

    def __init__(self, protocol, study):
        self.command = ["simulate", protocol, "--participants", "8", "--study", study, "--seed", "1", "--threads", "2"]
        self.acknowledged = {}
        self.complaint = ""

    def run(self, kill_after):
        """True when the command finished by itself."""
        with program.start(*self.command, stderr=subprocess.STDOUT) as process:
            killed, said = program.kill_within(process, kill_after)
        self.complaint = "" if killed or process.returncode == 0 else f"ended with {process.returncode}: {said}"
        return not killed


class Person:
    """A person at a terminal; remembers every answer that the program said it saved."""

    by_trial = True

    def __init__(self, protocol, study):
        self.command = ["run", protocol, "--study", study, "--participant", "P01", "--seed", "1", "--fast", "--plain"]
        self.acknowledged = {}  # by the number of the answer in the session
        self.complaint = ""

    def run(self, kill_after):
        deadline = None if kill_after is None else time.monotonic() + kill_after
        terminal = program.Terminal(*self.command, env={"NO_COLOR": "1"})
        unread, number, said, wanted, pressed_at = "", 0, "", "", time.monotonic()
        while True:
            if deadline is not None and time.monotonic() > deadline:
                terminal.process.kill()
                deadline = None
            ready, _, _ = select.select([terminal.file], [], [], 0.01)
            if not ready:
                if wanted and time.monotonic() > pressed_at + PRESSED_AGAIN_AFTER_S:
                    pressed_at = self.press(terminal, wanted)
                continue
            try:
                data = os.read(terminal.file, 4096)
            except OSError:
                data = b""
            if not data:
                break
            unread += data.decode(errors="replace")
            while "\n" in unread:
                line, unread = unread.split("\n", 1)
                said += line + "\n"
                wanted = ""
                if match := TRIAL.search(line):
                    number = int(match[1])
                elif WAITS_FOR_SPACE in line:
                    wanted = " "
                elif ASKS in line:
                    wanted = "d" if number * 7 % 5 < 2 else "s"
                elif match := SAVED.match(line):
                    self.acknowledged[number] = match[1]
                if wanted:
                    pressed_at = self.press(terminal, wanted)
        os.close(terminal.file)
        status = terminal.process.wait(program.GUARD_S)
        if status < 0:
            return False
        # Killed between the session's last event and the program's end, it has nothing left to do.
        self.complaint = "" if status == 0 or FINISHED_BEFORE in said else f"ended with {status}: {said[-500:]}"
        return True

    @staticmethod
    def press(terminal, key):
        with contextlib.suppress(OSError):
            terminal.type(key)
        return time.monotonic()


def campaign(name, make, folder, protocol, kills, generator):
    tally = Tally()
    undisturbed = os.path.join(folder, f"{name}-undisturbed.sqlite")
    began = time.monotonic()
    first = make(protocol, undisturbed)
    first.run(None)
    whole = time.monotonic() - began
    tally.count("unexpected endings", not first.complaint, f"{name}: {first.complaint}")
    expected, expected_answers = plan_of(undisturbed), answers_in_order(undisturbed)
    tally.count("unexpected endings", expected, f"{name}: the undisturbed run has no trials")
    while tally.kills < kills and not any(tally.wrong.values()):
        tally.studies += 1
        study = os.path.join(folder, f"{name}-{tally.studies}.sqlite")
        session = make(protocol, study)
        for _ in range(1000):
            if session.run(generator.uniform(0.005, whole * 0.4) if tally.kills < kills else None):
                break
            tally.kills += 1
            check_study(study, session, expected, tally, name)
        tally.count("unexpected endings", not session.complaint, f"{name}: {session.complaint}")
        check_study(study, session, expected, tally, name)
        tally.acknowledged += len(session.acknowledged)
        same = plan_of(study) == expected if session.by_trial else answers_in_order(study) == expected_answers
        tally.count("final tables that differ", same, study)
        tally.count("final tables that differ", not os.path.exists(study + "-wal"), f"{name}: the study is more than one file")
        os.remove(study)
    print(f"{name}: {tally.kills} kills in {tally.studies} studies of {len(expected)} trials", flush=True)
    return tally


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = random.Random(options.seed)
    each = -(-program.campaign(36) // 4)  # of each kind of session
    with tempfile.TemporaryDirectory() as folder:
        fixed, adaptive, posterior = (small_protocol(folder, name)
                                      for name in ("chinello2017", "adaptive-staircase", "adaptive-posterior"))
        tallies = {name: campaign(name, make, folder, protocol, each, generator)
                   for name, make, protocol in (("simulated", Simulated, fixed), ("adaptive", Simulated, adaptive),
                                                ("posterior", Simulated, posterior), ("interactive", Person, fixed))}
    rows = [("kills", [t.kills for t in tallies.values()]), ("answers acknowledged", [t.acknowledged for t in tallies.values()])]
    rows += [(name, [t.wrong[name] for t in tallies.values()]) for name in Tally.NAMES]
    print(f"\n{'':26}" + "".join(f"{name:>13}" for name in (*tallies, "all")))
    for name, numbers in rows:
        print(f"{name:26}" + "".join(f"{number:13}" for number in (*numbers, sum(numbers))))
    sys.exit(any(any(t.wrong.values()) for t in tallies.values()))


main()
