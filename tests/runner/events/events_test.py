#!/usr/bin/env python3
"""`jnd run --events` from outside: the events of whole sessions, readers that are stopped or gone, and the two example bridges."""
import contextlib
import json
import os
import pty
import re
import signal
import sys
import time

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

BRIDGES = program.ROOT / "runner/events"
KEYS = {"time_s", "n", "event", "version", "program", "clock", "trial", "practice", "attempt", "interval", "response_s", "reason", "dropped"}


class Events(program.Case):
    def session(self, events, fds=(), protocol="tutorial", code=0):
        self.begun_s = time.monotonic()
        return self.jnd("run", protocol, "--study", "study.sqlite", "--participant", "P01", "--responder", "chinello2017", "--fast", "--plain",
                        "--seed", "1", "--events", events, pass_fds=fds, code=code).said

    def judge(self, lines, said):
        """Numbered, in the order of time, and one of each for each trial that the console showed."""
        events = [json.loads(line) for line in lines]
        self.assertEqual([one["n"] for one in events], list(range(1, len(events) + 1)))
        times = [one["time_s"] for one in events]
        self.assertEqual(times, sorted(times))
        self.assertLess(self.begun_s, times[0])
        self.assertLess(times[-1], time.monotonic())
        for one in events:
            self.assertLessEqual(set(one), KEYS)
        names = [one["event"] for one in events]
        self.assertEqual(names[:2] + names[-2:], ["hello", "session.began", "session.ended", "bye"])
        answers = len(re.findall("saved: (?:practice|trial)", said))
        self.assertEqual(names.count("answered"), answers)
        self.assertEqual(names.count("question"), answers)
        self.assertEqual(names.count("interval.began"), 2 * answers)
        self.assertEqual(names.count("interval.ended"), 2 * answers)
        # Every trial is one round.
        rounds = " ".join(names[2:-2]).replace("break.began goes_on", "").split("trial.began")[1:]
        for one in rounds:
            self.assertEqual(one.split(), ["interval.began", "interval.ended"] * 2 + ["question", "answered"])
        return events

    def test_a_session_on_a_file_descriptor(self):
        with open(self.folder / "events.jsonl", "w+", encoding="utf-8") as file:
            said = self.session(file.fileno(), (file.fileno(),))
            file.seek(0)
            lines = file.readlines()
        events = self.judge(lines, said)
        self.assertNotIn("did not reach", said)
        # The plan's numbers, and nothing that tells the conditions, stimuli or answers.
        plan = self.jnd("plan", "tutorial", "--participant", "1", "--seed", "1", "--json").json
        self.assertLessEqual({one["trial"] for one in events if "trial" in one}, {one["index"] for one in plan["trials"]})
        text = "".join(lines)
        for word in ("900", "400", '"S"', '"SV"', "same", "different", "condition", "correct", "stimul"):
            self.assertNotIn(word, re.sub(r'"(?:time_s|response_s)":[0-9.]+', "", text))

    def test_free_interaction(self):
        with open(self.folder / "events.jsonl", "w+", encoding="utf-8") as file:
            self.session(file.fileno(), (file.fileno(),), protocol="chinello2017-experiment2")
            file.seek(0)
            names = [json.loads(line)["event"] for line in file]
        self.assertGreater(names.count("exploration.began"), 0)
        self.assertEqual(names.count("exploration.began"), names.count("exploration.ended"))

    def test_a_reader_that_stops_or_goes_away_stops_nothing(self):
        for how in (signal.SIGSTOP, signal.SIGKILL):
            path = self.folder / f"{how.name}.sock"
            # One is stopped before anybody comes; the other is gone with its first bytes.
            reader = self.started("-c", "import os,signal,socket,sys\ns=socket.socket(socket.AF_UNIX)\n"
                                       "s.bind(sys.argv[1]); s.listen(1); print('on', flush=True); c,_=s.accept(); c.recv(10)\n"
                                       "os.kill(os.getpid(), signal.SIGKILL)", path, program=sys.executable)
            reader.stdout.readline()
            if how == signal.SIGSTOP:
                reader.send_signal(how)
            said = self.session(path)
            self.assertIn("Done. The session of P01 is complete", said)
            self.assertEqual(reader.poll(), None if how == signal.SIGSTOP else -signal.SIGKILL)
            for file in self.folder.glob("study.sqlite*"):
                file.unlink()

    def test_dropped_lines_are_said_at_the_end(self):
        reads, writes = os.pipe()
        self.addCleanup(os.close, reads)
        try:
            os.set_blocking(writes, False)
            while True:  # full before it begins
                os.write(writes, b"x" * 4096)
        except BlockingIOError:
            os.set_blocking(writes, True)
        said = self.session(writes, (writes,))
        os.close(writes)
        self.assertRegex(said, r"\d+ events did not reach the reader of --events: it was too slow, or gone")

    def test_places_that_cannot_be(self):
        self.assertIn("no file descriptor of that number is open", self.session(77, code=program.INVALID))
        self.assertIn("is for the console", self.session(1, code=program.INVALID))
        self.assertIn("start the program that listens there first", self.session("none.sock", code=program.INVALID))
        self.assertFalse((self.folder / "study.sqlite").exists())

    def test_files_are_never_written_over(self):
        self.assertIn("give a path", self.session("", code=program.INVALID))  # a variable that is not set
        self.write("mine.txt", "mine")
        with open(self.folder / "mine.txt", "r+b") as file:
            self.assertIn("would be written over", self.session(file.fileno(), (file.fileno(),), code=program.INVALID))
        self.assertFalse((self.folder / "study.sqlite").exists())
        with open(self.folder / "mine.txt", "ab") as file:
            self.session(file.fileno(), (file.fileno(),))
        self.assertTrue(self.read("mine.txt").startswith('mine{"time_s"'))
        for suffix, flags in (("", os.O_RDWR), ("", os.O_WRONLY | os.O_APPEND), ("-wal", os.O_RDWR | os.O_CREAT), (".lock", os.O_RDWR | os.O_CREAT)):
            file = os.open(self.folder / f"study.sqlite{suffix}", flags, 0o600)
            self.assertIn("a file of the study itself", self.session(file, (file,), code=program.INVALID))
            os.close(file)
        self.jnd("verify", "study.sqlite")

    def test_bridges_take_nothing_away(self):
        before = self.write("thesis.sqlite", b"SQLite format 3\0 and more").read_bytes()
        for name, arguments, why in (("lsl_markers.py", ("thesis.sqlite",), "no socket"), ("serial_pulses.py", ("thesis.sqlite", "/dev/null"), ""),
                                     ("lsl_markers.py", ("bridge.sock", "--file", "thesis.sqlite"), "no markers")):
            done = program.run(BRIDGES / name, *arguments, program=sys.executable, folder=self.folder, code=1)
            self.assertIn(why, done.stderr)
            self.assertEqual((self.folder / "thesis.sqlite").read_bytes(), before)

    def test_markers_of_the_next_session_come_behind_the_first(self):
        markers = []
        for _ in range(2):
            bridge = self.bridge("lsl_markers.py", "--file", "markers.csv")
            self.session("bridge.sock")
            self.assertEqual(bridge.wait(program.GUARD_S), 0)
            markers.append(self.read("markers.csv"))
            for file in self.folder.glob("study.sqlite*"):
                file.unlink()
        self.assertTrue(markers[1].startswith(markers[0]))
        self.assertEqual([markers[1].count(word) for word in ("time_s,marker", ",hello", ",bye")], [1, 2, 2])

    def bridge(self, name, *arguments):
        bridge = self.started(BRIDGES / name, "bridge.sock", *arguments, program=sys.executable)
        self.assertEqual(bridge.stdout.readline(), "waits at bridge.sock\n")
        return bridge

    def test_the_bridge_of_markers(self):
        bridge = self.bridge("lsl_markers.py", "--file", "markers.csv")
        said = self.session("bridge.sock")
        self.assertEqual(bridge.wait(program.GUARD_S), 0)
        rows = self.read("markers.csv").splitlines()
        self.assertEqual(rows[0], "time_s,marker")
        markers = [row.split(",")[1] for row in rows[1:]]
        self.assertEqual(markers[0], "hello")
        self.assertEqual(sum(marker.startswith("answered:") for marker in markers), len(re.findall("saved: (?:practice|trial)", said)))
        self.assertIn("interval.began:2", markers)

    def test_the_bridge_of_pulses(self):
        ours, line = pty.openpty()
        self.addCleanup(os.close, ours)
        bridge = self.bridge("serial_pulses.py", os.ttyname(line), "--width-ms", "1")
        os.close(line)
        said = self.session("bridge.sock")
        self.assertEqual(bridge.wait(program.GUARD_S), 0)
        pulses = b""
        with contextlib.suppress(OSError):  # its end
            while True:
                pulses += os.read(ours, 4096)
        codes = pulses[0::2]
        self.assertEqual(set(pulses[1::2]), {0})
        answers = len(re.findall("saved: (?:practice|trial)", said))
        self.assertEqual([codes.count(code) for code in (1, 2, 3, 4, 5, 6)], [answers] * 6)
        self.assertEqual((codes[0], codes[-1]), (9, 10))


if __name__ == "__main__":
    program.main()
