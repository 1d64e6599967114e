#!/usr/bin/env python3
"""jnd init: questions answered through a pipe; what it writes passes jnd check, wrong answers are asked again, and one that
is left writes nothing."""
import json
import os
import signal
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

TASKS = ("same-different", "which", "yes-no", "identify", "oddity", "abx", "magnitude", "adjust")
RIGS = ("rrs3", "mckibben", "rrs3+mckibben", "external", "specimens")


class Init(program.Case):
    def init(self, lines, *arguments, code=0):
        return self.jnd("init", *arguments, input=lines, code=code)

    def check(self, name):
        return self.jnd("check", name, "--json").json

    def protocol(self, name):
        return json.loads(self.read(name))

    def test_the_defaults_of_every_task_on_every_rig_pass_the_check(self):
        for number, task in enumerate((*TASKS, "explore")):
            for rig in RIGS if task == "which" else (RIGS[number % len(RIGS)],):
                with self.subTest(task=task, rig=rig):
                    name = f"{task}-{rig}.json"
                    lines = [task] if task == "explore" else [task, rig]
                    done = self.init(lines + [""] * 20, name)
                    self.assertTrue(self.check(name)["ok"])
                    self.assertEqual(self.protocol(name)["paradigm"], task)
                    self.assertIn(f"{name}: ok", done.stdout)
                    self.assertIn(f"jnd run {name} --study rehearsal.sqlite", done.stdout)

    def test_every_answer_is_in_the_protocol(self):
        self.init(["study", "which", "external", "constant", "viscosity", "N s/m", "5", "3, 4, 6,7", "16", "bare, gloved", "20",
                   "How tiring was it?", "How hard?", "", "Was it more?", "de", "Zähigkeit"])
        protocol = self.protocol("study.json")
        self.assertEqual(protocol["stimulus"], {"quantity": "viscosity", "unit": "N s/m"})
        self.assertEqual(protocol["standards"][0]["value"], 5)
        self.assertEqual(protocol["levels"], {"absolute": [3, 4, 6, 7]})
        self.assertEqual(protocol["design"]["trials_per_cell"], 16)
        self.assertEqual(protocol["design"]["participants"], 20)
        self.assertEqual([one["name"] for one in protocol["conditions"]], ["bare", "gloved"])
        self.assertEqual([one["text"] for one in protocol["questions"]], ["How tiring was it?", "How hard?"])
        self.assertEqual(protocol["trial"]["cues"]["question"]["say"], "Was it more?")
        self.assertEqual((protocol["language"], protocol["title"]), ("de", "Zähigkeit"))
        self.assertTrue(self.check("study.json")["ok"])

    def test_conditions_of_a_device_are_made_of_its_cues(self):
        done = self.init(["which", "rrs3", "quest", "", "force, vibration, heat", "force, force", "force, vibration, force+vibration"] + [""] * 9,
                         "cues.json")
        self.assertIn("'heat' is not one of them", done.stdout)
        conditions = self.protocol("cues.json")["conditions"]
        self.assertEqual([(one["name"], one["cues"]) for one in conditions],
                         [("F", ["force"]), ("V", ["vibration"]), ("F+V", ["force", "vibration"])])
        self.assertEqual(self.protocol("cues.json")["design"]["procedure"]["kind"], "quest")

    def test_wrong_answers_are_told_and_asked_again(self):
        done = self.init(["wich", "which", "rss3", "rrs3", "constnt", "constant", "much", "0", "600", "300, x", "300, 420, 780, 900",
                          "many", "13", "12", "force", "0", "1.5", "8", "", "", "not a language", "en", "A study"], "asked.json")
        self.says(done.stdout, "did you mean 'which'?", "did you mean 'rrs3'?", "did you mean 'constant'?", "'much' is not a number",
                  "'x' is not a number", "'many' is not a whole number", "needs a multiple of 2", "'0' is not a whole number",
                  "'1.5' is not a whole number")
        self.assertGreaterEqual(done.stdout.count("Standard, in N/m"), 3)
        self.assertGreaterEqual(done.stdout.count("Language of these texts"), 2)
        self.assertEqual(self.protocol("asked.json")["levels"], {"absolute": [300, 420, 780, 900]})
        self.assertTrue(self.check("asked.json")["ok"])

    def test_answers_that_end_too_early_write_nothing(self):
        done = self.init(["which", "rrs3"], "none.json", code=2)
        self.assertIn("nothing was written", done.stderr)
        self.assertEqual(os.listdir(self.folder), [])

    def test_a_file_that_exists_is_never_written_over(self):
        self.write("mine.json", "{}")
        self.assertIn("exists already", self.init([], "mine", code=2).stderr)
        self.assertIn("exists already", self.init(["mine.json", "other.json"] + [""] * 20).stdout)
        self.assertEqual(self.protocol("mine.json"), {})
        self.assertTrue(self.check("other.json")["ok"])
        self.assertIn("there is no folder", self.init([], "no/such.json", code=2).stderr)

    def test_ctrl_c_writes_nothing(self):
        terminal = program.Terminal("init", "gone.json", folder=self.folder)
        terminal.type("\n\n")
        terminal.until("Procedure [")
        terminal.process.send_signal(signal.SIGINT)
        terminal.ends(130)
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    program.main()
