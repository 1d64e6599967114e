# The commands that devices/hid/README.md shows on virtual devices; judge.py compares what they print.
start_device RRS3-0001 thumb
start_device RRS3-0002 index
number=0
while read -r line; do
  number=$((number + 1))
  # shellcheck disable=SC2086
  check "$line" exits 0 60 $line
  cp /tmp/out "/results/readme-$number.txt"
done < /guest/readme_commands
check "the page has commands" test "$number" -gt 0
stop_device RRS3-0001
stop_device RRS3-0002
