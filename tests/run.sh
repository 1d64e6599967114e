#!/usr/bin/env bash
# All tests on a fresh Debian machine: installs what is missing, builds, runs every test program, the pages' commands
# and the end-to-end scripts; ends with the ten slowest tests, what was skipped, and the time of every step.
# Usage: tests/run.sh [PRESET|long]   a preset of CMakePresets.json: dev (default), asan, tsan, release; long: every
#                                     campaign of tests/long.sh, which takes hours
set -euo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
source tests/steps.sh
[ "${1:-}" = long ] && exec tests/long.sh
preset=${1:-dev}
# wanted PACKAGES WHAT: installs what some tests need; without it they say SKIPPED.
wanted() {
  # shellcheck disable=SC2086
  install_missing $1 || echo "SKIPPED: $2 ($1 cannot be installed)" >&2
}
step packages
# shellcheck disable=SC2086
install_missing $packages_to_build catch2 librapidcheck-dev libvalijson-dev python3 sqlite3 zstd mold
if [ "$preset" = dev ] || [ "$preset" = release ] || [ "${JND_ALL_TESTS:-OFF}" = ON ]; then
  wanted "chromium poppler-utils" "the report in a browser"
  wanted "qemu-system-x86 cpio xz-utils" "the program against a real HID stack"
  wanted "bash-completion zsh fish" "what Tab offers in these shells"
  wanted "slurmctld slurmd slurm-client munge" "jnd cluster on a real scheduler"
  wanted r-base-core "recompute.R of an export"
  wanted "gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm" "the firmware on a Cortex-M"
fi
wanted libvterm-dev "the operator's screen"
# Instrumented programs are slow: random campaigns have a fifth of their usual size there.
case $preset in asan|tsan) export JND_CAMPAIGN=${JND_CAMPAIGN:-0.2} ;; esac
# Of freed memory 16 MB are kept from use, in the long campaign the usual 256: a seventh of the time goes into new pages there.
[ "${JND_ALL_TESTS:-OFF}" = ON ] || export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=16}
# The interpreter itself: a shim that looks for it costs a third of a second at every start.
PATH=$(dirname "$(python3 -c 'import sys; print(sys.executable)')"):$PATH
set_launcher
configure() { cmake --preset "$1" "${launcher[@]}" -DJND_ALL_TESTS="${JND_ALL_TESTS:-OFF}" | grep -i "do not run" || true; }
echo "Building (preset $preset)"
step "build of jnd"
if [ "$preset" = asan ]; then  # which links the tests that dev compiles; they are there in .ci/run
  configure dev
  cmake --build --preset dev --target test_objects -- --quiet
fi
configure "$preset"
cmake --build --preset "$preset" --target jnd -- --quiet
step "build of the tests"
cmake --build --preset "$preset" -- --quiet
step tests
# Tests flush thousands of times and would wait for the disk. What a cut of power leaves is tested on a disk that is played, and
# what needs a real one looks for it (on_disk in program.py).
if [ -z "${TMPDIR:-}" ] && [ "$(df --output=avail -BG /dev/shm 2>/dev/null | tr -dc 0-9)" -ge 4 ] 2>/dev/null; then
  TMPDIR=$(mktemp -d /dev/shm/jnd.XXXXXX)
  chmod 1777 "$TMPDIR"  # as /tmp: some tests are another user
  export TMPDIR
  trap 'rm -rf "$TMPDIR"' EXIT
fi
log=build/$preset/tests.log
status=0
# One more at a time than there are processors: some wait for devices.
ctest --preset "$preset" --output-on-failure --parallel "$(($(nproc) + 1))" | tee "$log" || status=$?
step
echo
echo "The ten slowest tests, s:"
slowest_tests "$log"
skips=$(grep -ho "SKIPPED.*" "build/$preset/Testing/Temporary/LastTest.log" || true)
[ -z "$skips" ] && echo "Skipped: 0" || printf 'Skipped: %d\n%s\n' "$(wc -l <<<"$skips")" "$skips"
echo "Preset $preset:"
print_steps
[ -z "${JND_STEPS:-}" ] || printf '%s\n' "${steps[@]}" | sed "s/^/$preset: /" >"$JND_STEPS.$preset"
exit "$status"
