#!/usr/bin/env bash
# run.sh BUILD_DIR [short|session|link|long] [PART...]: the real programs against virtual devices in a Linux kernel of
# their own, in QEMU. Prints "ok" or "not ok" and a name for each check, and a summary. Exit status: 0, 1 where a check
# failed, 77 where QEMU or a kernel cannot be had. session, link: one of the two guests of the short form. PART: only
# these of the files in guest/.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
build=$(cd "${1:?usage: run.sh BUILD_DIR [short|session|link|long] [PART...]}" && pwd) || exit 2
length=${2:-short}
shift $(($# > 1 ? 2 : 1))
work=$build/kernel-tests
mkdir -p "$work"
began=$(date +%s)
export PYTHONDONTWRITEBYTECODE=1

# Two guests at a time, one for each processor of a small machine.
session_parts="program identity readme permissions refusals session freeze buttons"
link_parts="link unplug tracker"
campaign_parts="campaign"
case $length in
  short) guests=("session cloud 1800 $session_parts" "link cloud 1800 $link_parts") ;;
  session) guests=("session cloud 1800 $session_parts") ;;
  link) guests=("link cloud 1800 $link_parts") ;;
  long) guests=("session cloud 2400 $session_parts $link_parts" "campaign cloud 2400 $campaign_parts" "gadget full 900 gadget") ;;
  *) echo "run.sh: short, session, link or long, not '$length'" >&2; exit 2 ;;
esac
[ $# -gt 0 ] && guests=("chosen ${JND_KERNEL_FLAVOUR:-cloud} 1200 $*")

skip() {
  echo "SKIPPED: tests/kernel: $*"
  exit 77
}
for program in qemu-system-x86_64 cpio xz cc python3; do
  command -v "$program" >/dev/null || skip "$program is missing (Debian: qemu-system-x86 cpio xz-utils gcc python3)"
done
[ "$(dpkg --print-architecture 2>/dev/null)" = amd64 ] || skip "the guest is an amd64 Debian; this machine is not"

programs=(jnd=runner/jnd jnd-virtual-device=devices/jnd-virtual-device link_campaign=tests/link_campaign
  usb_device=tests/usb_device)
files=()
for program in "${programs[@]}"; do
  [ -x "$build/${program#*=}" ] || { echo "run.sh: $build/${program#*=} is not built" >&2; exit 2; }
  files+=("$build/${program#*=}=/usr/bin/${program%%=*}")
done
files+=("$source_dir/protocols=/usr/share/jnd/protocols" "$source_dir/devices/hid/70-jnd.rules=/guest/70-jnd.rules")
for folder in specs profiles objects; do files+=("$source_dir/devices/$folder=/usr/share/jnd/$folder"); done

# run_guest NAME FLAVOUR SECONDS PART...: builds, boots, judges what came back.
run_guest() {
  local name=$1 flavour=$2 limit=$3 kernel modules="hid hid-generic uhid virtio_pci virtio_blk"
  shift 3
  [ "$flavour" = full ] && modules="$modules usbhid libcomposite usb_f_hid dummy_hcd"
  kernel=$("$here/fetch.sh" "$flavour") || return $?
  printf '%s\n' "$@" > "$work/$name.parts"
  echo "$length" > "$work/$name.length"
  python3 "$here/readme_virtual.py" > "$work/$name.readme" || return 1
  # shellcheck disable=SC2086
  "$here/build.sh" "$work/$name" $kernel "$modules" "${files[@]}" "$work/$name.parts=/guest/parts" "$work/$name.length=/guest/length" "$work/$name.readme=/guest/readme_commands" \
    "$here/session.json=/guest/session.json" || return 1
  "$here/boot.sh" "$work/$name" "$work/$name.results" "$limit"
  local status=$?
  python3 "$here/judge.py" "$work/$name.results" "$@" || status=1
  rm -f "$work/$name.cpio" "$work/$name.vmlinuz"
  return "$status"
}

# The first download is shared: one after the other, before anything runs side by side.
exec 9> "$work/fetching"
flock 9
for guest in "${guests[@]}"; do
  read -r _ flavour _ <<< "$guest"
  "$here/fetch.sh" "$flavour" >/dev/null || exit $?
done
exec 9>&-
pids=()
for guest in "${guests[@]}"; do
  read -r name flavour limit parts <<< "$guest"
  # shellcheck disable=SC2086
  run_guest "$name" "$flavour" "$limit" $parts > "$work/$name.txt" 2>&1 &
  pids+=($!)
done
failed=0
for place in "${!guests[@]}"; do
  wait "${pids[$place]}" || failed=1
  name=${guests[$place]%% *}
  echo "# guest: $name"
  cat "$work/$name.txt"
done

total=0 bad=0
for guest in "${guests[@]}"; do
  text=$work/${guest%% *}.txt
  total=$((total + $(grep -cE '^(ok|not ok) - ' "$text")))
  bad=$((bad + $(grep -cE '^not ok - ' "$text")))
done
echo
echo "1..$total"
echo "# $((total - bad)) of $total checks passed in $(($(date +%s) - began)) s"
[ "$bad" = 0 ] && [ "$failed" = 0 ] && [ "$total" -gt 0 ]
