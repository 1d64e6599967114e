#!/usr/bin/env bash
# Builds the fuzzers with clang and runs each of them.
#
# Usage: tests/fuzz/run.sh [RUNS]     RUNS: executions of each target (default: 1000000, times JND_CAMPAIGN)
#
# What they find is left as crash-* in build/fuzz; once it is mended the file belongs into tests/fuzz/corpus/TARGET.
set -euo pipefail
cd "$(dirname "$0")/../.."
runs=${1:-$(awk "BEGIN { printf \"%d\", 1000000 * ${JND_CAMPAIGN:-1} }")}
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzz_protocol fuzz_profile fuzz_csv fuzz_trials fuzz_trace fuzz_events fuzz_keys fuzz_report fuzz_rig_line
cd build/fuzz
fuzz() {
  local target=$1 status=0 log
  log=$(mktemp)
  mkdir -p "grown/$target"
  "tests/fuzz/fuzz_$target" -runs="$runs" -max_len=16384 -timeout=20 -print_final_stats=1 -artifact_prefix="crash-$target-" \
    "grown/$target" "../../tests/fuzz/corpus/$target" >"$log" 2>&1 || status=$?
  echo "== $target: $runs executions asked, exit $status"
  tail -n 8 "$log"
  rm -f "$log"
  return "$status"
}
export runs
export -f fuzz
# As many at a time as there are processors, the slowest first.
printf '%s\n' protocol rig_line trace trials report profile events csv keys | xargs -P "$(nproc)" -n 1 bash -c 'fuzz "$0"'
