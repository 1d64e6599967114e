#!/usr/bin/env python3
"""A rig that goes wrong in one way, once: when it is started again it is a good one.

Usage: hostile_rig.py FAULT SEED FOLDER

Into FOLDER/done it writes the id of every presentation whose true end it has said."""
import json
import os
import pathlib
import random
import select
import signal
import subprocess
import sys
import time

FAULT, SEED, FOLDER = sys.argv[1], int(sys.argv[2]), pathlib.Path(sys.argv[3])
HELLO = {"protocol": 1, "name": "Hostile", "version": "1", "serial": "H", "model": True, "answers": True,
         "quantities": [{"name": "stiffness", "unit": "N/m", "min": 0, "max": 1000}], "parameters": [],
         "measures": [{"name": "force", "unit": "N"}]}
EXPLORE_S = 0.05


def hang():
    """Nothing more, until it is killed."""
    while True:
        signal.pause()


class Rig:
    def __init__(self, fault):
        self.fault, self.random = fault, random.Random(SEED)
        self.going = self.began = self.prepared = None
        self.text, self.muted, self.deaf, self.last_id = b"", False, False, None

    def write(self, data):
        if not self.muted:
            os.write(1, data)

    def say(self, kind, **fields):
        data = (json.dumps({"type": kind, **fields}) + "\n").encode()
        if self.fault == f"dies_within_{kind}":
            self.write(data[:self.random.randrange(1, len(data))])
            os.kill(os.getpid(), signal.SIGKILL)
        if self.fault == f"dies_before_{kind}":
            os._exit(self.random.randrange(256))
        self.write(data)
        if self.fault == f"dies_after_{kind}":
            os._exit(0)
        if self.fault == f"silent_after_{kind}":
            self.muted = True

    def done(self, outcome):
        with open(FOLDER / "done", "a", encoding="ascii") as file:
            file.write(f"{self.going}\n")
        self.say("done", id=self.going, outcome=outcome, duration_s=time.monotonic() - self.began, contacts=1,
                 first_contact_s=0)
        self.last_id, self.going = self.going, None

    def misbehave(self):
        """Within the presentation."""
        fault, now = self.fault, self.random
        lie = lambda **more: {**dict(id=self.going, outcome="complete", duration_s=0, contacts=0), **more}
        line = {
            "babbles": bytes(now.randrange(256) for _ in range(4000)) + b"\n",
            "short_babble": b"".join(bytes(now.randrange(32, 127) for _ in range(20)) + b"\n" for _ in range(20)),
            "not_utf8": b'{"type":"fault","cause":"\xff\xfe"}\n',
            "nan": b'{"type":"done","id":%d,"outcome":"complete","duration_s":NaN,"contacts":0}\n' % self.going,
            "huge": b'{"type":"done","id":%d,"outcome":"complete","duration_s":1e400,"contacts":0}\n' % self.going,
            "nul": b"\0" * 50 + b"\n",
            "deep": b"[" * 60000 + b"\n",
            "long_line": b"x" * 200000 + b"\n",
            "escape": b'{"type":"fault","id":%d,"cause":"\\u001b[2J"}\n' % self.going,
        }.get(fault)
        if line is not None:
            self.write(line)
        elif fault == "endless_line":
            while True:
                self.write(b"x" * 65536)
        elif fault == "endless_babble":
            while True:
                self.write(b"beep\n" * 1000)
        elif fault == "telemetry_flood":
            for _ in range(30000):
                self.say("telemetry", id=self.going, time_s=1, values={"force": 1})
        elif fault == "other_id":
            self.say("done", **lie(id=self.going + now.randrange(1, 5)))
        elif fault == "earlier_id":
            self.say("done", **lie(id=self.going - 1 or self.going + 7))
        elif fault == "done_early":
            self.say("done", **lie(duration_s=3))
        elif fault == "unknown_channel":
            self.say("done", **lie(peaks={"grip": 1}))
        elif fault == "second_hello":
            self.say("hello", **HELLO)
        elif fault == "alive_lies":
            self.say("alive", n=now.randrange(10**6, 10**9))
        elif fault == "unasked_answer":
            self.say("answer", id=self.going, answer="first")
        elif fault == "global_fault":
            self.say("fault", cause="no power")
        elif fault == "closes_output":
            os.close(1)
            hang()
        elif fault == "closes_input":
            os.close(0)
            hang()
        elif fault == "hangs":
            hang()
        elif fault == "deaf_until_stop":
            self.deaf = True
        elif fault == "ignores_term":
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
            hang()
        elif fault == "leaves_children":
            subprocess.Popen(["tail", "-f", "/dev/null"])
            subprocess.Popen(["tail", "-f", "/dev/null"], preexec_fn=lambda: os.setpgid(0, 0))
            if os.fork() == 0:
                os.setpgid(0, 0)
                signal.signal(signal.SIGTERM, signal.SIG_IGN)
                hang()
            os._exit(1)
        elif fault == "stops_itself":
            os.kill(os.getpid(), signal.SIGSTOP)
        if fault != "no_done_ever" and not fault.startswith(("dies", "silent", "late")):
            self.fault = None

    def hear(self, message):
        kind = message["type"]
        if kind == "hello":
            hello = HELLO
            if self.fault == "bad_hello":
                hello = {**HELLO, "quantities": []}
            elif self.fault == "late_hello":
                subprocess.run([sys.executable, "-c", ""], check=True)  # later than any other rig
            elif self.fault == "silent_from_the_start":
                hang()
            self.say("hello", **hello)
        elif kind == "alive":
            late = 8 if self.fault == "late_alive" else 0  # 200 ms
            if message["n"] > late and not self.deaf:
                self.say("alive", n=message["n"] - late)
        elif kind == "prepare":
            self.prepared = message["id"]
            self.say("ready", id=self.prepared + (1 if self.fault == "ready_of_another" else 0))
            if self.fault == "ready_of_another":
                self.fault = None
        elif kind == "present":
            self.going, self.began, self.prepared = message["id"], time.monotonic(), None
            self.say("contact", id=self.going, time_s=0)
        elif kind == "stop":
            self.deaf = False
            if self.fault == "late_alive":
                self.fault = None
            if self.going and self.fault != "no_done_ever":
                self.done("stopped")
            elif self.prepared:
                self.say("done", id=self.prepared, outcome="stopped", duration_s=0, contacts=0)
            self.prepared = None
        elif kind == "bye":
            sys.exit(0)

    def run(self):
        while True:
            if select.select([0], [], [], 0.002)[0]:
                more = os.read(0, 65536)
                if not more:
                    return
                *lines, self.text = (self.text + more).split(b"\n")
                for line in lines:
                    self.hear(json.loads(line))
            if self.going and self.fault:
                self.misbehave()
            if self.going and self.fault != "no_done_ever" and not self.deaf and time.monotonic() - self.began > EXPLORE_S:
                self.done("complete")


def main():
    first = not (FOLDER / "started").exists()
    (FOLDER / "started").touch()
    Rig(FAULT if first else None).run()


if __name__ == "__main__":
    try:
        main()
    except BrokenPipeError:
        sys.exit(1)
