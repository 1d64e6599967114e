#!/usr/bin/env bash
# Builds the firmware and its self-test for a Cortex-M4F, and looks at what came out: its size, and that it has neither
# double precision, nor a heap, nor variables of its own.
#
# Usage: build-arm.sh [FOLDER]     FOLDER: for what is built (default: build/arm of the repository)
#        build-arm.sh --run [FOLDER]     runs it too, on an emulated board
# VECTORS in the environment: another file than devices/hid/vectors.txt.
set -euo pipefail
run=no
if [ "${1:-}" = --run ]; then
  run=yes
  shift
fi
source=$(cd "$(dirname "$0")" && pwd)
folder=${1:-$source/../../../build/arm}
mkdir -p "$folder/firmware" "$folder/test"
folder=$(cd "$folder" && pwd)
gcc=arm-none-eabi-gcc
# -fno-ipa-modref: before 14.2 GCC gives wrong code without it (bug 114207; CMakeLists.txt).
flags=(-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -std=c11 -Os -ffunction-sections -fdata-sections
  -fno-math-errno -ffp-contract=off -fno-ipa-modref -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror)

objects=()
for file in "$source"/*.c; do
  object=$folder/firmware/$(basename "$file" .c).o
  $gcc "${flags[@]}" -c "$file" -o "$object"
  objects+=("$object")
done

# What the firmware must not need: variables (in .data and .bss), arithmetic in double precision (__aeabi_d*), a heap.
if arm-none-eabi-nm "${objects[@]}" | grep -E ' [bBdDC] '; then
  echo "FAILED: the firmware has variables of its own" >&2
  exit 1
fi
if arm-none-eabi-nm -u "${objects[@]}" | grep -E '__aeabi_(d|.*2d)|malloc|calloc|realloc|free|printf'; then
  echo "FAILED: the firmware needs double precision or a heap" >&2
  exit 1
fi

awk -f "$source/arm/embed_vectors.awk" "${VECTORS:-$source/../vectors.txt}" >"$folder/test/embedded_vectors.c"
test_objects=()
for file in "$source"/arm/*.c "$folder/test/embedded_vectors.c"; do
  object=$folder/test/$(basename "$file" .c).o
  $gcc "${flags[@]}" -I"$source/arm" -c "$file" -o "$object"
  test_objects+=("$object")
done
$gcc "${flags[@]}" -nostartfiles --specs=nano.specs --specs=nosys.specs -T "$source/arm/mps2_an386.ld" \
  -Wl,--gc-sections -Wl,-Map="$folder/self_test.map" "${test_objects[@]}" "${objects[@]}" -lm -o "$folder/self_test.elf"

echo "The firmware's own objects:"
arm-none-eabi-size -t "${objects[@]}"
echo "With the C library, the self-test and its vectors:"
arm-none-eabi-size "$folder/self_test.elf"
if [ $run = yes ]; then
  qemu-system-arm -M mps2-an386 -nographic -icount shift=0 -semihosting-config enable=on,target=native \
    -kernel "$folder/self_test.elf"
fi
