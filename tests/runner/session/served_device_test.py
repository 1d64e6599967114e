#!/usr/bin/env python3
"""Devices that are programs, from outside: `jnd device`, `jnd doctor` and whole sessions on the tutorial's study, on virtual
devices that are served on a socket or started by the rig file; killed, cut off, and gone on with."""
import contextlib
import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

VIRTUAL = program.argument()
TRIALS = 2 * min(10, program.campaign(1))  # of a session, after one of practice


class Served(program.Case):
    def setUp(self):
        self.served = {}
        self.addCleanup(self.end_all)
        self.study = self.folder / "study.sqlite"

    def end_all(self):
        for process in self.served.values():
            process.kill()
            process.wait()
            process.stdout.close()

    def serve(self, serial, finger, *options):
        """A virtual device on FINGER.sock; returns when it can be connected to."""
        first, *words = program.at_priority(60, VIRTUAL, "--socket", f"{finger}.sock", "--serial", serial, "--finger", finger,
                                               "--log", f"{serial}.log", *options)
        process = program.start(*words, program=first, folder=self.folder, stderr=None)
        self.assertEqual(process.stdout.readline(), f"{serial} is served at {finger}.sock\n")
        if finger in self.served:
            self.served[finger].stdout.close()
        self.served[finger] = process

    def kill(self, finger):
        self.served[finger].kill()
        self.served[finger].wait()

    def rig(self, *devices):
        return self.write("booth.json", {"format": 1, "title": "Booth", "devices": list(devices)})

    def both_served(self):
        self.serve("RRS3-0001", "thumb")
        self.serve("RRS3-0002", "index")
        return self.rig({"finger": "thumb", "socket": "thumb.sock"},
                        {"finger": "index", "socket": "index.sock", "serial": "RRS3-0002"})

    def of_rig(self, serial, finger, *options):
        return {"finger": finger, "command": program.at_priority(60, VIRTUAL, "--inherited", "--serial", serial, "--finger", finger, *options)}

    def jnd(self, *arguments, code=0):
        said = super().jnd(*arguments, code=code).said
        self.assertNotIn("\033", said)
        return said

    def protocol(self):
        """The tutorial, with shorter intervals, a trial of practice and TRIALS of one condition."""
        path = self.folder / "study.json"
        path.unlink(missing_ok=True)
        self.jnd("new", path, "--from", "tutorial")
        protocol = json.loads(path.read_text())
        protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1, max_attempts=10)  # a busy machine may be late
        protocol["design"].update(trials_per_cell=TRIALS, sampling="random")
        protocol["design"].pop("run_limit")
        protocol["conditions"] = protocol["conditions"][:1]
        protocol["analysis"].pop("contrasts")
        protocol["translations"] = {}
        protocol["practice"].update(trials=1, criterion_correct=0.5, max_rounds=1)
        protocol["breaks"][0]["duration_s"] = 1
        return self.write("study.json", protocol)

    def session(self, protocol, rig):
        return program.start("run", protocol, "--study", self.study, "--participant", "P01", "--responder", "chinello2017",
                                 "--rig", rig, "--plain", "--seed", "7", folder=self.folder, stderr=subprocess.STDOUT)

    def whole_session(self, protocol, rig):
        session = self.session(protocol, rig)
        said, _ = session.communicate(timeout=program.GUARD_S)
        self.assertEqual(session.returncode, 0, said)
        return said

    def until_unhindered(self, play):
        """A machine that is busy all the time voids a trial until it is given up: then all once more, in a study of its own."""
        def is_done():
            for finger in self.served:
                self.kill(finger)
            for file in self.folder.glob("study.sqlite*"):
                file.unlink()
            return play() is not False and self.bodies("trial.abandoned") == []

        program.until(is_done, "a session without a trial that was given up")

    def bodies(self, kind):
        with contextlib.closing(sqlite3.connect(self.study)) as connection:
            rows = connection.execute("SELECT body FROM event WHERE kind = ? ORDER BY rowid", (kind,)).fetchall()
        return [json.loads(body) for (body,) in rows]

    def judge(self):
        done = [one for one in self.bodies("trial.completed") if not one.get("practice")]
        self.assertEqual(sorted(one["index"] for one in done), list(range(2, TRIALS + 2)))
        for one in done:
            for presentation in one["presentations"]:
                self.assertEqual(len(presentation["fingers"]), 2)
        self.assertIn("agrees", self.jnd("verify", self.study, "--deep"))
        opened = self.bodies("session.opened")[0]
        self.assertIn("HID", opened["rig"])
        self.assertEqual(opened["kind"], "simulated")
        last = self.bodies("rig.connections")[-1]
        self.assertEqual({one["serial"] for one in last["devices"]}, {"RRS3-0001", "RRS3-0002"})
        self.assertEqual([one["damaged"] for one in last["devices"]], [0, 0])
        return last

    def judge_device(self, serial):
        """Whenever it stopped under force, its own watchdog did it, in time; and it holds nobody now."""
        events = [json.loads(line) for line in (self.folder / f"{serial}.log").read_text().splitlines()]
        for event in events:
            if event["event"] == "state" and event["to"] == "stopped":
                self.assertEqual(event["faults"], ["watchdog"])
                self.assertEqual(event["push_n"], 0)
        pushes = [event for event in events if event["event"] in ("push", "let_go")]
        if pushes:
            self.assertEqual(pushes[-1]["event"], "let_go")

    def benched(self, *arguments, repeats):
        """What a command prints that works with a device in real time. On a busy machine commands and readings come late, and
        device or program stops, as it should: then once more."""
        guard = time.monotonic() + program.GUARD_S
        while True:
            first, *words = program.at_priority(50, program.JND, *arguments)
            done = program.run(*words, program=first, folder=self.folder, code=None)
            if done.returncode == 0:
                return done.stdout
            said = done.said
            self.assertTrue(any(word in said for word in repeats), said)
            self.assertLess(time.monotonic(), guard, said)

    def device_test(self, *device):
        said = self.benched("device", "test", *device, "--yes", repeats=("FAILED", "watchdog", "stale_reading", "command_gap"))
        self.assertIn("all 22 judged checks ok", said)

    def test_device_commands_on_a_socket(self):
        self.serve("RRS3-0001", "thumb")
        self.assertIn("thumb.sock, socket jnd fingertip device (virtual)", self.jnd("device", "info", "thumb.sock"))
        said = json.loads(self.jnd("device", "info", "thumb.sock", "--json"))
        self.assertEqual((said["serial"], said["transport"], said["finger"]), ("RRS3-0001", "socket", "thumb"))
        self.device_test("thumb.sock")
        self.write("points.csv", "known_n,pushed_n\n" + "".join(f"{n},{n}\n" for n in (0.5, 1.5, 3)))
        stiffness = () if TRIALS > 2 else ("--no-stiffness",)  # half a minute
        calibrated = self.benched("device", "calibrate", "thumb.sock", "--operator", "A. Smith", "--reference-name", "a model",
                                  "--reference", "points.csv", "--yes", "--store", "--out", "certificate.json", *stiffness,
                                  repeats=("watchdog", "stale_reading", "command_gap"))
        self.assertIn("Table and certificate are in the device", calibrated)
        self.assertIn("certificate", self.jnd("device", "info", "thumb.sock"))

    def test_device_commands_on_the_devices_of_a_rig_file(self):
        self.serve("RRS3-0001", "thumb")
        rig = self.rig({"finger": "thumb", "socket": "thumb.sock"}, self.of_rig("RRS3-0002", "index"))
        ours = [one for one in json.loads(self.jnd("device", "list", "--rig", rig, "--json"))["hid"] if one["ours"]]
        self.assertEqual({(one["serial"], one["transport"], one["finger"], one["usable"]) for one in ours},
                         {("RRS3-0001", "socket", "thumb", True), ("RRS3-0002", "program", "index", True)})
        self.assertIn("RRS3-0002", self.jnd("device", "info", "RRS3-0002", "--rig", rig))
        self.device_test("RRS3-0002", "--rig", rig)

    def test_what_is_not_there_is_said(self):
        self.assertIn("no device is served at none.sock", self.jnd("device", "info", "none.sock", code=program.DEVICE))
        rig = self.rig({"finger": "thumb", "socket": "none.sock"}, {"finger": "index", "command": ["sh", "-c", "echo broken >&2; exit 3"]})
        said = self.jnd("run", "tutorial", "--study", self.study, "--participant", "P01", "--responder", "chinello2017", "--rig", rig,
                        "--plain", code=program.DEVICE)
        self.assertIn("no device for the thumb and the index finger is connected", said)
        self.assertIn("none.sock: start the program that serves it", said)
        self.assertIn("has ended (exit code 3), and said last: broken", said)
        self.assertFalse(self.study.exists())
        self.assertIn("none.sock", self.jnd("device", "list", "--rig", rig))
        for wrong, message in (({"finger": "thumb", "socket": "a.sock", "command": ["b"]}, "leave one of them out"),
                               ({"finger": "thumb", "command": []}, "command"), ({"finger": "thumb", "socket": 3}, "socket")):
            self.assertIn(message, self.jnd("device", "list", "--rig", self.rig(wrong), code=program.INVALID))
        self.assertIn("--buttons", program.run("--buttons", "--socket", "x.sock", program=VIRTUAL, folder=self.folder, code=None).stderr)
        for wrong in (("--socket", "no/such/x.sock"), ("--inherited",)):
            program.run(*wrong, program=VIRTUAL, folder=self.folder, code=program.DEVICE)

    def test_doctor_looks_whether_they_are_there(self):
        def finding(rig):
            done = program.run("doctor", "--rig", rig, "--seconds", "0.1", "--json", folder=self.folder, code=None)
            return next(one for one in done.json["checks"] if one["name"] == "devices")
        served = {"finger": "thumb", "socket": "thumb.sock"}
        self.assertEqual(finding(self.rig(served))["verdict"], "bad")
        self.serve("RRS3-0001", "thumb")
        self.assertEqual(finding(self.rig(served))["verdict"], "ok")
        found = finding(self.rig(served, self.of_rig("RRS3-0002", "index")))
        self.assertEqual(found["verdict"], "ok")
        self.assertIn("a session starts", found["found"])
        self.assertIn("no program", finding(self.rig({"finger": "thumb", "command": ["jnd-no-such-program"]}))["found"])

    def test_a_session_on_a_served_device_and_one_that_it_starts(self):
        rig = self.rig({"finger": "thumb", "socket": "thumb.sock"}, self.of_rig("RRS3-0002", "index", "--log", "RRS3-0002.log"))
        protocol = self.protocol()

        def play():
            self.serve("RRS3-0001", "thumb")
            self.assertIn("Done. The session of P01 is complete", self.whole_session(protocol, rig))

        self.until_unhindered(play)
        last = self.judge()
        self.assertEqual([one["reconnections"] for one in last["devices"]], [0, 0])
        self.assertTrue(all(one["received"] > 1000 for one in last["devices"]), last)
        for serial in ("RRS3-0001", "RRS3-0002"):
            self.judge_device(serial)
        left = program.run("-f", f"{VIRTUAL} --inherited", program="pgrep", code=None).stdout
        self.assertEqual([pid for pid in left.split() if os.path.realpath(f"/proc/{pid}/cwd") == str(self.folder)], [])

    def test_devices_killed_at_random_and_a_session_killed_and_gone_on_with(self):
        self.until_unhindered(self.play_with_kills)
        self.judge()
        faults = self.bodies("device.fault")
        self.assertLessEqual({one["cause"] for one in faults},
                             {"device_lost", "device_fault", "stale_reading", "command_gap", "stale_pose"}, faults)

    def play_with_kills(self):
        """Returns False if all trials were given up before the session could be killed."""
        rig, protocol = self.both_served(), self.protocol()
        draw = random.Random(11)
        session = self.session(protocol, rig)
        trials = kills = 0
        killed_session = False
        lines, absent = [], []
        for line in session.stdout:
            lines.append(line)
            trials += "saved: trial" in line
            while absent:  # until the session says something
                self.serve(*absent.pop())
            if "First sphere" in line and kills <= TRIALS:
                finger = draw.choice(["thumb", "index"])
                serial = {"thumb": "RRS3-0001", "index": "RRS3-0002"}[finger]
                # Before it is touched, under force, and after the first press.
                events = len(self.pushed(serial)) + kills % 3
                program.until(lambda: len(self.pushed(serial)) >= events or session.poll() is not None)
                kills += 1
                self.kill(finger)
                absent.append((serial, finger))
                if draw.random() < 0.5:
                    self.serve(*absent.pop())
            if trials == TRIALS // 2 and not killed_session:
                killed_session = True
                session.send_signal(signal.SIGKILL)
        session.wait()
        session.stdout.close()
        for one in absent:
            self.serve(*one)
        self.assertTrue(killed_session or self.bodies("trial.abandoned"), "".join(lines))
        if not killed_session:
            return False
        self.assertEqual(session.returncode, -signal.SIGKILL)
        self.assertGreater(kills, 0)
        for serial in ("RRS3-0001", "RRS3-0002"):
            program.until(lambda: self.pushed(serial)[-1:] != ["push"])  # the host is gone: its watchdog lets go
            self.judge_device(serial)
        self.whole_session(protocol, rig)
        return True

    def pushed(self, serial):
        """Each time that the device, since it was served last, began to push or let go."""
        events = [json.loads(line)["event"] for line in (self.folder / f"{serial}.log").read_text().splitlines()]
        return [event for event in events if event in ("push", "let_go")]


if __name__ == "__main__":
    program.main()
