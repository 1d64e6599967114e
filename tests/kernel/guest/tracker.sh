# Poses from outside: a tracker over USB, and a program on a pipe, that fall silent while force is given.
poses_from() {
  small_protocol
  sed "s/\"tracker\": \"hand\"/\"tracker\": \"$1\"/" "/tmp/$part.json" > "/tmp/$part-$1.json"
}
# while_pushing COMMAND...: as soon as the thumb's device pushes once more.
while_pushing() { wait_for_push T1 && "$@"; }

check "two devices are plugged in" plug_both
poses_from hid
check "without its tracker a session is refused" fails 20 jnd run /tmp/tracker-hid.json \
  --study /tmp/none.sqlite --participant P01 --rig hid --plain --responder chinello2017
check "and says which" says /tmp/out "the tracker is not connected"
check "before a study is made" sh -c "! test -e /tmp/none.sqlite"
check "a tracker is plugged in" start_device K1 thumb --finger index --tracker --rate 200
check "nothing that is felt with a model counts as real" exits 2 20 jnd run /tmp/tracker-hid.json --study /tmp/real.sqlite \
  --participant P01 --rig hid --plain --kind real
check "that is said, and no study is made" sh -c "grep -q 'real data' /tmp/out && ! test -e /tmp/real.sqlite"
check "with a person it is a rehearsal" exits 130 30 jnd run /tmp/tracker-hid.json --study /tmp/pilot.sqlite \
  --participant P01 --rig hid --plain
check "and says so" says /tmp/out "kind pilot: never counted as real data"
session 150 hid tracker-hid > /tmp/session.out 2>&1 &
session=$!
check "the tracker freezes for 100 ms under force" while_pushing tell_device K1 "freeze 100"
check "it loses the fingers under force" while_pushing tell_device K1 "lose on"
usleep 200000
check "and sees them again" tell_device K1 "lose off"
check "it is unplugged under force, for 700 ms" while_pushing tell_device K1 "unplug 700"
check "the session goes on and ends well" wait "$session"
cat /tmp/session.out
check "jnd verify --deep finds nothing" exits 0 60 jnd verify --deep /results/tracker-hid.sqlite
stop_device K1

# A program that writes poses: 4 mm into a sphere of 40 mm, out of it by 5 mm, over again each 0.8 s. The kernel's list
# of timers gives it the host's monotonic clock.
cat > /tmp/poses.awk << 'PROGRAM'
function now_s(line, word, clock) {
  clock = "/proc/timer_list"
  while ((getline line < clock) > 0) if (split(line, word, " ") > 1 && word[1] == "now") break
  close(clock)
  return word[3] / 1e9
}
BEGIN {
  print "jnd-poses 1 units=m clock=monotonic"
  while ("while usleep 4000; do echo; done" | getline) {
    t = now_s()
    s = t / 0.8 - int(t / 0.8)
    x = 0.045 - 0.018 * (s < 0.5 ? s : 1 - s)
    printf "thumb %.6f %.6f 0 0 0.70710678 0 -0.70710678 0 n=%d\n", t, -x, n++
    printf "index %.6f %.6f 0 0 0.70710678 0 0.70710678 0 n=%d\n", t, x, n++
    fflush()
  }
}
PROGRAM
cat > /tmp/booth.json << 'RIG'
{"format": 1, "title": "A booth in a kernel of its own",
 "devices": [{"finger": "thumb", "serial": "T1"}, {"finger": "index", "serial": "I1"}],
 "tracker": {"command": ["awk", "-f", "/tmp/poses.awk"]}}
RIG
poses_from process
jnd doctor --protocol /tmp/tracker-process.json --rig /tmp/booth.json --seconds 0.1 --json > /tmp/out
check "jnd doctor finds the rig file's devices and program" says /tmp/out '"name":"devices","verdict":"ok"' \
  '"name":"tracker","verdict":"ok"'
session 150 /tmp/booth.json tracker-process > /tmp/session.out 2>&1 &
session=$!
check "the program ends under force" while_pushing killall awk
seconds > /results/tracker-killed.txt
check "the session goes on and ends well" wait "$session"
cat /tmp/session.out
check "jnd verify --deep finds nothing" exits 0 60 jnd verify --deep /results/tracker-process.sqlite
stop_both
