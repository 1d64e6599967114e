#!/usr/bin/env bash
# All tests on a fresh Debian machine: installs what is missing, builds, runs every test program, the README's commands
# and the end-to-end scripts.
# Usage: tests/run.sh [PRESET]   a preset of CMakePresets.json: dev (default), asan, tsan, release
set -euo pipefail
cd "$(dirname "$0")/.."
source runner/setup.sh
# shellcheck disable=SC2086
install_missing $packages_to_build catch2 librapidcheck-dev libvalijson-dev python3 sqlite3 zstd mold
# The page of `jnd report` is looked at in a real browser; without one that test says SKIPPED.
install_missing chromium || echo "SKIPPED: chromium cannot be installed: the report is not looked at in a browser" >&2

# The operator's screen is looked at through libvterm; without it that test says SKIPPED.
install_missing libvterm-dev || echo "SKIPPED: libvterm-dev cannot be installed: the operator's screen is not looked at" >&2

preset=${1:-dev}
# A kernel of its own with HID devices, in QEMU, and the firmware on an emulated Cortex-M: in the plain build; without
# the packages those tests say SKIPPED.
if [ "$preset" = dev ]; then
  install_missing qemu-system-x86 cpio || echo "SKIPPED: QEMU cannot be installed: the program meets no real HID stack" >&2
  install_missing gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm ||
    echo "SKIPPED: gcc-arm-none-eabi cannot be installed: the firmware is not built for a Cortex-M" >&2
fi
# Instrumented programs are slow: the campaign of faulty devices runs in full without sanitizers (10,000 cases).
case $preset in asan|tsan) export JND_FAULT_CASES=${JND_FAULT_CASES:-2000} ;; esac
launcher=()
# Another clone finds what was compiled here.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
echo "Building (preset $preset)"
cmake --preset "$preset" "${launcher[@]}" | grep -i "do not run" || true
cmake --build --preset "$preset" -- --quiet
ctest --preset "$preset" --output-on-failure --parallel "$(nproc)"
