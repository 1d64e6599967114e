#!/usr/bin/env python3
"""The sounds of a whole session from outside: cues and masking noise through a player that notes what it is given, the bell where
there is none, what `jnd doctor` says, and what a rig file may ask for.

Usage: sound_test.py JND JND_VIRTUAL_DEVICE
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

JND, VIRTUAL = (os.path.abspath(path) for path in sys.argv[1:3])
DONE, LATE, USAGE, INPUT, DEVICE = 0, 1, 2, 3, 4
PLAYER = """#!/bin/sh
for file in "$@"; do :; done
echo "$(basename "$file") $(cksum < "$file" | cut -d' ' -f1)" >> "{record}"
case "$file" in *noise*|*metronome*) exec sleep 60;; esac
"""


class Sound(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "bin").mkdir()
        self.record = self.folder / "record"

    def player(self, name="pw-play"):
        path = self.folder / "bin" / name
        path.write_text(PLAYER.format(record=self.record))
        path.chmod(0o755)

    def jnd(self, *arguments, code=DONE):
        environment = dict(os.environ, PATH=f"{self.folder / 'bin'}:/usr/bin:/bin", NO_COLOR="1", TMPDIR=str(self.folder))
        done = subprocess.run([JND, *map(str, arguments)], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=300)
        self.assertIn(done.returncode, code if isinstance(code, tuple) else (code,), done.stdout + done.stderr)
        return done.stdout + done.stderr

    def protocol(self, **trial):
        """Four short trials of one condition."""
        path = self.folder / "study.json"
        self.jnd("new", path, "--from", "tutorial")
        protocol = json.loads(path.read_text())
        for key in ("practice", "breaks", "translations"):
            protocol.pop(key)
        protocol["conditions"] = protocol["conditions"][:1]
        protocol["analysis"].pop("contrasts")
        protocol["design"]["trials_per_cell"] = 4
        protocol["instructions"] = []
        protocol["trial"].update(explore_s=0.5, gap_s=0.1, between_trials_s=0.1, max_attempts=10, **trial)
        path.write_text(json.dumps(protocol))
        return path

    def rig(self, sound):
        path = self.folder / "booth.json"
        devices = [{"finger": finger, "command": [VIRTUAL, "--inherited", "--serial", serial, "--finger", finger]}
                   for finger, serial in (("thumb", "T-1"), ("index", "I-1"))]
        path.write_text(json.dumps({"format": 1, "title": "Booth", "devices": devices, "sound": sound}))
        return path

    def run_session(self, *options, code=DONE):
        return self.jnd("run", self.protocol_file, "--study", self.folder / "study.sqlite", "--participant", "P01", "--responder",
                        "chinello2017", "--plain", "--seed", "7", *options, code=code)

    def test_a_session_with_cues_and_masking_noise(self):
        self.player()
        self.protocol_file = self.protocol()
        said = self.run_session("--rig", self.rig({"masking": {"noise": "pink", "level_db": -35}}))
        self.assertIn("Done. The session", said)
        self.assertNotIn("\a", said)
        notes = [line.split() for line in self.record.read_text().splitlines()]
        sums = {name: {total for one, total in notes if one == name} for name in ("cue.wav", "noise.wav")}
        self.assertEqual([len(totals) for totals in sums.values()], [1, 1], notes)
        questions = said.count("Same or different?")
        firsts = said.count("First sphere.")
        self.assertEqual(questions, 4)
        count = [name for name, _ in notes].count
        self.assertEqual(count("cue.wav"), questions + firsts + said.count("Second sphere."))
        self.assertEqual(count("noise.wav"), firsts)
        self.assertEqual(list(self.folder.glob("jnd-sound-*")), [])

    def test_a_metronome_sets_the_pace_in_every_interval_alike(self):
        self.protocol_file = self.protocol(prescription={"say": "Once with every beat.", "pace_hz": 2})
        self.assertIn("prescribes a pace", self.run_session("--bell", "--rig", self.rig({}), code=USAGE))
        self.player()
        said = self.run_session("--rig", self.rig({}))
        notes = [line.split() for line in self.record.read_text().splitlines() if line.startswith("metronome")]
        self.assertEqual(len(set(total for _, total in notes)), 1, notes)
        self.assertEqual(len(notes), said.count("First sphere.") + said.count("Second sphere."))
        self.assertEqual(said.count("Say: Once with every beat."), 1, said)

    def test_the_bell_rings_where_nothing_can_play_or_is_to(self):
        self.protocol_file = self.protocol()
        self.player()
        said = self.run_session("--bell", "--rig", self.rig({"cue_level_db": -30}))
        self.assertGreaterEqual(said.count("\a"), 12)
        self.assertFalse(self.record.exists())

    def test_masking_noise_that_cannot_be_played_is_refused_before_a_study_is_made(self):
        self.protocol_file = self.protocol()
        if any(os.access(f"{place}/{name}", os.X_OK) for place in ("/usr/bin", "/bin") for name in ("pw-play", "paplay", "aplay")):
            for name in ("pw-play", "paplay", "aplay"):
                path = self.folder / "bin" / name
                path.write_text("#!/bin/sh\nexit 1\n")
                path.chmod(0o755)
        rig = self.rig({"masking": {"noise": "white"}})
        self.assertIn("masking noise is asked for, and nothing can play it", self.run_session("--rig", rig, code=DEVICE))
        self.assertIn("leave one of them out", self.run_session("--rig", rig, "--bell", code=USAGE))
        self.assertFalse((self.folder / "study.sqlite").exists())

    def test_what_a_rig_file_may_not_ask_for(self):
        self.player()
        self.protocol_file = self.protocol()
        (self.folder / "text.wav").write_text("no sound")
        for sound, message in (({"masking": {"noise": "pink", "level_db": 3}}, "$.sound.masking.level_db"),
                               ({"masking": {}}, "$.sound.masking.noise"), ({"masking": {"noise": "pink", "level_db": -6}}, "would be clipped"),
                               ({"cue": "text.wav"}, "text.wav: is no WAV file"), ({"cue": "none.wav"}, "none.wav"),
                               ({"masking": {"noise": "text.wav"}}, "text.wav: is no WAV file"), ({"volume": 3}, "$.sound.volume")):
            self.assertIn(message, self.run_session("--rig", self.rig(sound), code=INPUT))

    def test_doctor_says_what_plays(self):
        self.player("aplay")
        # A machine that runs tests may be late, which is a fault of its own.
        found = {one["name"]: one for one in json.loads(self.jnd("doctor", "--seconds", "0.1", "--json", code=(DONE, LATE)))["checks"]}
        self.assertEqual((found["sound"]["verdict"], found["sound"]["found"]), ("ok", "aplay plays"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
