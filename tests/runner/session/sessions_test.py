#!/usr/bin/env python3
"""One whole session of each kind of rig, from a protocol to the results of the study, with so few files open at a time that one
kept open per trial ends it. This is what sanitizers see of the program from outside.

Usage: sessions_test.py JND PATIENT_RIG
"""
import json
import os
import resource
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
        self.session("--rig", "specimens", "--kind", "pilot", "--fast", *ANYWAY, input=" " + (" " * 3 + "1") * 36)

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
        content = json.loads(self.read("study.json"))
        content["conditions"][0]["parameters"] = {"finger": "thumb"}
        self.write("study.json", content)
        example = (program.ROOT / "devices/external/examples/plain_rig.py").read_text(encoding="utf-8")
        self.assertIn("heard > 0.1", example)  # its own watchdog, which a busy machine sets off
        rig = self.write("rig.py", example.replace("heard > 0.1", f"heard > {program.GUARD_S}"))
        self.write("rig.json", {"format": 1, "title": "rig", "external": {"command": [sys.executable, str(rig)],
                                                                          "hello_s": program.GUARD_S, "prepare_s": program.GUARD_S}})
        self.session(*ANYWAY, program=PATIENT_RIG, before=("rig.json",), input=" " + " 1" * 12)


if __name__ == "__main__":
    program.main()
