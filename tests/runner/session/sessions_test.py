#!/usr/bin/env python3
"""One whole session of each kind of rig, from a protocol to the results of the study, with so few files open at a time that one
kept open per trial ends it. This is what sanitizers see of the program from outside.

Usage: sessions_test.py JND PATIENT_RIG
"""
import json
import os
import resource
import statistics
import subprocess
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

PATIENT_RIG = program.argument()
MOST_FILES = 24  # a session needs 16 at a time, on an external rig 21
ANYWAY = ("--override-readiness", "a machine that runs tests")


def few_files():
    resource.setrlimit(resource.RLIMIT_NOFILE, (MOST_FILES, MOST_FILES))


class Sessions(program.Case):
    def protocol(self, task, rig, trials_per_cell=6, **trial):
        self.jnd("new", "study.json", "--task", task, "--rig", rig)
        content = json.loads(self.read("study.json"))
        content["blinding"] = "open"
        content["design"]["trials_per_cell"] = trials_per_cell
        content["trial"].update(trial)
        self.write("study.json", content)

    def session(self, *options, before=(), **how):
        """A session, verified, with its results in every form."""
        said = self.jnd(*before, "run", "study.json", "--study", "s.sqlite", "--participant", "P01", "--plain", "--seed", 4, *options,
                        preexec_fn=few_files, **how).said
        self.says(said, "The session of P01 is complete")
        status = self.jnd("status", "s.sqlite", "--json", preexec_fn=few_files).json["sessions"][0]
        self.assertEqual(status["trials_done"], status["trials_total"])
        kind = status["kind"]
        for command in (("verify", "s.sqlite", "--deep"), ("analyze", "s.sqlite", "--all"), ("analyze", "s.sqlite", "--json"), ("export", "s.sqlite", "--to", "csv"),
                        ("export", "s.sqlite", "--to", "trace", "--telemetry"), ("report", "s.sqlite"),
                        ("backup", "s.sqlite", "--to", "copy.sqlite"), ("recover", "copy.sqlite", "--to", "again.sqlite")):
            self.jnd(*command, *(("--kind", kind) if command[0] in ("analyze", "export", "report") else ()), preexec_fn=few_files)
        self.assertEqual(len(self.rows("csv", "trials.csv")), status["trials_done"])
        return said

    def test_3rrs_devices(self):
        self.protocol("same-different", "rrs3", 8)
        self.session("--responder", "chinello2017", "--fast")

    def test_mckibben_muscles(self):
        self.protocol("which", "mckibben")
        self.session("--responder", "kinaesthetic", "--fast")

    def test_both_devices_of_a_finger(self):
        self.protocol("yes-no", "rrs3+mckibben", 18)
        self.session("--responder", "chinello2017", "--fast")

    def test_a_staircase(self):
        self.jnd("new", "study.json", "--task", "which", "--rig", "rrs3", "--procedure", "staircase")
        self.session("--responder", "chinello2017", "--fast")

    def test_specimens(self):
        self.protocol("which", "specimens", explore_s=0.5, gap_s=0, between_trials_s=0)
        self.session("--kind", "pilot", "--fast", *ANYWAY, input=" " + (" " * 3 + "1") * 36)

    def test_on_specimens_a_person_at_the_keys_is_real(self):
        self.on_disk = True
        self.protocol("which", "specimens", 2, explore_s=0.5, gap_s=0, between_trials_s=0)
        run = ("run", "study.json", "--study", "s.sqlite", "--participant", "P01", "--plain", "--seed", 4, *ANYWAY)
        self.says(self.jnd(*run, "--fast", code=program.USAGE).said, "--kind pilot for a rehearsal")
        keys = " " + (" " * 3 + "1") * 12
        said = self.jnd(*run, input=keys).said
        self.says(said, "REAL SESSION: this counts as data", "The session of P01 is complete")
        self.jnd(*run[:5], "P02", *run[6:], "--responder", "kinaesthetic", "--fast")
        self.jnd(*run[:5], "P03", *run[6:], "--kind", "pilot", "--fast", input=keys)
        self.assertEqual({one["participant"]: one["kind"] for one in self.jnd("status", "s.sqlite", "--json").json["sessions"]},
                         {"P01": "real", "P02": "simulated", "P03": "pilot"})

    def test_no_file_stays_open_after_a_trial(self):
        self.protocol("which", "specimens", explore_s=0.5, gap_s=0, between_trials_s=0)
        process = self.started("run", "study.json", "--study", "s.sqlite", "--participant", "P01", "--plain", "--rig", "specimens", "--kind",
                               "pilot", "--fast", *ANYWAY, stdin=subprocess.PIPE, stderr=subprocess.STDOUT)
        process.stdin.write(" ")  # the instructions
        shown, open_files = "", []
        for trial in range(1, 37):
            process.stdin.flush()
            while f"Trial {trial} of 36" not in shown:  # then it waits for a key
                line = process.stdout.readline()
                self.assertTrue(line, shown)
                shown += line
            open_files.append(len(os.listdir(f"/proc/{process.pid}/fd")))
            process.stdin.write(" " * 3 + "1")
        process.stdin.close()
        self.says(process.stdout.read(), "The session of P01 is complete")
        self.assertLessEqual(open_files[-1], open_files[1] + 2, open_files)

    def test_a_rig_of_the_laboratorys_own(self):
        self.protocol("which", "external", 2, explore_s=0.5, gap_s=0, between_trials_s=0)
        self.rig()
        self.session(*ANYWAY, program=PATIENT_RIG, before=("rig.json",), input=" " + " 1" * 12)

    def rig(self, *changes):
        """The plain rig, changed, and a protocol that gives its parameter."""
        content = json.loads(self.read("study.json"))
        content["conditions"][0]["parameters"] = {"finger": "thumb"}
        self.write("study.json", content)
        example = (program.ROOT / "devices/external/examples/plain_rig.py").read_text(encoding="utf-8")
        # Its own watchdog is what a busy machine sets off.
        for before, after in [("heard > 0.1", f"heard > {program.GUARD_S}"), *changes]:
            self.assertIn(before, example)
            example = example.replace(before, after)
        rig = self.write("rig.py", example)
        self.write("rig.json", {"format": 1, "title": "rig", "external": {"command": [sys.executable, str(rig)],
                                                                          "hello_s": program.GUARD_S, "prepare_s": program.GUARD_S}})

    # A motor that takes a second for a change of 1000 N/m.
    MOTOR = [("""    def prepare(self, request):
""", """    def prepare(self, request):
        before, self.stiffness = getattr(self, "stiffness", 900), request["value"]
        self.there = time.monotonic() + abs(self.stiffness - before) / 1000
"""), ("        return True\n", "        return time.monotonic() >= self.there\n"), ('"ready_s": 0', '"ready_s": 0.6')]

    def test_a_rig_that_needs_time_gets_ready_where_nothing_is_timed(self):
        """From `prepare` to `present` the longest passes that the rig may need, whatever comes: what it needed does not show."""
        self.protocol("same-different", "external", 4, explore_s=0.5, gap_s=0.6, between_trials_s=0)
        self.rig(*self.MOTOR, ("            kind = message[\"type\"]\n", """            kind = message["type"]
            if kind in ("prepare", "present"):
                with open("told.txt", "a") as file:
                    print(kind, message["trial"], message["interval"], message["value"], time.monotonic(), file=file)
"""))
        self.session(*ANYWAY, program=PATIENT_RIG, before=("rig.json",), input=" " + " s" * 100)
        told = [line.split() for line in self.read("told.txt").splitlines()]
        self.assertEqual([line[0] for line in told], ["prepare", "present"] * (len(told) // 2))
        waits = [float(after[4]) - float(before[4]) for before, after in zip(told[::2], told[1::2])]
        self.assertEqual([line[1:4] for line in told[::2]], [line[1:4] for line in told[1::2]])
        changes = {one[3] == other[3] for one, other in zip(told[1::2], told[3::2]) if other[2] == "1"}
        self.assertEqual(changes, {True, False}, "there are trials of both classes")
        self.assertGreater(statistics.median(waits), 0.59, waits)

    def test_what_a_rig_delivers_is_held_against_what_was_asked(self):
        self.protocol("which", "external", 4, explore_s=0.5, gap_s=0, between_trials_s=0)
        self.rig(('return peaks["force"] / peaks["depth"]', "return 3000"))
        said = self.session(*ANYWAY, program=PATIENT_RIG, before=("rig.json",), input=" " + " 1" * 24)
        words = "did not deliver what was asked"
        self.assertGreaterEqual(" ".join(said.split()).count(words), 3, said)  # after 10 trials, after 20, and at the end
        said = self.jnd("analyze", "s.sqlite", "--kind", "pilot").said
        self.says(" ".join(said.split()), "By its own measure the rig " + words + " in 48 of 48 intervals")


if __name__ == "__main__":
    program.main()
