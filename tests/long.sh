#!/usr/bin/env bash
# The long tier: what finds faults and takes longer than a change should wait. Goes on after a failure and ends with a
# summary; exit status 1 where a part failed. Needs root for packages only.
# Usage: tests/long.sh [PART...]   parts in their order: release sanitizers odr numbers faults kills power kernel fuzz bench tidy
set -uo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
# shellcheck disable=SC2086
install_missing $packages_to_build catch2 librapidcheck-dev libvalijson-dev libbenchmark-dev python3 sqlite3 zstd mold \
  ccache clang clang-tidy git qemu-system-x86 cpio || exit 2
summary=() failed=0
part() {  # part NAME COMMAND...
  local name=$1 began=$SECONDS status=ok
  shift
  echo; echo "== $name: $*"
  "$@" || { status=FAILED; failed=1; }
  summary+=("$(printf '%-42s %6d s  %s' "$name" $((SECONDS - began)) "$status")")
}
wanted=("$@")
[ $# -gt 0 ] || wanted=(release sanitizers odr numbers faults kills power kernel fuzz bench tidy)
want() { local one; for one in "${wanted[@]}"; do [ "$one" = "$1" ] && return 0; done; return 1; }
set_launcher
built() { cmake --preset "$1" "${launcher[@]}" >/dev/null && cmake --build --preset "$1" -- --quiet; }
kernel_long() { built dev && tests/kernel/run.sh build/dev long; }

part "release build" built release
want release && part "every test of the release" tests/run.sh release
tests=build/release/tests
if want sanitizers; then  # every test that the gate leaves out under them too
  part "address and undefined behaviour, everything" env JND_ALL_TESTS=ON tests/run.sh asan
  part "threads, everything" env JND_ALL_TESTS=ON tests/run.sh tsan
fi
if want odr; then  # two things of one name in the program: the compiler sees them only when it links
  part "one definition of everything" bash -c 'cmake -S . -B build/odr -G Ninja -DCMAKE_BUILD_TYPE=Release -DJND_TESTS=OFF \
    -DJND_UNITY=OFF -DCMAKE_CXX_FLAGS="-flto=auto -Wodr -Werror=odr -Wlto-type-mismatch -Werror=lto-type-mismatch" \
    -DCMAKE_C_FLAGS="-flto=auto -Wodr -Werror=odr" -DCMAKE_AR="$(command -v gcc-ar)" -DCMAKE_RANLIB="$(command -v gcc-ranlib)" \
    >/dev/null && cmake --build build/odr --target jnd -- --quiet'
fi
if want numbers; then
  part "numbers tagged [long]" $tests/analysis_tests "[long]"
  part "fits beside random searches" $tests/analysis_tests "[search-campaign]"
fi
if want faults; then
  part "random histories of sessions" $tests/runner_tests "[course-campaign]"
  part "a million faulty devices" env JND_FAULT_CASES=1000000 $tests/devices_tests "*no fault brings force*"
  part "every write and sync fails" env JND_EVERY=1 $tests/faults_tests "*every write and sync*"
  part "bits flipped at rest" env JND_BIT_FLIPS=200 $tests/faults_tests "*flipped bit at rest*"
fi
want kills && part "sessions killed 1000 times" tests/faults/kill_sessions.py build/release/runner/jnd --kills 1000
want power && part "1000 power cuts" env JND_POWER_LOSSES=1000 $tests/faults_tests "[power_loss]"
want kernel && part "kernel, long" kernel_long
want fuzz && part "fuzzers, a million runs each" tests/fuzz/run.sh 1000000
if want bench; then
  part "benchmarks build" built bench
  part "thresholds recovered" build/bench/tests/bench/recovery_bench
fi
want tidy && part "clang-tidy of every source" env JND_TIDY_MINUTES=1000 .ci/tidy "$(git rev-list --max-parents=0 HEAD | tail -n 1)"

echo; echo "== summary"
printf '%s\n' "${summary[@]}"
exit "$failed"
