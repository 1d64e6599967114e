#!/usr/bin/env bash
# The main job on a fresh Debian machine: installs what is missing, builds, runs the published experiment with 18
# simulated participants on simulated devices, and ends with the group table and CSV files.
# Usage: runner/demo.sh [FOLDER]   results go to FOLDER (default: demo-results)
# With JND_BUILD=DIR it runs the program of a build tree that is there already.
set -euo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
# shellcheck disable=SC2086
install_missing $packages_to_build

results=${1:-demo-results}
mkdir -p "$results"
build=${JND_BUILD:-build/demo}
if [ -z "${JND_BUILD:-}" ]; then
  echo "Building (a few minutes the first time)"
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DJND_TESTS=OFF >"$results/build.log"
  cmake --build "$build" >>"$results/build.log" || { tail -40 "$results/build.log" >&2; exit 1; }
fi
jnd=$build/runner/jnd

run() { echo; echo "\$ jnd $*"; "$jnd" "$@"; }
run check chinello2017
run simulate chinello2017 --participants 18 --study "$results/study.sqlite" --seed 1
run verify "$results/study.sqlite"
run analyze "$results/study.sqlite"
run export "$results/study.sqlite" --to "$results/csv" --replace
run report "$results/study.sqlite" --replace
echo
echo "The program is $jnd; the study is $results/study.sqlite, its page $results/study-report.html; the CSV files are in $results/csv:"
(cd "$results/csv" && find . -name '*.csv' | sort | head -n 8 && echo "  ... $(find . -name '*.csv' | wc -l) files")
