#!/usr/bin/env bash
# Runs COMMAND in a clone of HEAD on a bare Debian, which is made for it and removed afterwards.
# Usage: tests/fresh.sh SUITE COMMAND     SUITE: bookworm (Debian 12) or trixie (Debian 13)
# Needs root, and space for it in $TMPDIR. Packages come from this machine's Debian mirror, through its proxy.
# Exit status: 0 COMMAND succeeded; 1 it failed; 77 mmdebstrap cannot be installed, nothing was run.
set -euo pipefail
[ $# -eq 2 ] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
[ "$(id -u)" -eq 0 ] || { echo "$0 needs root" >&2; exit 2; }
cd "$(dirname "$0")/.."
source runner/setup.sh
install_missing mmdebstrap git ||
  { echo "SKIPPED: mmdebstrap cannot be installed: '$2' is not run on a bare Debian ($1)" >&2; exit 77; }

settings=$(mktemp)
trap 'rm -f "$settings"' EXIT
apt-config dump | grep -E '^Acquire::https?:' >"$settings" || true
# The mirror is where this machine's own Debian packages come from. mmdebstrap has a default where there are no lists.
mirror=$(apt-get indextargets --format '$(LABEL) $(REPO_URI)' 'Created-By: Packages' | awk '$1 == "Debian" { print $2; exit }')
environment="HOME=/root TERM=dumb LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
for name in http_proxy https_proxy no_proxy HTTP_PROXY HTTPS_PROXY NO_PROXY; do
  [ -z "${!name:-}" ] || environment+=" $name=${!name}"
done
export environment command=$2 project=$PWD
began=$SECONDS status=0
# The hooks run in a shell of this machine, with the new machine's root as $1 and /proc, /sys and /dev mounted in it.
mmdebstrap --quiet --variant=minbase --include=git,ca-certificates --aptopt="$settings" \
  --customize-hook='cp /etc/hosts "$1/etc/hosts"; git clone -q "$project" "$1/root/project"' \
  --customize-hook='exec env -i $environment chroot "$1" bash -c "cd /root/project && $command" >&2' \
  "$1" /dev/null ${mirror:+"$mirror"} || status=1
echo "$([ $status -eq 0 ] && echo passed || echo FAILED) on a bare Debian ($1) after $((SECONDS - began)) s: $2"
exit $status
