#!/usr/bin/env bash
# Builds the fuzzers with clang and runs each of them.
#
# Usage: tests/fuzz/run.sh [RUNS]     RUNS: executions of each target (default: 1000000)
#
# What they find is left as crash-* in build/fuzz; once it is mended the file belongs into tests/fuzz/corpus/TARGET.
set -euo pipefail
cd "$(dirname "$0")/../.."
runs=${1:-1000000}
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz_protocol fuzz_profile fuzz_csv fuzz_events fuzz_keys fuzz_report
cd build/fuzz
for target in protocol profile csv events keys report; do
  echo "== $target: $runs executions"
  mkdir -p "grown/$target"
  "tests/fuzz/fuzz_$target" -runs="$runs" -max_len=16384 -timeout=20 -print_final_stats=1 -artifact_prefix="crash-$target-" \
    "grown/$target" "../../tests/fuzz/corpus/$target" 2>&1 | tail -n 8
done
