# Devices that no session may begin with.
small_protocol
run_refused() { fails 30 jnd run "/tmp/$part.json" --study /tmp/refused.sqlite --rig hid --responder chinello2017 --plain; }

check "a session without devices is refused" run_refused
check "the refusal names the first finger, and says where to look" says /tmp/out thumb "jnd device list" 70-jnd.rules

check "one of two devices is plugged in" start_device T1 thumb
check "a session with one of two devices is refused" run_refused
check "the refusal names the missing finger" says /tmp/out index
check "a device of another version is plugged in" start_device I1 index --at 0 wrong-version
usleep 100000
check "a device of another version is refused" run_refused
check "with both ranges of versions" says /tmp/out "versions 9 to 9" "versions 1 to 1"
check "jnd device info refuses it too" fails 10 jnd device info I1
check "with both ranges of versions" says /tmp/out "versions 9 to 9" "versions 1 to 1"
check "no session was begun by what was refused" sh -c \
  '! test -e /tmp/refused.sqlite || ! grep -q session.opened /tmp/refused.sqlite'
stop_both
