# Sourced by runner/demo.sh and tests/run.sh: installs what is missing on a Debian machine, and says what.

packages_to_build="g++ cmake ninja-build pkg-config libboost-dev libcli11-dev libfmt-dev libeigen3-dev
  libhidapi-dev libmd4c-dev libncurses-dev libsqlite3-dev libsqlitecpp-dev nlohmann-json3-dev librandom123-dev libsimdjson-dev libsodium-dev libzstd-dev"

# install_missing PACKAGE...: asks the package manager only where something is missing.
install_missing() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  echo "Installing Debian packages: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "These packages need root, and there is no sudo here. As root: apt-get install ${missing[*]}" >&2; return 1; }
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# set_launcher: sets `launcher` to the options with which CMake compiles through ccache, where that is installed: another
# build or clone then finds what was compiled before.
set_launcher() {
  launcher=()
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
}
