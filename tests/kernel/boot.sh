#!/usr/bin/env bash
# boot.sh IMAGE RESULTS SECONDS: boots IMAGE.vmlinuz with IMAGE.cpio, prints what the guest says on its serial line, and
# unpacks its /results, which it writes to its disk, into the folder RESULTS. Exit status: the guest's; 124: it was not
# done within SECONDS; 125: it ended without a word.
#
# Pure emulation, always: a machine with half a virtualisation would hang. One processor, and counted instructions as
# its clock (-icount): an instruction takes 1 ns, idle time is skipped. So a busy host makes the guest slow, never late.
set -uo pipefail
image=$1 results=$2 limit=$3
rm -rf "$results"
mkdir -p "$results"
log=$results/serial.txt
truncate -s 64M "$results/results.tar.gz" # a disk; what is not written of it takes no room
timeout --kill-after=5 "$limit" qemu-system-x86_64 -accel tcg -cpu max -M pc,usb=off -smp 1 -m 512 \
  -icount shift=0,align=off,sleep=off -nodefaults -no-user-config -display none -no-reboot \
  -serial stdio -drive "file=$results/results.tar.gz,format=raw,if=virtio,cache=unsafe" \
  -device isa-debug-exit,iobase=0xf4,iosize=1 \
  -kernel "$image.vmlinuz" -initrd "$image.cpio" \
  -append "console=ttyS0 quiet panic=-1 mitigations=off random.trust_cpu=on" </dev/null 2>"$results/qemu.txt" |
  sed -u 's/\r$//' | tee "$log"
qemu=${PIPESTATUS[0]}
if [ "$qemu" = 124 ] || [ "$qemu" = 137 ]; then
  echo "not ok - the guest is done within $limit s"
  exit 124
fi
status=$(sed -n 's/^GUEST-EXIT //p' "$log" | tail -1)
if [ -z "$status" ] || ! tar -xzf "$results/results.tar.gz" -C "$results" 2>/dev/null; then
  echo "not ok - the guest ends with its results: QEMU's status is $qemu"
  cat "$results/qemu.txt"
  exit 125
fi
rm "$results/results.tar.gz"
exit "$status"
