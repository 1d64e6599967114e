#!/usr/bin/env bash
# All tests on a fresh Debian machine: installs what is missing, builds, runs every test program, the pages' commands
# and the end-to-end scripts; ends with the ten slowest tests and the time of every step.
# Usage: tests/run.sh [PRESET|long]   a preset of CMakePresets.json: dev (default), asan, tsan, release; long: every
#                                     campaign of tests/long.sh, which takes hours
set -euo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
[ "${1:-}" = long ] && exec tests/long.sh
steps=()
began=$SECONDS
# step NAME: ends the one before.
step() {
  [ ${#steps[@]} -eq 0 ] || steps[-1]+=" $((SECONDS - began)) s"
  began=$SECONDS
  [ $# -eq 0 ] || steps+=("$1")
}
step packages
# shellcheck disable=SC2086
install_missing $packages_to_build catch2 librapidcheck-dev libvalijson-dev python3 sqlite3 zstd mold
# The page of `jnd report` is looked at in a real browser; without one that test says SKIPPED.
install_missing chromium poppler-utils || echo "SKIPPED: chromium or poppler-utils cannot be installed: the report is not looked at in a browser" >&2

# The operator's screen is looked at through libvterm; without it that test says SKIPPED.
install_missing libvterm-dev || echo "SKIPPED: libvterm-dev cannot be installed: the operator's screen is not looked at" >&2

preset=${1:-dev}
# A kernel of its own with HID devices, in QEMU, and the firmware on an emulated Cortex-M: in the plain build; without
# the packages those tests say SKIPPED.
if [ "$preset" = dev ]; then
  install_missing qemu-system-x86 cpio || echo "SKIPPED: QEMU cannot be installed: the program meets no real HID stack" >&2
  install_missing bash-completion zsh fish || echo "SKIPPED: zsh and fish cannot be installed: nobody looks at what Tab offers there" >&2
  install_missing slurmctld slurmd slurm-client munge || echo "SKIPPED: Slurm cannot be installed: jnd cluster meets no real scheduler" >&2
  install_missing r-base-core || echo "SKIPPED: r-base-core cannot be installed: the exports' recompute.R is not run" >&2
  install_missing gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm ||
    echo "SKIPPED: gcc-arm-none-eabi cannot be installed: the firmware is not built for a Cortex-M" >&2
fi
# Instrumented programs are slow: the campaign of faulty devices runs in full without sanitizers (10,000 cases).
case $preset in asan|tsan) export JND_FAULT_CASES=${JND_FAULT_CASES:-2000} ;; esac
# Of freed memory 16 MB are kept from use, in the long campaign the usual 256: a seventh of the time goes into new pages there.
[ "${JND_ALL_TESTS:-OFF}" = ON ] || export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=16}
# The interpreter itself: what a shim finds starts a third of a second later, every time, and some tests wait for half of one.
PATH=$(dirname "$(python3 -c 'import sys; print(sys.executable)')"):$PATH
set_launcher
echo "Building (preset $preset)"
step build
cmake --preset "$preset" "${launcher[@]}" -DJND_ALL_TESTS="${JND_ALL_TESTS:-OFF}" | grep -i "do not run" || true
cmake --build --preset "$preset" -- --quiet
step tests
log=$(mktemp) alone=$(mktemp)
trap 'rm -f "$log" "$alone"' EXIT
status=0
# One more at a time than there are processors: some wait for devices.
ctest --preset "$preset" --output-on-failure --parallel "$(($(nproc) + 1))" | tee "$log" || status=$?
# Devices and people act in real time, and a loaded machine may keep a test from it. What failed beside others, three at most,
# runs once more by itself and is named, whatever comes of it. Never what shows that no data are lost, a crash, or a sanitizer's finding.
failed=$(sed -nE '/following tests FAILED/,$ s/^[[:space:]]+[0-9]+ - (.*)$/\1/p' "$log")
if [ -n "$failed" ] && [ "$(wc -l <<<"$failed")" -le 3 ] && ! grep -vqE '\((Failed|Timeout)\)$' <<<"$failed" &&
  ! grep -qE '^(kill_|power_loss|storage_faults)' <<<"$failed" && ! grep -qE 'Sanitizer: |runtime error: ' "$log"; then
  status=0
  ctest --preset "$preset" --rerun-failed --output-on-failure --parallel 1 | tee "$alone" || status=$?
fi
step
echo
if [ -n "$failed" ]; then
  echo "FAILED BESIDE OTHER TESTS: ${failed//$'\n'/, }"
  [ ! -s "$alone" ] || [ $status -ne 0 ] || echo "PASSED BY THEMSELVES: all of these. Please mend them: a test waits for what happens, not for a while."
fi
echo "The ten slowest tests, s:"
sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([a-z_0-9]+) .* ([0-9.]+) sec.*$/\2 \1/p' "$log" | sort -rn | head -n 10 |
  awk '{printf "  %-20s %7.1f\n", $2, $1}'
printf 'Time of preset %s: ' "$preset"
printf '%s; ' "${steps[@]}" | sed 's/; $/\n/'
exit "$status"
