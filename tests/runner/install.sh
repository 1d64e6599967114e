#!/usr/bin/env bash
# An installed program finds its own protocols, profiles and device specs, also after the prefix was moved.
# Usage: install.sh BUILD_FOLDER
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
DESTDIR=$folder cmake --install "$1" >/dev/null
mv "$folder$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$1/CMakeCache.txt")" "$folder/moved"
test -x "$folder/moved/bin/jnd-virtual-device"
jnd=$folder/moved/bin/jnd
cd "$folder"
# Warnings name the file that was read: it must be the installed one.
"$jnd" check chinello2017 | grep -q "$folder/moved/share/jnd/protocols/chinello2017.json"
"$jnd" new mine --from tutorial >/dev/null
"$jnd" simulate mine.json --participants 1 --study s.sqlite --seed 1 --profile chinello2017-varied >/dev/null 2>&1
"$jnd" verify s.sqlite
# The pages come along, with the pictures that they show.
pages=$folder/moved/share/doc/jnd
for page in README.md protocols/README.md runner/OPERATOR.md; do test -s "$pages/$page"; done
grep -o '(runner/pictures/[^)]*)' "$pages/README.md" | tr -d '()' | while read -r picture; do test -s "$pages/$picture"; done
# The manual, and what the shells offer on Tab, where they look for them.
share=$folder/moved/share
for made in man/man1/jnd.1 man/man1/jnd-device-test.1 bash-completion/completions/jnd zsh/site-functions/_jnd \
            fish/vendor_completions.d/jnd.fish; do
  test -s "$share/$made"
done
