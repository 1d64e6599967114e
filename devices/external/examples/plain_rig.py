#!/usr/bin/env python3
"""A rig of your own, to start from: put your hardware in place of Device and your ranges in HELLO, and keep the rest. What
each message means is in ../PROTOCOL.md; `jnd device test external --command "python3 plain_rig.py"` tries it."""
import json
import os
import select
import time

HELLO = {"protocol": 1, "name": "Plain rig", "version": "1.0", "serial": "none", "model": True, "answers": False,
         "ready_s": 0,  # the longest that prepare() takes for any change, such as of a motor, and a little more
         "quantities": [{"name": "stiffness", "unit": "N/m", "min": 100, "max": 1000}],
         "parameters": [{"name": "finger", "words": ["thumb", "index"]}],
         "measures": [{"name": "force", "unit": "N"}, {"name": "depth", "unit": "m"}]}


class Device:
    """Your hardware. This one is a model, and HELLO says so: a finger that presses 4 mm deep, once a second."""

    def prepare(self, request):
        """Begins to get ready, and nobody feels it: here a motor moves to its place. jnd says it before anything is timed."""

    def is_ready(self):
        """Whether it is. What begins then must be felt at once, however far the value was from the one before."""
        return True

    def begin(self, request):
        """A stimulus begins; what it is stands in request["value"] and request["parameters"]."""
        self.stiffness = request["value"]

    def step(self, elapsed_s):
        """Called every few ms while the stimulus is there. Returns whether it is touched, and what is measured."""
        depth = max(0.0, 0.008 * (0.5 - abs(elapsed_s % 1.0 - 0.5) * 2))
        return depth > 0, {"depth": depth, "force": self.stiffness * depth}

    def delivered(self, peaks):
        """Of the quantity, from the largest of what was measured; None where that is not known."""
        return peaks["force"] / peaks["depth"]

    def off(self):
        """No force, at once. Called often: it must do no harm when the device is off already."""


def say(kind, **fields):
    print(json.dumps({"type": kind, **fields}), flush=True)  # a message a line, and never left in a buffer


def problem(hello, message):
    """Why this cannot be presented, or None. jnd asks for nothing beyond hello; a rig looks all the same."""
    given = {**message["parameters"], message["quantity"]: message["value"]}
    for item in hello["quantities"] + hello["parameters"]:
        value = given.get(item["name"])
        if value is None or not (value in item["words"] if "words" in item else item["min"] <= value <= item["max"]):
            return f"{item['name']} cannot be {value}"
    return None


class Presentation:
    """One interval. It begins with `present`, ends as its exploration says or with `stop`, and says one `done`."""

    def __init__(self, device, request):
        self.device, self.id, self.how, self.began = device, request["id"], request["exploration"], time.monotonic()
        self.first, self.contacts, self.touching, self.peaks = None, 0, False, {}

    def step(self):
        """Renders. Returns how the presentation ended, or None while it goes on."""
        now = time.monotonic() - self.began
        touching, measured = self.device.step(now)
        if touching and not self.touching:
            self.contacts, self.first = self.contacts + 1, now if self.first is None else self.first
            say("contact", id=self.id, time_s=now)
        self.touching = touching
        say("telemetry", id=self.id, time_s=time.monotonic(), values=measured)  # kept with the trial, as its trace
        self.peaks = {name: max(value, self.peaks.get(name, value)) for name, value in measured.items()}
        if self.first is None and now > self.how.get("no_contact_s", 1e9):
            return "no_contact"
        start = 0 if self.how.get("from") == "start" else self.first
        over = {"time": start is not None and now - start >= self.how.get("duration_s", 0),
                "contacts": self.contacts - touching >= self.how.get("contacts", 0), "stop": False}
        return "complete" if over[self.how["ends"]] else None

    def done(self, outcome):
        self.device.off()
        known = {"first_contact_s": self.first, "delivered": self.device.delivered(self.peaks)} if self.contacts else {}
        say("done", id=self.id, outcome=outcome, duration_s=time.monotonic() - self.began, contacts=self.contacts,
            peaks=self.peaks, **{key: value for key, value in known.items() if value is not None})


def serve(hello, device):
    """Speaks with jnd until it says bye or is gone. An error of the device ends the program, and jnd says its last line."""
    going, prepared, waiting, text, heard = None, None, False, b"", time.monotonic()
    while True:
        if select.select([0], [], [], 0.005)[0]:  # until jnd says something, at most 5 ms
            more = os.read(0, 65536)
            if not more:
                return device.off()  # jnd is gone
            text, heard = text + more, time.monotonic()
        elif going and time.monotonic() - heard > 0.1:
            device.off()  # jnd is not heard any more: no force without it
            say("fault", id=going.id, cause="jnd has fallen silent")
            going = None
        *lines, text = text.split(b"\n")
        for message in map(json.loads, lines):
            kind = message["type"]
            if kind == "hello":
                say("hello", **hello)
            elif kind == "alive":
                say("alive", n=message["n"])  # at once: jnd stops a presentation after 100 ms without it
            elif kind in ("prepare", "present") and (going or problem(hello, message)):
                say("fault", id=message["id"], cause=problem(hello, message) or "busy")
            elif kind == "prepare":
                device.prepare(message)
                prepared, waiting = Presentation(device, message), True
            elif kind == "present":
                device.begin(message)
                going, prepared, waiting = Presentation(device, message), None, False
            elif kind == "stop" and (going or prepared):
                (going or prepared).done("complete" if going and message["reason"] == "enough" else "stopped")
                going, prepared, waiting = None, None, False
            elif kind == "bye":
                return device.off()
            # What else comes is of a later version of jnd: let it pass.
        if waiting and device.is_ready():
            say("ready", id=prepared.id)
            waiting = False
        outcome = going.step() if going else None
        if outcome:
            going = going.done(outcome)


if __name__ == "__main__":
    serve(HELLO, Device())
