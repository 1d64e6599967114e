# The host freezes while it presents: the devices let go by themselves.
check "two devices are plugged in" plug_both
small_protocol
session 90 > /tmp/session.out &
session=$!
check "force is given" wait_for_push I1
jnd=$(pidof jnd)
kill -STOP "$jnd"
seconds > /results/freeze-stopped.txt
sleep 1
kill -CONT "$jnd"
check "the session goes on and ends well" wait "$session"
check "jnd verify --deep finds nothing" exits 0 60 jnd verify --deep /results/freeze.sqlite
stop_both
