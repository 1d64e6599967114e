#!/usr/bin/env python3
"""Kills sessions with SIGKILL at random instants and runs the same command again, until the session is complete.

Then the trials table must equal an undisturbed run's (times aside), `jnd verify` must agree, and every answer that the
program had acknowledged must be there. Three kinds of session: simulated participants, the same with levels that their answers set,
and a person at a pseudo-terminal.

Usage: kill_sessions.py JND [--kills N] [--seed N]
"""
import argparse
import contextlib
import json
import os
import pty
import random
import re
import select
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

COLUMNS = ("participant", "trial", "attempt", "block", "practice", "series", "condition", "stimulus_1_n_per_m", "stimulus_2_n_per_m",
           "same", "answer", "correct")


def trials(study):
    """The trials table without times, in presented order."""
    with contextlib.closing(sqlite3.connect(study)) as connection:
        return connection.execute(f"SELECT {', '.join(COLUMNS)} FROM trials ORDER BY participant, seq").fetchall()


def check(condition, message):
    if not condition:
        print(f"FAILED: {message}")
        sys.exit(1)


def verify(jnd, study):
    done = subprocess.run([jnd, "verify", study, "--json"], capture_output=True, text=True)
    check(done.returncode == 0, f"verify: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def small_protocol(jnd, folder, name="chinello2017"):
    """A shipped design, shortened to 8 trials a cell, or 4 reversals, and short explorations."""
    path = os.path.join(folder, f"small-{name}.json")
    subprocess.run([jnd, "new", path, "--from", name], check=True, stdout=subprocess.DEVNULL)
    with open(path) as file:
        protocol = json.load(file)
    protocol.pop("assumed", None)
    if "procedure" in protocol["design"]:
        protocol["design"]["procedure"].update(stop={"reversals": 4, "at_most": 12}, averaged_reversals=2)
    else:
        protocol["design"]["trials_per_cell"] = 8
    protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1)
    protocol["questions"] = []
    with open(path, "w") as file:
        json.dump(protocol, file)
    return path


class Simulated:
    """18 x 72 trials by simulated participants."""

    def __init__(self, jnd, protocol, study):
        self.command = [jnd, "simulate", protocol, "--participants", "8", "--study", study, "--seed", "1", "--threads", "2"]

    def run(self, kill_after):
        """True when the command finished by itself."""
        process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        try:
            output, _ = process.communicate(timeout=kill_after)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.communicate()
            return False
        check(process.returncode == 0, f"simulate ended with {process.returncode}: {output.decode()}")
        return True

    acknowledged = ()


class Person:
    """A person at a terminal who answers by a fixed rule; remembers every answer that the program said it saved."""

    def __init__(self, jnd, protocol, study):
        self.command = [jnd, "run", protocol, "--study", study, "--participant", "P01", "--seed", "1", "--fast"]
        self.acknowledged = []

    @staticmethod
    def answer(number):
        return "d" if number * 7 % 5 < 2 else "s"

    def run(self, kill_after):
        deadline = None if kill_after is None else time.monotonic() + kill_after
        pid, terminal = pty.fork()
        if pid == 0:
            os.environ["NO_COLOR"] = "1"
            os.execv(self.command[0], self.command)
        unread, number, finished_before = "", 0, False
        while True:
            if deadline is not None and time.monotonic() > deadline:
                os.kill(pid, signal.SIGKILL)
                deadline = None
            ready, _, _ = select.select([terminal], [], [], 0.01)
            if not ready:
                continue
            try:
                data = os.read(terminal, 4096)
            except OSError:
                data = b""
            if not data:
                break
            unread += data.decode(errors="replace")
            finished_before = finished_before or "has finished this study" in unread
            while "\n" in unread:
                line, unread = unread.split("\n", 1)
                if match := re.match(r"Trial (\d+) of", line):
                    number = int(match[1])
                elif "[space]" in line:
                    self.press(terminal, " ")
                elif "[s] same" in line:
                    self.press(terminal, self.answer(number))
                elif match := re.match(r"\s+saved: (\w+)", line):
                    self.acknowledged.append((number, match[1]))
        os.close(terminal)
        _, status = os.waitpid(pid, 0)
        if os.WIFSIGNALED(status):
            return False
        if finished_before:  # killed between the session's last event and the program's end
            return True
        check(os.WEXITSTATUS(status) == 0, f"run ended with {os.WEXITSTATUS(status)}")
        return True

    @staticmethod
    def press(terminal, key):
        # A little later than the prompt, as a person would: keys pressed before the prompt do not count.
        time.sleep(0.003)
        try:
            os.write(terminal, key.encode())
        except OSError:
            pass


def campaign(name, make, jnd, folder, protocol, kills, generator):
    undisturbed = os.path.join(folder, f"{name}-undisturbed.sqlite")
    began = time.monotonic()
    check(make(jnd, protocol, undisturbed).run(None), "the undisturbed run did not finish")
    whole = time.monotonic() - began
    expected = trials(undisturbed)
    check(len(expected) > 0, "the undisturbed run has no trials")
    done = rounds = 0
    while done < kills:
        rounds += 1
        study = os.path.join(folder, f"{name}-{rounds}.sqlite")
        session = make(jnd, protocol, study)
        for _ in range(1000):
            if session.run(generator.uniform(0.005, whole * 0.4) if done < kills else None):
                break
            done += 1
            if os.path.exists(study) and session.acknowledged:
                in_study = {row[1]: row[10] for row in trials(study)}
                for number, answer in session.acknowledged:
                    check(in_study.get(number) == answer, f"{name}: acknowledged answer {number} {answer} is not in the study")
        check(trials(study) == expected, f"{name}: the trials table differs from an undisturbed run's after kills")
        verify(jnd, study)
        check(not os.path.exists(study + "-wal"), f"{name}: the finished study is more than one file")
    print(f"{name}: {done} kills in {rounds} studies, {len(expected)} trials each: tables equal, verify clean, no acknowledged answer lost")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("jnd")
    parser.add_argument("--kills", type=int, default=12, help="of each kind of session")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    jnd = os.path.abspath(options.jnd)
    generator = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        protocol = small_protocol(jnd, folder)
        campaign("simulated", Simulated, jnd, folder, protocol, options.kills, generator)
        adaptive = small_protocol(jnd, folder, "adaptive-staircase")
        campaign("adaptive", Simulated, jnd, folder, adaptive, options.kills, generator)
        campaign("interactive", Person, jnd, folder, protocol, options.kills, generator)


main()
