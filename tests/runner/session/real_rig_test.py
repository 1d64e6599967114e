#!/usr/bin/env python3
"""Real sessions from outside, with the test program whose rig declares itself real: what only they do, and everything that is refused
before a device is worn."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import sqlite3
import stat
import subprocess
import sys
import tempfile
import time

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

REAL = program.argument()
# A busy machine may be late, which real sessions refuse; that the finding is bad is one test's subject, not all.
ANYWAY = ("--override-readiness", "a machine that runs tests")
ROOMS = {"protocols": "protocols", "profiles": "devices/profiles", "specs": "devices/specs", "objects": "devices/objects"}


class RealRig(program.Case):
    on_disk = True

    def setUp(self):
        self.study = self.folder / "study.sqlite"
        self.protocol = self.write_protocol("small")

    def write_protocol(self, name, **changes):
        """Four short trials, without practice, breaks and questions."""
        path = self.folder / f"{name}.json"
        self.jnd("new", path, "--from", "tutorial")
        protocol = json.loads(path.read_text())
        for key in ("practice", "breaks", "questions", "assumed", "checklist", "instructions", "consent", "translations", "resume",
                    "published"):
            protocol.pop(key, None)
        protocol["conditions"] = protocol["conditions"][:1]
        protocol["design"].update(trials_per_cell=4, participants=4)
        protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1, answer_time_out_s=60)
        protocol["analysis"].pop("contrasts", None)
        protocol["analysis"].pop("tests", None)
        protocol.update(changes)
        return self.write(f"{name}.json", protocol)

    def run_session(self, *options, on=REAL, keys=" s" * 10, participant="P01", study=None, protocol=None, code=None, data=None):
        environment = {"NO_COLOR": "1", **({"JND_DATA_DIR": str(data)} if data else {})}
        return program.run("run", protocol or self.protocol, "--study", study or self.study, "--participant", participant, "--plain",
                           "--realtime", "off", *options, program=on, input=keys, env=environment, code=code).said

    def query(self, sql, study=None):
        with contextlib.closing(sqlite3.connect(study or self.study)) as connection:
            return connection.execute(sql).fetchall()

    def bodies(self, kind, study=None):
        return [json.loads(body) for (body,) in self.query(f"SELECT body FROM event WHERE kind = '{kind}' ORDER BY rowid", study)]

    def data_folder(self, **calibration):
        """The shipped descriptions, with a calibration of the 3RRS device."""
        data = self.folder / "data"
        for room, path in ROOMS.items():
            shutil.copytree(program.ROOT / path, data / room, dirs_exist_ok=True)
        spec = data / "specs" / "rrs3.json"
        described = json.loads(spec.read_text())
        described.update(calibration)
        spec.write_text(json.dumps(described))
        return data

    # What a real session is.

    def test_whole_session(self):
        said = self.run_session(*ANYWAY, keys=" s" * 4, code=0)
        self.assertIn("REAL SESSION", said)
        self.assertNotIn("REHEARSAL", said)
        self.assertEqual(self.query("SELECT DISTINCT kind FROM sessions"), [("real",)])
        self.assertEqual(self.query("SELECT count(*) FROM trials"), [(4,)])
        opened = self.bodies("session.opened")[0]
        self.assertEqual(opened["kind"], "real")
        readiness = self.bodies("readiness.checked")
        self.assertEqual(len(readiness), 1)
        self.assertEqual([item["what"] for item in readiness[0]["items"]],
                         ["study folder", "devices", "limits", "calibration", "loop", "keyboard", "study", "plan", "participant", "clock", "sound"])
        found = {item["what"]: item for item in readiness[0]["items"]}
        self.assertIn("without a fault", found["devices"]["found"])
        self.assertIn("ticks of 1 ms", found["loop"]["found"])
        self.assertEqual(found["devices"]["verdict"], "ok")
        self.assertEqual(found["keyboard"]["verdict"], "warn")  # a pipe
        self.assertEqual(stat.S_IMODE(self.study.stat().st_mode), 0o600)
        self.jnd("verify", self.study)

    def test_normal_program_has_no_real_sessions(self):
        said = self.run_session("--kind", "real", on=program.JND, code=program.USAGE)
        self.assertIn("simulated", said)
        self.assertIn("pilot", said)  # what to do
        self.assertFalse(self.study.exists())

    def test_normal_program_is_pilot(self):
        self.run_session("--fast", on=program.JND, keys=" s" * 4, code=0)
        self.assertEqual(self.query("SELECT DISTINCT kind FROM sessions"), [("pilot",)])

    def test_a_technician_sees_forces_and_the_session_says_so(self):
        asked = self.run_session("--technician", *ANYWAY, keys="n", code=program.FOUND)
        self.assertIn("marked as unblinded", asked)
        self.assertEqual(self.query("SELECT count(*) FROM event WHERE kind = 'session.opened'"), [(0,)])
        said = self.run_session("--technician", *ANYWAY, keys="y" + " s" * 4, code=0)
        self.assertIn("UNBLINDED", said)
        peaks = [float(peak) for peak in re.findall(r"thumb: peak (\d+\.\d+) N, \d+\.\d mm deep", said)]
        self.assertEqual(len(peaks), 8)  # two intervals of four trials
        # As they were delivered.
        kept = [presentation["fingers"][0]["peak_force_n"] for body in self.bodies("trial.completed")
                for presentation in body["presentations"]]
        for shown, delivered in zip(peaks, kept):
            self.assertAlmostEqual(shown, delivered, delta=0.006)
        self.assertEqual(self.bodies("session.unblinded"), [{"shown": "forces"}])
        blind = self.run_session(*ANYWAY, participant="P02", code=0)
        self.assertNotIn("UNBLINDED", blind)
        self.assertNotRegex(blind, r"peak|mm deep|N of|N asked")
        self.assertEqual(len(self.bodies("session.unblinded")), 1)
        self.jnd("verify", self.study)
        status = self.jnd("status", self.study, "--json").json
        self.assertEqual([session["unblinded"] for session in status["sessions"]], [True, False])
        table = self.jnd("status", self.study).stdout
        self.assertEqual(table.count("closed, unblinded"), 1, table)

    def test_results_tell_which_sessions_were_not_blind(self):
        for participant, options in (("P01", ("--technician",)), ("P02", ())):
            self.run_session("--fast", *options, on=program.JND, keys=" s" * 4, participant=participant, code=0)  # a rehearsal is not asked about
        printed = self.jnd("analyze", self.study, "--kind", "pilot", "--json").json
        self.assertIn("The operator saw the forces of the trials, and so the stimuli, in 1 of 2 sessions: P01.", printed["deviations"])
        self.jnd("export", self.study, "--kind", "pilot", "--to", "export")
        self.assertEqual([row["unblinded"] for row in self.rows("export", "sessions.csv")], ["1", "0"])
        self.assertEqual([row["subject"] for row in self.rows("export", "log.csv") if row["event"] == "session_unblinded"], ["forces"])

    def test_forces_are_shown_of_the_programs_own_devices_only(self):
        shipped = program.ROOT / "protocols"
        for device in ("external", "specimens"):
            with self.subTest(device):
                protocol = next(path for path in sorted(shipped.rglob("*.json")) if json.loads(path.read_text()).get("rig", {}).get("device") == device)
                said = self.run_session("--technician", on=program.JND, protocol=protocol, code=program.USAGE)
                self.assertIn(f'--technician shows the forces of this program\'s own devices, and this protocol\'s rig is "{device}"', said)
                self.assertFalse(self.study.exists())

    def test_texts_that_stay_in_another_language_are_told_before_the_session(self):
        protocol = self.write_protocol("half", translations={"de": {"$.trial.cues.first.say": "Erste Kugel."}})
        said = self.run_session("--fast", "--language", "DE", on=program.JND, keys=" s" * 8, protocol=protocol)
        self.assertIn('The translation "DE" leaves out 2 texts of the participant\'s: $.trial.cues.second.say, '
                      "$.trial.cues.question.say. They are shown in en.", " ".join(said.split()))
        self.assertLess(said.index("leaves out"), said.index("Erste Kugel."))
        said = self.run_session("--fast", "--participant", "P02", on=program.JND, keys=" s" * 8, protocol=protocol)
        self.assertNotIn("leaves out", said)

    def test_real_rig_rehearses_when_told(self):
        self.run_session("--fast", "--kind", "pilot", keys=" s" * 4, code=0)
        self.assertEqual(self.query("SELECT DISTINCT kind FROM sessions"), [("pilot",)])

    def test_real_session_is_not_hurried(self):
        said = self.run_session("--fast", code=program.USAGE)
        self.assertIn("--fast", said)
        self.assertFalse(self.study.exists())

    # Readiness.

    def test_out_of_date_calibration_blocks(self):
        data = self.data_folder(calibrated="2020-01-01", calibration_valid_days=90)
        said = self.run_session(data=data, code=program.FOUND)
        self.assertIn("2020-01-01", said)
        self.assertIn("--override-readiness", said)
        self.assertEqual(self.query("SELECT count(*) FROM sessions"), [(0,)])
        said = self.run_session("--override-readiness", "calibrated by hand", data=data, keys=" s", code=program.STOPPED)
        readiness = self.bodies("readiness.checked")
        self.assertEqual(len(readiness), 1)
        self.assertTrue(readiness[0]["blocked"])
        self.assertEqual(readiness[0]["overridden"], "calibrated by hand")
        self.assertIn("bad", [item["verdict"] for item in readiness[0]["items"] if item["what"] == "calibration"])

    def test_empty_reason_overrides_nothing(self):
        data = self.data_folder(calibrated="2020-01-01", calibration_valid_days=90)
        self.run_session("--override-readiness", "", data=data, code=program.FOUND)
        self.assertEqual(self.query("SELECT count(*) FROM sessions"), [(0,)])

    def test_pilot_is_warned_of_calibration_only(self):
        data = self.data_folder(calibrated="2020-01-01", calibration_valid_days=90)
        said = self.run_session("--fast", on=program.JND, data=data, keys=" s" * 4, code=0)
        self.assertIn("out of date", said)

    def test_loss_of_data_is_never_overridden(self):
        if not os.path.isdir("/dev/shm") or not program.is_memory("/dev/shm") or not os.access("/dev/shm", os.W_OK):
            self.skipTest("there is no folder in memory")
        with tempfile.TemporaryDirectory(dir="/dev/shm") as memory:
            study = pathlib.Path(memory) / "study.sqlite"
            said = self.run_session(*ANYWAY, study=study, code=program.FOUND)
            self.assertIn("this is memory", said)
            self.assertIn("No reason", said)
            self.assertEqual(self.query("SELECT count(*) FROM sessions", study), [(0,)])

    def test_folder_that_cannot_be_written(self):
        # /proc/self takes no files, not even from root.
        said = self.run_session(*ANYWAY, study="/proc/self/study.sqlite", code=program.STORAGE)
        self.assertIn("/proc/self/study.sqlite", said)

    # What is refused.

    def test_finished_participant(self):
        self.run_session(*ANYWAY, keys=" s" * 4, code=0)
        said = self.run_session(*ANYWAY, code=program.USAGE)
        self.assertIn("has finished", said)
        self.assertIn("another code", said)

    def test_excluded_participant(self):
        self.run_session(*ANYWAY, keys=" s", code=program.STOPPED)
        self.jnd("exclude", self.study, "--participant", "P01", "--kind", "real", "--reason", "felt unwell")
        said = self.run_session(*ANYWAY, code=program.USAGE)
        self.assertIn("excluded", said)

    def test_second_participant_while_the_first_waits(self):
        self.run_session(*ANYWAY, keys=" s", code=program.STOPPED)
        said = self.run_session(*ANYWAY, participant="P02", code=program.USAGE)
        self.says(said, "P01", "unfinished", "--new")
        self.assertEqual(self.query("SELECT participant FROM sessions"), [("P01",)])
        self.run_session(*ANYWAY, "--new", participant="P02", keys=" s", code=program.STOPPED)
        self.assertEqual(self.query("SELECT participant, participant_number FROM sessions ORDER BY participant"), [("P01", 1), ("P02", 2)])

    def test_resumed_with_another_description_of_the_rig(self):
        self.run_session(*ANYWAY, keys=" s", code=program.STOPPED)
        data = self.data_folder(calibrated="2026-01-01")
        said = self.run_session(*ANYWAY, data=data, code=program.USAGE)
        self.assertIn("another rig", said)
        self.assertEqual(len(self.bodies("session.resumed")), 0)

    def test_resumed(self):
        begun_s = time.monotonic()
        self.run_session(*ANYWAY, keys=" s s", code=program.STOPPED)
        said = self.run_session(*ANYWAY, keys=" s" * 4, code=0)
        self.assertIn("Interrupted for", said)
        resumed = self.bodies("session.resumed")
        self.assertEqual(len(resumed), 1)
        self.assertGreaterEqual(resumed[0]["gap_s"], 0)
        self.assertLess(resumed[0]["gap_s"], time.monotonic() - begun_s)
        self.assertEqual(resumed[0]["trials_done"], 2)
        self.assertIn(resumed[0]["gap_clock"], ("monotonic", "wall"))
        self.assertTrue(resumed[0]["cause"])
        self.assertEqual(len(self.bodies("readiness.checked")), 2)

    def test_gap_that_is_too_long_needs_a_reason(self):
        protocol = self.write_protocol("strict", resume={"longest_gap_min": 0.0001})
        self.run_session(*ANYWAY, protocol=protocol, keys=" s", code=program.STOPPED)
        said = self.run_session(*ANYWAY, protocol=protocol, code=program.USAGE)
        self.assertIn("longer than the protocol allows", said)
        self.assertIn("--accept-gap", said)
        self.assertEqual(len(self.bodies("session.resumed")), 0)
        self.run_session(*ANYWAY, "--accept-gap", "a fire alarm", protocol=protocol, keys=" s" * 4, code=0)
        resumed = self.bodies("session.resumed")
        self.assertEqual([(body["too_long"], body["reason"]) for body in resumed], [(True, "a fire alarm")])

    def test_study_open_in_another_process(self):
        self.run_session(*ANYWAY, keys=" s", code=program.STOPPED)
        # Waits for keys that never come, with the study open.
        with program.start("run", self.protocol, "--study", self.study, "--participant", "P01", "--plain", "--realtime", "off", *ANYWAY, program=REAL, env={"NO_COLOR": "1"},
                           stdin=subprocess.PIPE, stderr=subprocess.STDOUT) as holder:
            try:
                for line in holder.stdout:
                    if re.match(r"Trial \d+ of", line):
                        break
                else:
                    self.fail("the first session did not begin")
                said = self.run_session(*ANYWAY, code=program.STORAGE)
                self.assertIn(str(holder.pid), said)
            finally:
                holder.stdin.close()
                holder.stdout.read()
            self.assertEqual(holder.wait(program.GUARD_S), program.STOPPED)

    def test_changed_protocol_is_shown(self):
        self.run_session(*ANYWAY, keys=" s", code=program.STOPPED)
        changed = json.loads(self.protocol.read_text())
        changed["trial"]["explore_s"] = 1.25
        self.protocol.write_text(json.dumps(changed))
        said = self.run_session(*ANYWAY, code=program.INVALID)
        self.assertIn("explore_s", said)
        self.assertIn("1.25", said)
        self.assertEqual(len(self.bodies("session.resumed")), 0)


if __name__ == "__main__":
    program.main()
