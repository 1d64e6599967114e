#!/usr/bin/env -S python3 -S -E
"""Stands in for jnd where the tests of jnd cluster need a program whose shards take as long, and fail as often, as they want:

    plan PROTOCOL --power [OPTIONS] [--shard I/K --to FILE]
    combine FILES... [--json]

The result follows from the bytes of the protocol and the options, and is the same however it is cut. FILE.part holds what is
done of a shard so far. SHARD_STEP_S: how long each of its steps takes."""
import hashlib
import json
import os
import sys
import time

STEPS = 24


def fail(code, text):
    print(f"shard_program: {text}", file=sys.stderr)
    sys.exit(code)


def steps_of(shard, of):
    return [step for step in range(STEPS) if step % of == shard - 1]


def value(key, step):
    return int.from_bytes(hashlib.sha256(f"{key} {step}".encode()).digest()[:4], "big")


def result(key, values):
    return {"study": key, "power": sum(values) / len(values)}


def plan(arguments):
    protocol, options = arguments[0], list(arguments[1:])
    if "--wrong" in options:
        fail(2, "plan has no option --wrong")
    if "--threads" in options:
        at = options.index("--threads")
        del options[at:at + 2]
    shard = target = None
    if "--shard" in options:
        at = options.index("--shard")
        shard, of = map(int, options[at + 1].split("/"))
        del options[at:at + 2]
        at = options.index("--to")
        target = options[at + 1]
        del options[at:at + 2]
    key = hashlib.sha256(open(protocol, "rb").read() + repr(options).encode()).hexdigest()[:16]
    if shard is None:
        return print(json.dumps(result(key, [value(key, step) for step in range(STEPS)])))
    if os.path.exists(target):
        return print(f"{target}: is there already")
    done = json.load(open(target + ".part")) if os.path.exists(target + ".part") else []
    for step in steps_of(shard, of)[len(done):]:
        time.sleep(float(os.environ.get("SHARD_STEP_S", "0")))
        done.append(value(key, step))
        try:
            with open(target + ".new", "w") as file:
                json.dump(done, file)
            os.rename(target + ".new", target + ".part")
        except OSError as error:
            fail(5, f"{target}: cannot be written: {error.strerror}")
    try:
        with open(target + ".new", "w") as file:
            json.dump({"key": key, "shard": shard, "of": of, "values": done}, file)
        os.rename(target + ".new", target)
        os.remove(target + ".part")
    except OSError as error:
        fail(5, f"{target}: cannot be written: {error.strerror}")
    print(f"{target}: written")


def combine(arguments):
    files = [name for name in arguments if not name.startswith("--")]
    shards = {}
    for name in files:
        if not os.path.exists(name):
            fail(3, f"{name}: there is no such shard")
        shard = json.load(open(name))
        shards[shard["shard"]] = shard
    if len(shards) != len(files) or len({shard["key"] for shard in shards.values()}) != 1:
        fail(3, "these shards do not belong together")
    values = {}
    for shard in shards.values():
        values.update(zip(steps_of(shard["shard"], shard["of"]), shard["values"]))
    print(json.dumps(result(shard["key"], [values[step] for step in sorted(values)])))


if __name__ == "__main__":
    {"plan": plan, "combine": combine}[sys.argv[1]](sys.argv[2:])
