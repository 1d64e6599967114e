#!/usr/bin/env bash
# The long tier: what finds faults and takes longer than a change should wait. Goes on after a failure and ends with a
# summary; exit status 1 where a part failed. Needs root for packages, and for the part fresh.
# Usage: tests/long.sh [PART...]   parts in their order: release sanitizers odr numbers faults kills power kernel fuzz bench tidy fresh
set -uo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
# shellcheck disable=SC2086
install_missing $packages_to_build catch2 librapidcheck-dev libvalijson-dev libbenchmark-dev python3 sqlite3 zstd mold \
  ccache clang clang-tidy git qemu-system-x86 cpio xz-utils || exit 2
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
part() {  # part NAME COMMAND...
  local name=$1 began=$SECONDS status=ok
  shift
  echo; echo "== $name: $*"
  "$@" || { [ $? -eq 77 ] && status=SKIPPED || status=FAILED; }
  printf '%-42s %6d s  %s\n' "$name" $((SECONDS - began)) "$status" >>"$logs/summary"
}
# beside NAME COMMAND...: a part that keeps one processor busy, beside others of its kind; what it prints comes when it ends.
beside() {
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
  echo; echo "== $1 begins: ${*:2}"
  { part "$@" >"$logs/$BASHPID" 2>&1; cat "$logs/$BASHPID"; } &
}
# cases PROGRAM FILTER: its test cases; fails where there are none (Catch2 v2 is content with that).
cases() {
  local text status=0
  text=$("$@" 2>&1) || status=$?
  printf '%s\n' "$text"
  [ "$status" -eq 0 ] && ! grep -q "No tests ran" <<<"$text"
}
wanted=("$@")
[ $# -gt 0 ] || wanted=(release sanitizers odr numbers faults kills power kernel fuzz bench tidy fresh)
want() { local one; for one in "${wanted[@]}"; do [ "$one" = "$1" ] && return 0; done; return 1; }
set_launcher
built() { cmake --preset "$1" "${launcher[@]}" >/dev/null && cmake --build --preset "$1" -- --quiet; }
kernel_long() { built dev && tests/kernel/run.sh build/dev long; }

for one in release numbers faults kills power; do
  want $one && { part "release build" built release; break; }
done
want release && part "every test of the release" tests/run.sh release
tests=build/release/tests
if want sanitizers; then  # every test that the gate leaves out under them too
  part "address and undefined behaviour, everything" env JND_ALL_TESTS=ON tests/run.sh asan
  part "threads, everything" env JND_ALL_TESTS=ON tests/run.sh tsan
fi
if want odr; then  # two things of one name in two wings: the compiler sees them only when it links
  part "one definition of everything" bash -c 'cmake -S . -B build/odr -G Ninja -DCMAKE_BUILD_TYPE=Release -DJND_TESTS=OFF \
    -DCMAKE_CXX_FLAGS="-flto=auto -Wodr -Werror=odr -Wlto-type-mismatch -Werror=lto-type-mismatch" \
    -DCMAKE_C_FLAGS="-flto=auto -Wodr -Werror=odr" -DCMAKE_AR="$(command -v gcc-ar)" -DCMAKE_RANLIB="$(command -v gcc-ranlib)" \
    >/dev/null && cmake --build build/odr --target jnd -- --quiet'
fi
want numbers && beside "fits beside random searches" cases $tests/analysis_tests "[search-campaign]"
if want faults; then
  beside "random histories of sessions" cases $tests/runner_tests "[course-campaign]"
  JND_CAMPAIGN=100 beside "a million faulty devices" cases $tests/devices_tests "*no fault brings force*"
  JND_CAMPAIGN=205 beside "10,000 faulty external rigs" cases $tests/devices_tests "*no fault of an external rig*"
  JND_CAMPAIGN=7 beside "every write and sync fails" cases $tests/faults_tests "*every write and sync*"
  JND_CAMPAIGN=34 beside "bits flipped at rest" cases $tests/faults_tests "*flipped bit at rest*"
fi
want kills && JND_CAMPAIGN=28 beside "sessions killed 1000 times" tests/faults/kill_sessions.py build/release/runner/jnd
want kills && JND_CAMPAIGN=13 beside "sessions on an external rig killed 100 times" \
  tests/faults/kill_external_sessions.py build/release/runner/jnd $tests/patient_rig
unless_skipped() { local status=0; "$@" || status=$?; [ "$status" -eq 77 ] || return "$status"; }
want kills && JND_CAMPAIGN=10 beside "tasks of a real Slurm killed 40 times" unless_skipped tests/runner/cluster/slurm_test.py build/release/runner/jnd
want power && JND_CAMPAIGN=12 beside "1000 power cuts" cases $tests/faults_tests "[power_loss]"
wait
want kernel && part "kernel, long" kernel_long
want fuzz && part "fuzzers, a million runs each" tests/fuzz/run.sh 1000000
if want bench; then
  part "benchmarks build" built bench
  part "thresholds recovered" build/bench/tests/bench/recovery_bench
  part "promises of the hierarchical model" build/bench/tests/bench/hierarchical_promises_bench 200
  part "coverage of the hierarchical model" build/bench/tests/bench/hierarchical_coverage_bench
fi
want tidy && part "clang-tidy of every source" env JND_TIDY_MINUTES=1000 .ci/tidy "$(git rev-list --max-parents=0 HEAD | tail -n 1)"
if want fresh; then  # the README's commands as it shows them, warnings being errors
  for suite in bookworm trixie; do
    part "bare Debian $suite: demo, installed" tests/fresh.sh $suite "export CFLAGS=-Werror CXXFLAGS=-Werror
      runner/demo.sh && cmake --install build/demo && cd / && jnd check tutorial && jnd-virtual-device --help"
    part "bare Debian $suite: tests" tests/fresh.sh $suite tests/run.sh
  done
fi

echo; echo "== summary"
cat "$logs/summary"
! grep -q FAILED "$logs/summary"
