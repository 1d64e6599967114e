#!/usr/bin/env python3
"""jnd cluster without a scheduler: its folder and scripts, what it refuses, and how it follows jobs on a Slurm that is played
(fake_slurm.py) with shards of a program that is played too (shard_program.py)."""
import json
import os
import shutil
import signal
import subprocess
import sys

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.path.join(HERE, "shard_program.py")


class Cluster(program.Case):
    def setUp(self):
        self.slurm = self.folder / "slurm"
        for name in ("bin", "tasks", "later"):
            os.makedirs(os.path.join(self.slurm, name))
        for name in ("sbatch", "squeue", "sacct"):
            os.symlink(os.path.join(HERE, "fake_slurm.py"), os.path.join(self.slurm, "bin", name))
        self.environment = {"FAKE_SLURM": str(self.slurm), "PATH": f"{self.slurm}/bin:{os.environ['PATH']}"}
        self.write("study.json", '{"title": "a study"}')

    def outcomes(self, **listed):
        self.write("slurm/outcomes.json", json.dumps({name.lstrip("_"): list(one) for name, one in listed.items()}))

    def cluster(self, *arguments, code=0, plan=("plan", "study.json", "--power"), **variables):
        played = ("--program", PROGRAM, "--", *plan) if plan else ()
        return self.jnd("cluster", *arguments, *played, code=code, env=self.environment | variables)

    def follow(self, *arguments, code=0, shards=4, **more):
        return self.cluster("run", "--shards", str(shards), "--submit", "--follow", "--every", "0.05", *arguments, code=code, **more)

    def whole(self, *plan):
        return self.jnd(*(plan or ("plan", "study.json", "--power")), program=PROGRAM).stdout

    def script(self, *words, code=0, folder="run", **variables):
        return program.run(*words[1:], program=f"./{words[0]}", folder=self.folder / folder, code=code, env=self.environment | variables)

    def submissions(self):
        return self.read("slurm", "sbatch.log").splitlines()

    # The folder and its scripts.

    def test_the_folder_runs_without_a_scheduler_and_wherever_it_is(self):
        out = self.cluster("run", "--shards", "4").stdout
        self.assertIn("0 of 4 shards there", out)
        for name in ("job.sh", "loop.sh"):
            program.run("-n", self.folder / "run" / name, program="bash")
            self.assertTrue(os.access(self.folder / "run" / name, os.X_OK))
            if shutil.which("shellcheck"):
                program.run(self.folder / "run" / name, program="shellcheck")
        self.script("job.sh", "2")
        self.assertEqual(os.listdir(self.folder / "run" / "shards"), ["2.json"])
        os.rename(self.folder / "run", self.folder / "moved it")
        os.remove(self.folder / "study.json")
        result = self.script("loop.sh", "2", folder="moved it").stdout
        self.write("study.json", '{"title": "a study"}')
        self.assertEqual(result, self.whole())
        self.assertEqual(self.script("job.sh", "combine", "--json", folder="moved it").stdout, self.whole())
        self.assertIn("4 of 4 shards there", self.cluster("moved it", plan=None).stdout)
        self.script("job.sh", "5", code=2, folder="moved it")
        self.script("job.sh", code=2, folder="moved it")

    def test_the_loop_says_which_shard_failed_and_goes_on(self):
        self.cluster("run", "--shards", "3")
        os.makedirs(self.folder / "run" / "shards" / "2.json.new")
        done = self.script("loop.sh", code=1)
        self.assertIn("shard 2 failed", done.stderr)
        self.assertIn("cannot be written", done.stderr)
        os.rmdir(self.folder / "run" / "shards" / "2.json.new")
        self.assertEqual(self.script("loop.sh").stdout, self.whole())

    def test_simulated_studies_come_to_tables(self):
        words = ["simulate", "tutorial", "--participants", "2", "--studies", "3"]
        self.jnd(*words, "--csv", "whole")
        self.jnd("cluster", "run", "--shards", "2", "--", *words)
        if shutil.which("shellcheck"):
            program.run(self.folder / "run" / "job.sh", program="shellcheck")
        self.assertIn("3 studies of 2 participants", self.script("loop.sh").stdout)
        self.script("loop.sh")  # again: the tables are replaced
        self.script("job.sh", "combine", "--csv", "../elsewhere")
        for made in ("run/tables", "elsewhere"):
            self.jnd("-r", "whole", made, program="diff")
        self.assertIn("plan --power", self.cluster("run", "--follow", "--json", plan=None, code=2).stderr)

    def test_with_gnu_parallel(self):
        if shutil.which("parallel") is None:
            self.skipTest("GNU parallel is not installed")
        self.cluster("run", "--shards", "4")
        program.run("-c", "seq 4 | parallel ./job.sh", program="sh", folder=self.folder / "run")
        self.assertEqual(self.script("job.sh", "combine").stdout, self.whole())

    def test_names_are_words_and_never_commands(self):
        odd = "it's \"a\" $(touch pwned) `touch pwned`; touch pwned & \\ %a.json"
        self.write(odd, "{}")
        plan = ("plan", odd, "--power", "--note", "a'b $HOME \"c\"", "--empty", "", "--lines", "a\nb")
        self.cluster("an 'odd' $(touch pwned) name", "--shards", "2", "--submit", "--follow", "--every", "0.05", plan=plan)
        folder = "an 'odd' $(touch pwned) name"
        self.assertEqual(self.script("loop.sh", folder=folder).stdout, self.whole(*plan))
        self.assertEqual([found for found in os.walk(self.folder) if "pwned" in found[2]], [])
        for option in ("--partition=a b", "--account=a\n#SBATCH --uid=0", "--time='1'", "--sbatch=--qos=a b", "--sbatch=qos",
                       "--sbatch=--output=x", "--memory=1G;x"):
            self.assertIn("jnd: ", self.cluster("other", "--shards", "2", option, code=2).stderr)
        self.assertFalse(os.path.exists(self.folder / "other"))

    def test_files_that_the_plan_names_come_along(self):
        os.makedirs(self.folder / "rigs")
        self.write("rigs/mine.json", "{}")
        self.write("profile.json", "{}")
        self.write("study.json", '{"rig": {"device": "rigs/mine.json"}, "title": "title.json"}')
        self.cluster("run", "--shards", "2", plan=("plan", "study.json", "--power", "--profile=profile.json"))
        for name in ("rigs/mine.json", "profile.json", "protocol/study.json"):
            self.assertTrue((self.folder / "run" / name).exists(), name)
        self.write("job.json", "{}")
        os.makedirs(self.folder / "shards")
        self.write("shards/a.json", "{}")
        self.assertIn("of its own", self.cluster("b", "--shards", "2", code=2,
                                                 plan=("plan", "study.json", "--power", "--profile", "shards/a.json")).stderr)

    def test_settings_and_setup_stand_in_the_script_and_may_change(self):
        self.cluster("run", "--shards", "4", "--partition", "short", "--time", "01:00:00", "--account", "lab", "--memory", "2G",
                     "--at-once", "2", "--sbatch=--qos=long", "--setup", "export WORD='a b'", "--setup", "test \"$WORD\" = 'a b' || exit 9")
        text = self.read("run", "job.sh")
        for line in ("--partition=short", "--time=01:00:00", "--account=lab", "--mem=2G", "--array=1-4%2", "--qos=long"):
            self.assertIn(f"#SBATCH {line}\n", text)
        name = next(line for line in text.splitlines() if "--job-name" in line)
        self.script("job.sh", "1")
        self.cluster("run", "--time", "04:00:00", plan=None)
        changed = self.read("run", "job.sh")
        self.assertEqual(changed, text.replace("01:00:00", "04:00:00"))
        self.assertIn(name, changed)
        self.write("run/job.sh", changed + "# mine\n")
        self.assertIn("changed by hand", self.cluster("run", "--time", "05:00:00", plan=None, code=2).stderr)
        self.cluster("run", plan=None)
        self.assertIn("# mine", self.read("run", "job.sh"))
        os.remove(self.folder / "run" / "job.sh")
        self.cluster("run", plan=None)
        self.assertEqual(self.read("run", "job.sh"), changed)

    # What it refuses.

    def test_a_folder_of_something_else_is_refused(self):
        self.assertIn("no campaign is there", self.cluster("run", plan=None, code=2).stderr)
        os.makedirs(self.folder / "other")
        self.cluster("other", "--shards", "2")  # an empty one is taken
        os.makedirs(self.folder / "full")
        self.write("full/notes.txt", "")
        self.assertIn("something else", self.cluster("full", "--shards", "2", code=2).stderr)
        self.assertIn("not a folder", self.cluster("study.json", "--shards", "2", code=2).stderr)

    def test_a_folder_of_another_campaign_is_refused_and_of_the_same_goes_on(self):
        self.cluster("run", "--shards", "4")
        script = self.read("run", "job.sh")
        self.cluster("run", "--shards", "4")
        self.cluster("run")
        self.assertEqual(self.read("run", "job.sh"), script)
        self.assertIn("4 shards, not 5", self.cluster("run", "--shards", "5", code=2).stderr)
        self.assertIn("cannot be changed", self.cluster("run", "--shards", "5", code=2, plan=None).stderr)
        self.assertIn("--other", self.cluster("run", code=2, plan=("plan", "study.json", "--power", "--other")).stderr)
        self.write("study.json", '{"title": "another study"}')
        self.assertIn("protocol is another one", self.cluster("run", code=2).stderr)
        self.write("run/protocol/study.json", '{"title": "another study"}')
        self.assertIn("changed since", self.cluster("run", code=3, plan=None).stderr)

    def test_a_campaign_that_was_edited_does_not_go_on(self):
        self.cluster("run", "--shards", "2")
        made = json.loads(self.read("run", "campaign.json"))
        for part in ({"files": {}}, {"files": {"study.json": "0" * 64}}, {"files": {"protocol/../../study.json": "0" * 64}}, {"files": {"protocol/x": None}},
                     {"name": "x\ntouch pwned"}, {"command": "; touch pwned"}, {"arguments": [None]}):
            self.write("run/campaign.json", made | part)
            self.assertIn("damaged", self.cluster("run", "--time", "01:00:00", plan=None, code=3).stderr)
        self.write("run/campaign.json", made | {"settings": made["settings"] | {"time": "1\ntouch pwned"}})
        self.cluster("run", plan=None, code=2)
        self.write("run/campaign.json", made)
        self.write("run/protocol/study.json", '{"title": "a study" }')
        for shard in ("1", "combine"):
            self.assertIn("was changed since", self.script("job.sh", shard, code=3).stderr)
        self.assertIn("logs/loop_1.log ends with:", self.script("loop.sh", code=1).stderr)
        self.write("run/protocol/study.json", '{"title": "a study"}')
        self.assertEqual(self.script("loop.sh").stdout, self.whole())

    def test_mistakes_in_the_plan_are_said_at_once(self):
        for plan in (("plan", "study.json"), ("simulate", "study.json", "--power"), ("plan", "--power", "study.json"),
                     ("plan", "study.json", "--power", "--to", "x"), ("plan", "study.json", "--power", "--shard=1/2"),
                     ("plan", "study.json", "--power", "--json")):
            self.cluster("run", "--shards", "2", code=2, plan=plan)
        self.cluster("run", code=2)  # no --shards
        self.cluster("run", "--shards", "1001", code=2)
        self.assertIn("no option --wrong",
                      self.cluster("run", "--shards", "2", code=2, plan=("plan", "study.json", "--power", "--wrong")).stderr)
        self.cluster("run", "--shards", "2", code=3, plan=("plan", "none.json", "--power"))
        self.assertFalse(os.path.exists(self.folder / "run"))

    def test_without_slurm_it_says_what_to_do(self):
        done = self.cluster("run", "--shards", "2", "--submit", code=2, PATH="/usr/bin:/bin" if not shutil.which("sbatch", path="/usr/bin:/bin") else "/nowhere")
        self.assertIn("sbatch is not found", done.stderr)
        self.assertIn("loop.sh", done.stderr)
        self.assertEqual(self.script("loop.sh").stdout, self.whole())

    # Following.

    def test_it_submits_follows_and_prints_the_result_alone(self):
        self.outcomes(_2=["wait"])
        done = self.follow("--json")
        self.assertEqual(done.stdout, self.whole())
        self.assertIn("job 101, shards 1-4", done.stderr)
        self.assertIn("waiting (Resources)", done.stderr)
        self.assertIn("4 of 4 shards there", done.stderr)
        self.assertEqual(self.submissions(), ["--parsable --array=1-4 job.sh"])
        again = self.follow()
        self.assertEqual(again.stdout, self.whole())
        self.assertIn("nothing to submit", again.stderr)

    def test_what_is_lost_is_submitted_again_with_the_reason(self):
        self.outcomes(_1=["TIMEOUT"], _2=["NODE_FAIL", "OUT_OF_MEMORY"], _3=["vanish"], _5=["COMPLETED"], _6=["CANCELLED"])
        done = self.follow(shards=6)
        self.assertEqual(done.stdout, self.whole())
        self.says(done.stderr, "shard 1: TIMEOUT; again", "shard 2: NODE_FAIL; again", "shard 2: OUT_OF_MEMORY; again (try 3)",
                  "shard 3: gone from the queue", "shard 5: COMPLETED, but its file is not there", "shard 6: CANCELLED; again")
        self.assertEqual(self.submissions()[1:], ["--parsable --array=1-3,5-6 job.sh", "--parsable --array=2 job.sh"])

    def test_accounting_says_more_where_there_is_one(self):
        self.write("slurm/accounting", "")
        self.outcomes(_1=["FAILED"], _2=["vanish"])
        done = self.follow()
        self.assertIn("shard 1: FAILED, exit code 5; again", done.stderr)
        self.assertIn("shard 2: NODE_FAIL; again", done.stderr)

    def test_a_shard_that_fails_again_and_again_is_given_up_with_its_last_words(self):
        self.cluster("run", "--shards", "4")
        os.makedirs(self.folder / "run" / "shards" / "3.json.new")
        done = self.follow("--retries", "2", code=1)
        self.assertEqual(done.stdout, "")
        self.assertIn("shard 3: FAILED; given up (try 3)", done.stderr)
        self.assertIn("_3.log ends with:", done.stderr)
        self.assertIn("shards/3.json: cannot be written: Is a directory", done.stderr)
        self.assertIn("given up: shard 3;", done.stderr)
        self.assertEqual(len(self.submissions()), 3)
        os.rmdir(self.folder / "run" / "shards" / "3.json.new")
        self.assertEqual(self.follow().stdout, self.whole())

    def test_a_try_that_gets_on_is_not_counted(self):
        self.outcomes(_1=["steps:TIMEOUT"] * 6, _2=["TIMEOUT"] * 2)
        done = self.follow("--retries", "1", code=1)
        self.assertIn("given up: shard 2;", done.stderr)
        self.assertEqual(done.stderr.count("shard 1: TIMEOUT; again\n") + done.stderr.count("shards 1-2: TIMEOUT; again\n"), 6)

    def test_a_file_that_comes_late_is_waited_for(self):
        self.outcomes(_1=["late"])
        self.assertEqual(self.follow().stdout, self.whole())
        self.assertEqual(len(self.submissions()), 1)

    def test_a_scheduler_that_does_not_answer_is_asked_again(self):
        self.outcomes(_1=["wait"])
        self.cluster("run", "--shards", "4", "--submit")
        self.write("slurm/down", "6")
        done = self.cluster("run", "--follow", "--every", "0.05", plan=None)
        self.assertEqual(done.stdout, self.whole())
        self.assertEqual(done.stderr.count("Unable to contact slurm controller"), 1)
        self.assertEqual(len(self.submissions()), 1)
        self.write("slurm/down", "1")
        os.remove(self.folder / "run" / "shards" / "2.json")
        self.assertIn("nothing was submitted", self.cluster("run", "--submit", plan=None, code=1).stderr)

    def test_refusals_of_sbatch(self):
        self.write("slurm/refuse", "1")
        self.assertIn("Invalid account", self.follow(code=1).stderr)
        self.outcomes(_1=["TIMEOUT"], _2=["TIMEOUT"])
        self.cluster("run", "--submit", plan=None)
        self.write("slurm/refuse", "2")
        done = self.cluster("run", "--follow", "--every", "0.05", plan=None)
        self.assertEqual(done.stdout, self.whole())
        self.assertEqual(done.stderr.count("does not take shards 1-2 again"), 1)
        os.remove(self.folder / "run" / "shards" / "2.json")
        self.write("slurm/refuse", "1000")
        self.assertIn("given up: shard 2;", self.cluster("run", "--follow", "--every", "0.05", plan=None, code=1).stderr)

    def test_a_scheduler_that_prints_without_end_is_left(self):
        self.cluster("run", "--shards", "4")
        os.remove(self.slurm / "bin" / "sbatch")
        self.write("slurm/bin/sbatch", "#!/bin/sh\nexec yes 1\n")
        os.chmod(self.slurm / "bin" / "sbatch", 0o755)
        self.assertIn("it printed more than 64 MB", self.cluster("run", "--submit", plan=None, code=1).stderr)

    def test_following_alone_submits_nothing_for_the_first_time(self):
        self.cluster("run", "--shards", "4")
        self.assertIn("never submitted: shards 1-4", self.cluster("run", "--follow", "--every", "0.05", plan=None, code=1).stderr)

    def test_what_waits_in_the_queue_is_not_submitted_twice(self):
        self.outcomes(_1=["stay"], _2=["TIMEOUT"])
        self.cluster("run", "--shards", "4", "--submit")
        self.cluster("run", "--submit", plan=None)
        self.assertEqual(self.submissions()[1:], ["--parsable --array=2 job.sh"])

    def test_who_waits_for_a_person_is_said(self):
        self.outcomes(_1=["held"])
        self.cluster("run", "--shards", "2", "--submit")
        process = self.background("run", "--follow", "--every", "0.05")
        self.wait_for(process, "scontrol release 101_1")
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(program.GUARD_S), 130)

    def background(self, *arguments):
        return self.started("cluster", *arguments, stdout=subprocess.DEVNULL, env=self.environment)

    def wait_for(self, process, words):
        text = ""
        for line in process.stderr:
            text += line
            if words in line:
                return text
        self.fail(f"{words!r} never came: {text}")

    def test_interrupted_it_leaves_the_jobs_and_follows_them_again(self):
        self.outcomes(_1=["stay"])
        self.cluster("run", "--shards", "4", "--submit")
        process = self.background("run", "--follow", "--every", "0.05")
        self.wait_for(process, "3 of 4 shards there, 1 waiting (Priority)")
        self.assertIn("another jnd cluster", self.cluster("run", "--follow", plan=None, code=2).stderr)
        process.send_signal(signal.SIGINT)
        self.assertIn("the jobs go on", process.stderr.read())
        self.assertEqual(process.wait(program.GUARD_S), 130)
        process = self.background("run", "--follow", "--every", "0.05")
        self.wait_for(process, "1 waiting")
        self.script("job.sh", "1")
        self.assertEqual(process.wait(program.GUARD_S), 0)
        self.assertEqual(len(self.submissions()), 1)


if __name__ == "__main__":
    program.main()
