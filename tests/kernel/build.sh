#!/usr/bin/env bash
# build.sh OUT KERNEL BUSYBOX UDEV "MODULE..." PATH=PLACE...: packs an initramfs OUT.cpio and the kernel OUT.vmlinuz.
# KERNEL, BUSYBOX, UDEV: the folders of fetch.sh. PATH=PLACE: a file or folder, and where it goes in the guest; a program
# brings its shared libraries along.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
out=$1 kernel=$2 busybox=$3 udev=$4 modules=$5
shift 5

root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
chmod 755 "$root" # as / of the guest, for ordinary users too
mkdir -p "$root"/{bin,etc,modules,proc,sys,dev,guest}

# Modules in the order in which they load. modules.dep is made at installation, so each is asked for what it needs.
: > "$root/modules/order"
add_module() {
  local file needs need
  file=$(find "$kernel" -name "${1//_/-}.ko*" -o -name "${1//-/_}.ko*" | head -1)
  [ -n "$file" ] || return 0 # built in
  grep -qx "$(basename "${file%.xz}")" "$root/modules/order" && return
  case $file in
    *.xz) xz -dc "$file" > "$root/modules/$(basename "${file%.xz}")" ;;
    *) cp "$file" "$root/modules/" ;;
  esac
  file=$root/modules/$(basename "${file%.xz}")
  needs=$(tr '\0' '\n' < "$file" | sed -n 's/^depends=//p' | head -1)
  for need in ${needs//,/ }; do add_module "$need"; done
  basename "$file" >> "$root/modules/order"
}
for module in $modules; do add_module "$module"; done

add_libraries() {
  local library
  { ldd "$1" 2>/dev/null || true; } | { grep -oE '/[^ ]+' || true; } | while read -r library; do
    mkdir -p "$root$(dirname "$library")"
    [ -e "$root$library" ] || cp -L "$library" "$root$library"
  done
}
cp "$(find "$busybox" -name busybox -type f)" "$root/bin/busybox"
udevadm=$(find "$udev" -name udevadm -type f)
cp "$udevadm" "$root/bin/udevadm"
ln -s udevadm "$root/bin/systemd-udevd"
add_libraries "$udevadm"
cp "$(command -v chrt)" "$root/bin/chrt" # busybox has none
add_libraries "$root/bin/chrt"
for program in qexit asuser button_uhid; do cc -O2 -Wall -Wextra -static -o "$root/bin/$program" "$here/$program.c"; done
cp "$here/init" "$root/init"
chmod 755 "$root/init"
cp "$here"/guest/* "$root/guest/"
printf 'root:x:0:0::/root:/bin/sh\nlab:x:1000:1000::/tmp:/bin/sh\n' > "$root/etc/passwd"
printf 'root:x:0:\nplugdev:x:46:\nlab:x:1000:\n' > "$root/etc/group"

for pair in "$@"; do
  from=${pair%%=*} to=$root${pair#*=}
  mkdir -p "$(dirname "$to")"
  cp -rL "$from" "$to"
  if [ -f "$to" ] && [ -x "$to" ]; then
    strip --strip-debug "$to" 2>/dev/null || true # a script is none the worse
    add_libraries "$from"
  fi
done
(cd "$root" && find . -print0 | cpio --null --create --format=newc --quiet --owner=0:0) > "$out.cpio"
cp "$(find "$kernel/boot" -name 'vmlinuz-*')" "$out.vmlinuz"
