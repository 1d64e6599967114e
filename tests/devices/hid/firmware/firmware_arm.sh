#!/usr/bin/env bash
# The firmware compiles for a Cortex-M4F without double precision, heap or variables of its own, and its self-test
# passes on an emulated board: the protocol's vectors, and a finger pressed in every mode.
#
# Usage: firmware_arm.sh [FOLDER]     FOLDER: for what is built (default: a temporary one)
# Exit status 77: a tool is missing, nothing was tested.
set -euo pipefail
for tool in arm-none-eabi-gcc qemu-system-arm; do
  if ! command -v "$tool" >/dev/null; then
    echo "SKIPPED: $tool is not installed: nobody looks at the firmware on its own processor" >&2
    echo "         (Debian: gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm)" >&2
    exit 77
  fi
done
source=$(cd "$(dirname "$0")/../../../../devices/hid/firmware" && pwd)
folder=${1:-}
if [ -z "$folder" ]; then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
"$source/build-arm.sh" "$folder"
run() {
  # icount: a nanosecond an instruction, so that steps can be timed. What the program says comes on standard error.
  timeout 300 qemu-system-arm -M mps2-an386 -nographic -icount shift=0 -semihosting-config enable=on,target=native \
    -kernel "$1" 2>&1
}
run "$folder/self_test.elf" | tee "$folder/self_test.log"
grep -qx PASSED "$folder/self_test.log"

# The self-test can fail: with one byte of one vector changed it must.
sed 's/^command typical 01010101/command typical 01010102/' "$source/../vectors.txt" >"$folder/wrong.txt"
if cmp -s "$folder/wrong.txt" "$source/../vectors.txt"; then
  echo "FAILED: the vector to damage is no longer there: name another one in $0" >&2
  exit 1
fi
VECTORS=$folder/wrong.txt "$source/build-arm.sh" "$folder/wrong" >/dev/null
if run "$folder/wrong/self_test.elf" >"$folder/wrong.log"; then
  echo "FAILED: a damaged vector passes" >&2
  exit 1
fi
grep -q 'FAILED: vector command typical' "$folder/wrong.log"
echo "A damaged vector is found."
