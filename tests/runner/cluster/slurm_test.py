#!/usr/bin/env python3
"""jnd cluster on a real Slurm of this machine alone (real_slurm.py): tasks that are killed, a node that goes down, a controller
that is started again and a full disk change nothing in the result. SKIPPED (77) where Slurm cannot be started."""
import os
import random
import signal
import subprocess
import sys
import tempfile

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program
import real_slurm

PROGRAM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "shard_program.py")
SHARDS = 8
PLAYED = ["plan", "a study.json", "--power"]  # by PROGRAM, whose shards take as long as the test wants
POWER = ["plan", "a study.json", "--power", "--studies", "64"]  # by jnd itself
KILLS = program.campaign(4)
LONGER = ["plan", "a study.json", "--power", "--studies", str(16 * KILLS), "--physics", "--analysis", "registered"]
APART = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc"]


class OnSlurm(program.Case):
    def setUp(self):
        # A Slurm of its own for each test: none meets what another left.
        (self.folder / "slurm").mkdir()
        self.slurm = real_slurm.RealSlurm(self.folder / "slurm")
        self.addCleanup(self.slurm.stop)
        self.jnd("new", "a study.json", "--from", "tutorial")

    def whole(self, plan=PLAYED):
        """What the study comes to without a cluster."""
        return self.jnd(*plan, program=PROGRAM if plan is PLAYED else None).stdout

    def start(self, *arguments, plan=PLAYED, step=0.05):
        """jnd cluster, which goes on by itself."""
        with open(self.folder / "told", "w") as told:
            return self.started("cluster", "run", "--shards", SHARDS, "--every", "0.2", "--program", PROGRAM if plan is PLAYED else program.JND,
                                *arguments, "--", *plan, stderr=told, env=self.slurm.environment | {"SHARD_STEP_S": str(step)})

    def told(self):
        return self.read("told")

    def ends_with(self, process, code=0, meanwhile=lambda: None):
        """Its output. A pipe holds it all."""
        self.until(lambda: meanwhile() or process.poll() is not None)
        out = process.communicate()[0]
        self.assertEqual(process.returncode, code, self.told())
        return out

    def until(self, reached, process=None):
        try:
            program.until(reached, process=process)
        except AssertionError:
            self.fail(f"it does not come: {self.told()}\n{self.slurm.account()}")

    def kill_program(self, shard):
        """Of a task of this test's campaign."""
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/cmdline") as line:
                    words = line.read().split("\0")
                if f"{shard}/{SHARDS}" in words and os.readlink(f"/proc/{pid}/cwd").startswith(str(self.folder)):
                    os.kill(int(pid), signal.SIGKILL)
            except OSError:  # it has ended meanwhile
                pass

    def test_an_array_runs_and_is_combined(self):
        self.assertEqual(self.ends_with(self.start("--submit", "--follow", plan=POWER)), self.whole(POWER))

    def test_tasks_that_are_killed_run_again(self):
        chance = random.Random(1)
        process = self.start("--submit", "--follow", "--retries", str(20 + KILLS), plan=LONGER)
        killed = []
        while len(killed) < KILLS:
            self.until(lambda: self.slurm.tasks("running"), process)
            running = self.slurm.tasks("running")
            if not running:  # it has ended meanwhile
                continue
            task = chance.choice(running)
            if len(killed) % 2 == 0:
                self.slurm.run("scancel", task, check=False)
            else:
                self.kill_program(task.split("_")[1])
            killed.append(task)
            self.until(lambda: task not in self.slurm.tasks("running"), process)
        self.assertEqual(self.ends_with(process), self.whole(LONGER))
        self.assertIn("; again", self.told())

    def test_a_node_that_goes_down_and_shards_that_are_submitted_again(self):
        self.node_goes_down(lambda told: "NODE_FAIL; again" in told, "--sbatch=--no-requeue")

    def test_a_node_that_goes_down_and_shards_that_wait_for_another(self):
        # Why they wait is Slurm's word: that the node is down, or that they begin later.
        self.node_goes_down(lambda told: "waiting" in told.splitlines()[-1] and "running" not in told.splitlines()[-1])

    def node_goes_down(self, seen, *options):
        process = self.start(*options, "--submit", "--follow", step=0.3)
        self.until(lambda: "running" in self.told(), process)
        self.slurm.node_down()
        self.until(lambda: seen(self.told()), process)
        self.slurm.node_up()
        self.assertEqual(self.ends_with(process, meanwhile=self.slurm.hurry), self.whole())

    def test_submitted_by_hand_followed_left_and_followed_again(self):
        self.assertIn("0 of 8", self.ends_with(self.start()))
        self.slurm.environment["SHARD_STEP_S"] = "0.3"
        self.addCleanup(self.slurm.environment.pop, "SHARD_STEP_S")
        program.run("job.sh", program="sbatch", folder=self.folder / "run", env=self.slurm.environment)
        process = self.start("--follow")
        self.until(lambda: "running" in self.told(), process)
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.ends_with(process, 130), "")
        self.assertTrue(self.slurm.tasks("running"))
        process = self.start("--follow")
        self.until(lambda: "running" in self.told(), process)
        self.slurm.end_controller()
        self.until(lambda: "squeue does not answer" in self.told(), process)
        self.slurm.start_controller()
        self.assertEqual(self.ends_with(process), self.whole())
        self.assertNotIn("again", self.told())

    def test_a_full_disk(self):
        shards = self.folder / "run" / "shards"
        self.ends_with(self.start(plan=POWER))
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", shards], capture_output=True, text=True)
        if mounted.returncode != 0:
            self.skipTest(f"no full disk, because mount is not permitted here: {mounted.stderr.strip()}")
        self.addCleanup(subprocess.run, ["umount", "--lazy", shards])
        self.assertEqual(self.ends_with(self.start("--submit", "--follow", "--retries", "1", plan=POWER), 1), "")
        self.assertIn("the disk is full", self.told())
        self.assertIn("given up: shard", self.told())
        subprocess.run(["mount", "-o", "remount,size=1m", shards], check=True)
        self.assertEqual(self.ends_with(self.start("--submit", "--follow", plan=POWER)), self.whole(POWER))


def main():
    if "JND_SLURM_APART" not in os.environ:
        # Processes and mounts of their own: whatever happens, nothing of it is left. Without the right to that, as it is.
        if subprocess.run([*APART, "true"], capture_output=True).returncode == 0:
            os.environ["JND_SLURM_APART"] = "1"
            os.execvp(APART[0], [*APART, sys.executable, os.path.abspath(__file__), program.JND, *sys.argv[1:]])
    with tempfile.TemporaryDirectory() as folder:
        try:
            real_slurm.RealSlurm(folder).stop()
        except real_slurm.SlurmUnavailable as why:
            print(f"SKIPPED: jnd cluster does not meet a real Slurm: {why}")
            sys.exit(77)
    program.main()


if __name__ == "__main__":
    main()
