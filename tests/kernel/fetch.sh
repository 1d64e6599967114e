#!/usr/bin/env bash
# fetch.sh cloud|full: Debian's kernel, busybox and udev, downloaded and unpacked by an ordinary user into a cache folder.
# Prints the folders, "KERNEL BUSYBOX UDEV", on one line. Where they cannot be had: says why, exit status 77.
# cloud: 27 MB, uhid only. full: 71 MB, also USB gadgets on a USB host of software (dummy_hcd).
set -euo pipefail
flavour=${1:?cloud or full}
cache=${JND_KERNEL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/jnd-kernel-tests}

skip() {
  echo "SKIPPED: tests/kernel: $*" >&2
  exit 77
}

case $flavour in
  cloud) metapackage=linux-image-cloud-$(dpkg --print-architecture) ;;
  full) metapackage=linux-image-$(dpkg --print-architecture) ;;
  *) echo "fetch.sh: cloud or full, not '$flavour'" >&2; exit 2 ;;
esac
for program in apt-get apt-cache dpkg-deb tar; do
  command -v "$program" >/dev/null || skip "$program is missing: the kernel is taken from Debian's packages"
done
mkdir -p "$cache/lists/partial" "$cache/archives/partial" 2>/dev/null || skip "the cache folder $cache cannot be written"

# The machine's own package lists may be too old, or not there at all: then lists of our own.
own_lists=(-o "Dir::State::Lists=$cache/lists" -o "Dir::Cache=$cache" -o "Dir::Cache::Archives=$cache/archives"
  -o APT::Sandbox::User= -o Debug::NoLocking=1)
lists=(-o APT::Sandbox::User=)
fresh_lists() {
  [ ${#lists[@]} -lt 3 ] || return 1
  lists=("${own_lists[@]}")
  echo "fetch.sh: fetching the package lists" >&2
  timeout 180 apt-get "${lists[@]}" update -qq >&2
}

# A metapackage depends on the newest kernel: names with versions are never written down here.
kernel_package() {
  { apt-cache "${lists[@]}" depends "$metapackage" 2>/dev/null || true; } | sed -n 's/^ *Depends: \(linux-image-[0-9].*\)/\1/p' | head -1
}

download() { (cd "$cache/archives" && timeout 300 apt-get "${lists[@]}" download -qq "$1" >&2); }

# unpack PACKAGE FOLDER PATTERN...: only the files that are needed; a full kernel is 400 MB otherwise.
unpack() {
  local package=$1 folder=$2 part
  shift 2
  [ "$(cat "$folder/complete" 2>/dev/null)" = "$*" ] && return
  if ! download "$package"; then
    fresh_lists || skip "the package $package cannot be downloaded"
    download "$package" || skip "the package $package cannot be downloaded"
  fi
  part=$(mktemp -d "$cache/part.XXXXXX")
  dpkg-deb --fsys-tarfile "$cache/archives/${package}"_*.deb | tar -x -C "$part" --wildcards "$@" ||
    skip "the package $package does not hold what it should: $*"
  rm -f "$cache/archives/${package}"_*.deb
  echo "$*" > "$part/complete"
  rm -rf "$folder"
  mv "$part" "$folder"
}

package=$(kernel_package)
if [ -z "$package" ]; then
  fresh_lists || skip "no package lists can be fetched to look for $metapackage"
  package=$(kernel_package)
fi
[ -n "$package" ] || skip "no kernel package is known: $metapackage is not in the package lists"
# /lib is in /usr from Debian 13 on.
wanted=('./boot/vmlinuz-*' '*/lib/modules/*/kernel/drivers/hid/*' '*/lib/modules/*/kernel/drivers/*/virtio*')
[ "$flavour" = cloud ] || wanted+=('*/lib/modules/*/kernel/drivers/usb/*' '*/lib/modules/*/kernel/fs/configfs/*')
unpack "$package" "$cache/$package" "${wanted[@]}"
unpack busybox-static "$cache/busybox" '*/bin/busybox'
unpack udev "$cache/udev" '*/bin/udevadm'
echo "$cache/$package $cache/busybox $cache/udev"
