#!/usr/bin/env python3
"""Lateness of the control loop beside cyclictest's, in interleaved pairs: same priority, processor and interval.

Usage: lateness.py LATENESS_BENCH [--pairs 10] [--seconds 5] [--json]

cyclictest is in the Debian package rt-tests. Pairs alternate which of the two comes first, so that a machine that
grows busier or quieter favours neither. Prints medians over the pairs of p50 and p99, their ratio, and the median of
the pairs' own ratios. It asserts nothing; the aim is a ratio of at most 1.25. Exits with 3 where the machine cannot
run the comparison: without cyclictest, or without SCHED_FIFO for both.
"""
import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

PRIORITY = 50  # kRealtimePriority of devices/realtime.h
HISTOGRAM_NS = 1_000_000  # the largest that cyclictest counts; what is later is among its overflows


def percentile_us(counts, total, share):
    """The least lateness that at least `share` of the wake-ups did not exceed; inf beyond the histogram."""
    seen = 0
    for late_ns, count in counts:
        seen += count
        if seen >= share * total:
            return late_ns / 1000
    return float("inf")


def run_cyclictest(seconds, processor):
    """p50, p99, largest (us) of cyclictest's one thread. Throws CalledProcessError where it cannot run."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "histogram")
        command = ["cyclictest", f"-p{PRIORITY}", "-i1000", f"-l{round(1000 * seconds)}", "-N", f"-h{HISTOGRAM_NS}",
                   f"--histfile={path}", "-q", "-t1", f"-a{processor}", "--mlockall", "--policy=fifo"]
        subprocess.run(command, check=True, capture_output=True, text=True)
        counts, comments = [], {}
        with open(path, encoding="utf-8") as file:
            for line in file:
                if line.startswith("#"):
                    name, _, value = line[1:].partition(":")
                    comments[name.strip()] = value.split()
                elif line.strip():
                    late, count = line.split()[:2]
                    if int(count):
                        counts.append((int(late), int(count)))
    beyond = int(comments["Histogram Overflows"][0])
    total = sum(count for _, count in counts) + beyond
    return {"p50_us": percentile_us(counts, total, 0.50), "p99_us": percentile_us(counts, total, 0.99),
            "max_us": int(comments["Max Latencies"][0]) / 1000, "ticks": total}


def run_loop(bench, seconds):
    done = subprocess.run([bench, str(seconds), "prefer"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout), done.stderr.strip()


def give_up(message):
    print(f"lateness.py: {message}", file=sys.stderr)
    sys.exit(3)


def main():
    parser = argparse.ArgumentParser(description="lateness of the control loop beside cyclictest's")
    parser.add_argument("bench", help="the program lateness_bench")
    parser.add_argument("--pairs", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=5, help="of each measurement (default: 5)")
    parser.add_argument("--json", action="store_true", help="machine-readable")
    options = parser.parse_args()
    if options.pairs < 1 or options.seconds < 0.1:
        parser.error("at least one pair of 0.1 s")
    if not shutil.which("cyclictest"):
        give_up("cyclictest is not installed: apt-get install rt-tests")
    processor = max(os.sched_getaffinity(0))  # where the loop goes too, unless processors are isolated
    with open("/sys/devices/system/cpu/isolated", encoding="utf-8") as file:
        isolated = file.read().strip()
    if isolated:
        processor = int(isolated.replace(",", "-").split("-")[-1])
    # A first look at both; it also warms the caches.
    try:
        run_cyclictest(0.2, processor)
    except subprocess.CalledProcessError as error:
        give_up(f"cyclictest cannot run with SCHED_FIFO here: {(error.stderr or error.stdout).strip()}")
    first, problems = run_loop(options.bench, 0.2)
    if not first["fifo"]:
        give_up(f"the loop gets no SCHED_FIFO here: {problems}")

    loop, other = [], []
    for pair in range(options.pairs):
        for turn in (0, 1):
            if turn == pair % 2:
                loop.append(run_loop(options.bench, options.seconds)[0])
            else:
                other.append(run_cyclictest(options.seconds, processor))
        if not options.json:
            print("pair {:2}: loop p50 {:8.2f} p99 {:8.2f} max {:8.1f} us   cyclictest p50 {:8.2f} p99 {:8.2f} max {:8.1f} us"
                  .format(pair + 1, *(loop[-1][k] for k in ("p50_us", "p99_us", "max_us")),
                          *(other[-1][k] for k in ("p50_us", "p99_us", "max_us"))), flush=True)

    result = {"pairs": options.pairs, "seconds": options.seconds, "processor": processor, "priority": PRIORITY,
              "overruns": sum(run["overruns"] for run in loop)}
    for key in ("p50_us", "p99_us"):
        ours, theirs = (statistics.median(run[key] for run in runs) for runs in (loop, other))
        result[key] = {"loop": ours, "cyclictest": theirs, "ratio": ours / theirs,
                       "median_pair_ratio": statistics.median(a[key] / b[key] for a, b in zip(loop, other))}
    if options.json:
        print(json.dumps(result))
        return
    print(f"medians of {options.pairs} pairs of {options.seconds:g} s, SCHED_FIFO {PRIORITY}, processor {processor}; "
          f"{result['overruns']} ticks of the loop skipped")
    for key in ("p50_us", "p99_us"):
        row = result[key]
        print(f"  {key[:3]}  loop {row['loop']:.2f} us, cyclictest {row['cyclictest']:.2f} us, ratio {row['ratio']:.3f}, "
              f"median of the pairs' ratios {row['median_pair_ratio']:.3f}")


if __name__ == "__main__":
    main()
