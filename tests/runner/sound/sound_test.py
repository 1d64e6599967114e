#!/usr/bin/env python3
"""The sounds of a whole session from outside: cues and masking noise through a player that notes what it is given, the bell where
there is none, what `jnd doctor` says, and what a rig file may ask for."""
import json
import os
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

# PACED: the program with a simulated rig that is never held up, however busy the machine is.
VIRTUAL, PACED = program.argument(), program.argument()
TRIALS = 2 * min(10, program.campaign(1))
PLAYER = """#!/bin/sh
for file in "$@"; do :; done
case "$file" in *silence*) exit 0;; esac
echo "${{file##*/}} $(cksum < "$file")" >> "{record}"
case "$file" in *noise*|*metronome*) exec tail -f /dev/null;; esac
"""


class Sound(program.Case):
    def setUp(self):
        (self.folder / "bin").mkdir()
        self.record = self.folder / "record"

    def player(self, name="pw-play"):
        path = self.folder / "bin" / name
        path.write_text(PLAYER.format(record=self.record))
        path.chmod(0o755)

    def jnd(self, *arguments, keys="", **options):
        environment = {"PATH": f"{self.folder / 'bin'}:/usr/bin:/bin", "NO_COLOR": "1", "TMPDIR": str(self.folder), "JND_TEST_RIG": "paced"}
        return super().jnd(*arguments, input=keys, env=environment, **options).said

    def protocol(self, explore_s=0.5, **trial):
        """TRIALS of one condition."""
        (self.folder / "study.json").unlink(missing_ok=True)
        self.jnd("new", "study.json", "--from", "tutorial")
        protocol = json.loads(self.read("study.json"))
        for key in ("practice", "breaks", "translations", "questions", "checklist", "consent", "assumed", "resume", "published"):
            protocol.pop(key, None)
        protocol["conditions"] = protocol["conditions"][:1]
        protocol["analysis"].pop("contrasts")
        protocol["design"].update(trials_per_cell=TRIALS, sampling="random")
        protocol["design"].pop("run_limit")
        protocol["instructions"] = []
        protocol["trial"].update(explore_s=explore_s, gap_s=0.1, between_trials_s=0.1, max_attempts=10, **trial)
        return self.write("study.json", protocol)

    def rig(self, sound):
        devices = [{"finger": finger, "command": program.at_priority(60, VIRTUAL, "--inherited", "--serial", serial, "--finger", finger)}
                   for finger, serial in (("thumb", "T-1"), ("index", "I-1"))]
        return self.write("booth.json", {"format": 1, "title": "Booth", "devices": devices, "sound": sound})

    def run_session(self, *options, code=0, **how):
        return self.jnd("run", self.protocol_file, "--study", self.folder / "study.sqlite", "--participant", "P01", "--plain",
                        "--seed", "7", *options, code=code, **how)

    def paced_session(self, *options):
        """On a rig that is never held up, with an operator who answers."""
        return self.run_session("--realtime", "off", *options, program=PACED, keys=" s" * TRIALS)

    def until_noted(self, run, is_noted):
        """run(explore_s) -> said, until no trial was given up and the players had the time to note what they play: a machine that is
        busy may let neither be."""
        seen = {"explore_s": 0.5}

        def is_done():
            self.record.unlink(missing_ok=True)
            for file in self.folder.glob("study.sqlite*"):
                file.unlink()
            said = seen["said"] = run(seen["explore_s"])
            notes = seen["notes"] = [line.split() for line in self.record.read_text().splitlines()] if self.record.exists() else []
            if said.count("Same or different?") != TRIALS:
                return False
            seen["explore_s"] = min(2 * seen["explore_s"], 30)  # where it is to be run again
            return is_noted(said, [name for name, *_ in notes])

        program.until(is_done, f"a session whose sounds are all noted: {seen}")
        return seen["said"], seen["notes"]

    def test_a_session_with_cues_and_masking_noise(self):
        """Through the rig file, on devices. A player may be ended before it notes anything, and trials may come again."""
        self.player()
        rig = self.rig({"masking": {"noise": "pink", "level_db": -35}})

        def run(explore_s):
            self.protocol_file = self.protocol(explore_s)
            return self.run_session("--rig", rig, "--responder", "chinello2017")

        said, notes = self.until_noted(run, lambda _, names: {"cue.wav", "noise.wav"} <= set(names))
        self.assertIn("Done. The session", said)
        self.assertNotIn("\a", said)
        sums = {name: {tuple(total) for one, *total in notes if one == name} for name in ("cue.wav", "noise.wav")}
        self.assertEqual([len(totals) for totals in sums.values()], [1, 1], notes)
        firsts = said.count("First sphere.")
        count = [name for name, *_ in notes].count
        self.assertLessEqual(count("cue.wav"), TRIALS + firsts + said.count("Second sphere."))
        self.assertLessEqual(count("noise.wav"), firsts)
        self.assertEqual(list(self.folder.glob("jnd-sound-*")), [])

    def test_a_metronome_sets_the_pace_in_every_interval_alike(self):
        def run(explore_s):
            self.protocol_file = self.protocol(explore_s, prescription={"say": "Once with every beat.", "pace_hz": 2})
            return self.paced_session()

        def is_noted(said, names):
            intervals = said.count("First sphere.") + said.count("Second sphere.")
            return [names.count("cue.wav"), names.count("metronome-0.wav")] == [intervals + TRIALS, intervals]

        self.player()
        said, notes = self.until_noted(run, is_noted)
        self.assertEqual([said.count("First sphere."), said.count("Second sphere.")], [TRIALS, TRIALS], said)
        self.assertEqual(len({tuple(total) for name, *total in notes if name.startswith("metronome")}), 1, notes)
        self.assertEqual(said.count("Say: Once with every beat."), 1, said)
        self.assertIn("prescribes a pace", self.run_session("--bell", "--responder", "chinello2017", "--rig", self.rig({}), code=program.USAGE))

    def test_the_bell_rings_where_nothing_can_play_or_is_to(self):
        self.protocol_file = self.protocol()
        self.player()
        said = self.paced_session("--bell")
        self.assertEqual(said.count("\a"), 3 * TRIALS)
        self.assertFalse(self.record.exists())

    def test_masking_noise_that_cannot_be_played_is_refused_before_a_study_is_made(self):
        self.protocol_file = self.protocol()
        if any(os.access(f"{place}/{name}", os.X_OK) for place in ("/usr/bin", "/bin") for name in ("pw-play", "paplay", "aplay")):
            for name in ("pw-play", "paplay", "aplay"):
                path = self.folder / "bin" / name
                path.write_text("#!/bin/sh\nexit 1\n")
                path.chmod(0o755)
        rig = self.rig({"masking": {"noise": "white"}})
        self.assertIn("masking noise is asked for, and nothing can play it", self.run_session("--rig", rig, "--responder", "chinello2017", code=program.DEVICE))
        self.assertIn("leave one of them out", self.run_session("--rig", rig, "--bell", "--responder", "chinello2017", code=program.USAGE))
        self.assertFalse((self.folder / "study.sqlite").exists())

    def test_what_a_rig_file_may_not_ask_for(self):
        self.player()
        self.protocol_file = self.protocol()
        self.write("text.wav", "no sound")
        for sound, message in (({"masking": {"noise": "pink", "level_db": 3}}, "$.sound.masking.level_db"),
                               ({"masking": {}}, "$.sound.masking.noise"), ({"masking": {"noise": "pink", "level_db": -6}}, "would be clipped"),
                               ({"cue": "text.wav"}, "text.wav: is no WAV file"), ({"cue": "none.wav"}, "none.wav"),
                               ({"masking": {"noise": "text.wav"}}, "text.wav: is no WAV file"), ({"volume": 3}, "$.sound.volume")):
            self.assertIn(message, self.run_session("--rig", self.rig(sound), "--responder", "chinello2017", code=program.INVALID))

    def test_doctor_says_what_plays(self):
        self.player("aplay")
        # A machine that runs tests may be late, which is a fault of its own.
        found = {one["name"]: one for one in json.loads(self.jnd("doctor", "--seconds", "0.1", "--json", code=(0, program.FOUND)))["checks"]}
        self.assertEqual((found["sound"]["verdict"], found["sound"]["found"]), ("ok", "aplay plays"))


if __name__ == "__main__":
    program.main()
