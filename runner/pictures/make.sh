#!/usr/bin/env bash
# The pictures of the pages: the operator's console in a real rehearsal, and the report of a simulated study.
# Usage: runner/pictures/make.sh [JND]   the program (default: build/demo/runner/jnd)
set -euo pipefail
cd "$(dirname "$0")/../.."
source runner/setup.sh
install_missing python3 python3-pyte chromium
jnd=$(realpath "${1:-build/demo/runner/jnd}")
pictures=$PWD/runner/pictures
/usr/bin/python3 "$pictures/console.py" "$jnd" "$pictures/console.svg"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$jnd" simulate chinello2017 --participants 18 --study study.sqlite --seed 1
"$jnd" report study.sqlite
# The summary, the contents and the first figure.
chromium --headless=new --no-sandbox --disable-gpu --hide-scrollbars --no-first-run --virtual-time-budget=5000 \
  --blink-settings=preferredColorScheme=1 --force-device-scale-factor=0.7 --window-size=1050,1940 \
  --screenshot="$pictures/report.png" "file://$folder/study-report.html" 2>/dev/null
ls -l "$pictures"/*.svg "$pictures"/*.png
