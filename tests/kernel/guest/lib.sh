# Sourced by every part of the guest's tests: checks that print one line each, and virtual devices.

failures=0

seconds() { cut -d' ' -f1 /proc/uptime; }
last_check=$(seconds)

result() { # result ok|"not ok" NAME DETAIL
  now=$(seconds)
  echo "$1 - $2${3:+: $3} ($(awk "BEGIN { printf \"%.1f\", $now - $last_check }") s)"
  last_check=$now
}
ok() { result ok "$1" "$2"; }
not_ok() {
  failures=$((failures + 1))
  result "not ok" "$1" "$2"
}

# check NAME COMMAND...: the command must succeed; what it printed is shown where it does not.
check() {
  name=$1
  shift
  if "$@" > /tmp/check.out 2>&1; then ok "$name"; else
    status=$?
    not_ok "$name" "status $status"
    tail -n 15 /tmp/check.out | sed 's/^/    /'
  fi
}

# says FILE TEXT...: the file holds every one of the texts.
says() {
  file=$1
  shift
  for text in "$@"; do
    grep -qF -- "$text" "$file" || {
      echo "'$text' is missing in:"
      cat "$file"
      return 1
    }
  done
}

# exits STATUS SECONDS COMMAND...: ends within so many seconds with that status. Its output: /tmp/out.
exits() {
  expected=$1 limit=$2
  shift 2
  timeout -k 2 "$limit" "$@" > /tmp/out 2>&1 < /dev/null
  status=$?
  [ "$status" = "$expected" ] && return 0
  echo "status $status instead of $expected:"
  cat /tmp/out
  return 1
}

# fails SECONDS COMMAND...: ends within so many seconds with an error of its own: not killed, no crash. Its output: /tmp/out.
fails() {
  limit=$1
  shift
  timeout -k 2 "$limit" "$@" > /tmp/out 2>&1 < /dev/null
  status=$?
  [ "$status" -gt 0 ] && [ "$status" -lt 124 ] && return 0
  echo "status $status instead of an error:"
  cat /tmp/out
  return 1
}

# wait_until SECONDS COMMAND...: asks every 20 ms.
wait_until() {
  rounds=$(($1 * 50))
  shift
  while [ "$rounds" -gt 0 ]; do
    "$@" > /dev/null 2>&1 && return 0
    usleep 20000
    rounds=$((rounds - 1))
  done
  return 1
}

# by_length SHORT LONG: the one of this run.
by_length() {
  if [ "$(cat /guest/length)" = long ]; then echo "$2"; else echo "$1"; fi
}

# node_of SERIAL: the hidraw device of that serial number, "hidraw0".
node_of() {
  for uevent in /sys/class/hidraw/*/device/uevent; do
    grep -qx "HID_UNIQ=$1" "$uevent" 2>/dev/null || continue
    node=${uevent#/sys/class/hidraw/}
    echo "${node%%/*}"
    return 0
  done
  return 1
}
is_plugged() { node_of "$1"; }
is_unplugged() { ! node_of "$1"; }

# start_device SERIAL FINGER [ARGUMENTS...]: a virtual device with its log in /results/SERIAL.log. A real device keeps
# time by a timer of its own, whatever the host is doing: hence the priority above the host's loop.
start_device() {
  serial=$1 finger=$2
  shift 2
  rm -f "/tmp/$serial.control"
  mkfifo "/tmp/$serial.control"
  chrt -f 60 jnd-virtual-device --serial "$serial" --finger "$finger" --control "/tmp/$serial.control" \
    --log "/results/$part-$serial.log" "$@" > "/tmp/$serial.out" 2>&1 &
  eval "device_$(echo "$serial" | tr - _)=$!"
  wait_until 5 is_plugged "$serial" || { cat "/tmp/$serial.out"; return 1; }
}
tell_device() { timeout 2 sh -c "echo \"$2\" > /tmp/$1.control"; }
stop_device() {
  tell_device "$1" quit
  eval "wait \$device_$(echo "$1" | tr - _)"
  wait_until 2 is_unplugged "$1"
}

# What the device says about itself just now.
status_of() {
  tell_device "$1" status
  usleep 50000
  grep '^{' "/tmp/$1.out" | tail -n 1
}

# Sessions on both virtual devices, with a profile that answers.
plug_both() { start_device T1 thumb && start_device I1 index; }
stop_both() {
  stop_device T1
  stop_device I1
}
# threads: what the threads of the host and of the devices are doing: times, priority, where they wait.
threads() {
  for process in $(pidof jnd jnd-virtual-device); do
    for thread in "/proc/$process"/task/*; do
      echo "$(cut -d' ' -f1-3,14,15,40,41 "$thread/stat") $(cat "$thread/wchan") $(cat "$thread/syscall")"
    done
  done
}
# session SECONDS [RIG [STUDY]]: its study is /results/STUDY.sqlite, what the operator sees /results/STUDY.txt, its protocol
# /tmp/STUDY.json; STUDY is the part's. One that hangs leaves what its threads were doing, twice, in /results/STUDY-threads.txt.
session() {
  limit=$1 rig=${2:-hid} study=${3:-$part}
  (
    sleep "$((limit - 4))"
    threads > "/results/$study-threads.txt"
    sleep 2
    threads >> "/results/$study-threads.txt"
  ) &
  guard=$!
  timeout -k 5 "$limit" jnd run "/tmp/$study.json" --study "/results/$study.sqlite" --seed 7 --rig "$rig" \
    --responder chinello2017 --participant P01 --plain < /dev/null > "/results/$study.txt" 2>&1
  status=$?
  kill "$guard" 2>/dev/null
  [ "$status" = 0 ] && return 0
  echo "the session ends with status $status:"
  tail -n 20 "/results/$study.txt"
  return 1
}
# protocol: the session's protocol, with four or (long) eight trials in two conditions.
trials_per_cell="s/\"trials_per_cell\": 4/\"trials_per_cell\": $(by_length 2 4)/; s/\"balanced\"/\"$(by_length random balanced)\"/"
protocol() { sed -e "$trials_per_cell" /guest/session.json > "/tmp/$part.json"; }
# pushes SERIAL: how often the device began to push, by its own log.
pushes() { grep -c '"event":"push"' "/results/$part-$1.log"; }
# wait_for_push SERIAL: until the device begins to push once more.
pushed_more() { [ "$(pushes "$1")" -gt "$2" ]; }
wait_for_push() { wait_until 20 pushed_more "$1" "$(pushes "$1")"; }
# small_protocol: two or (long) four trials of one condition.
small_protocol() {
  sed -e "$trials_per_cell" -e '/"name": "SV"/d' -e 's/"cues": \["force"\]},/"cues": ["force"]}/' -e 's/\[\["S", "SV"\]\]/[]/' \
    /guest/session.json > "/tmp/$part.json"
}
