#!/usr/bin/env -S python3 -S -E
"""Slurm as the tests of jnd cluster want it: started as sbatch, squeue or sacct. Its folder is $FAKE_SLURM:

    outcomes.json   {shard: [outcome of its first job, of its second, ...]}; then "run"
    down, refuse    how many calls of squeue, or of sbatch, still fail
    accounting      there: sacct knows how tasks ended
    tasks/JOB_SHARD what squeue says of a task: "STATE|REASON"; removed: it has forgotten it

Outcomes: run (at once), wait (when squeue is asked the second time), stay (it waits for ever), vanish, late (gone from the
queue at once; its file is there when squeue is asked the second time), steps:STATE (as STATE, having put down something), or
a state of Slurm's: the task ends so."""
import json
import os
import sys

ROOT = os.environ["FAKE_SLURM"]


def path(*names):
    return os.path.join(ROOT, *names)


def countdown(name):
    """Whether this call is one of those that are to fail."""
    try:
        left = int(open(path(name)).read())
    except FileNotFoundError:
        return False
    if left > 0:
        open(path(name), "w").write(str(left - 1))
    return left > 0


def say(job, shard, state, reason="None"):
    with open(path("tasks", f"{job}_{shard}"), "w") as file:
        file.write(f"{state}|{reason}")


def run(folder, job, shard):
    import subprocess  # not by every call: each is a start of Python
    log = open(os.path.join(folder, "logs", f"{job}_{shard}.log"), "a")
    variables = dict(os.environ, SLURM_ARRAY_TASK_ID=str(shard), SLURM_SUBMIT_DIR=folder, SLURM_JOB_ID=str(job))
    copy = path("spool.sh")  # as Slurm does
    with open(copy, "w") as file:
        file.write(open(os.path.join(folder, "job.sh")).read())
    code = subprocess.run(["bash", copy], env=variables, cwd=folder, stdout=log, stderr=log).returncode
    say(job, shard, "COMPLETED" if code == 0 else "FAILED")


def later(folder, job, shard, outcome):
    with open(path("later", f"{job}_{shard}"), "w") as file:
        json.dump([folder, job, shard, outcome], file)


def begin(folder, job, shard, outcome):
    if outcome == "run":
        run(folder, job, shard)
    elif outcome == "wait":
        say(job, shard, "PENDING", "Resources")
        later(folder, job, shard, 1)
    elif outcome == "late":
        later(folder, job, shard, 1)
    elif outcome == "stay":
        say(job, shard, "PENDING", "Priority")
    elif outcome == "held":
        say(job, shard, "PENDING", "JobHeldUser")
    elif outcome.startswith("steps:"):
        with open(os.path.join(folder, "shards", f"{shard}.json.part"), "a") as file:
            file.write(" " * 10 if file.tell() else "[]")
        say(job, shard, outcome[6:])
    elif outcome != "vanish":
        say(job, shard, outcome)


def sbatch():
    if countdown("refuse"):
        sys.exit("sbatch: error: Batch job submission failed: Invalid account or account/partition combination specified")
    array = next(word for word in sys.argv if word.startswith("--array=")).removeprefix("--array=").partition("%")[0]
    with open(path("sbatch.log"), "a") as log:
        log.write(" ".join(sys.argv[1:]) + "\n")
    job = 100 + sum(1 for _ in open(path("sbatch.log")))
    try:
        outcomes = json.load(open(path("outcomes.json")))
    except FileNotFoundError:
        outcomes = {}
    for part in array.split(","):
        first, _, last = part.partition("-")
        for shard in range(int(first), int(last or first) + 1):
            listed = outcomes.get(str(shard), [])
            begin(os.getcwd(), job, shard, listed.pop(0) if listed else "run")
    json.dump(outcomes, open(path("outcomes.json"), "w"))
    print(f"{job};here")


def squeue():
    if countdown("down"):
        sys.exit("slurm_load_jobs error: Unable to contact slurm controller (connect failure)")
    for name in sorted(os.listdir(path("tasks"))):
        print("|".join(name.split("_")) + "|" + open(path("tasks", name)).read())
    for name in os.listdir(path("later")):
        folder, job, shard, looks = json.load(open(path("later", name)))
        if looks > 0:
            later(folder, job, shard, looks - 1)
            continue
        os.remove(path("later", name))
        forgotten = not os.path.exists(path("tasks", name))
        run(folder, job, shard)
        if forgotten:
            os.remove(path("tasks", name))


def sacct():
    if not os.path.exists(path("accounting")):
        sys.exit("Slurm accounting storage is disabled")
    jobs = next(word for word in sys.argv if word.startswith("--jobs=")).removeprefix("--jobs=").split(",")
    for job in jobs:
        for shard in range(1, 7):
            place = path("tasks", f"{job}_{shard}")
            state = open(place).read().split("|")[0] if os.path.exists(place) else "NODE_FAIL"
            print(f"{job}_{shard}|{state}|{'5:0' if state == 'FAILED' else '0:0'}")


if __name__ == "__main__":
    {"sbatch": sbatch, "squeue": squeue, "sacct": sacct}[os.path.basename(sys.argv[0])]()
