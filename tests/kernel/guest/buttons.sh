# Buttons learnt from real hidraw devices, and sessions answered with them.

# with_box KIND HOW COMMAND...: a jnd command beside a made-up box, whose participant and operator do as it says.
with_box() {
  kind=$1 how=$2
  shift 2
  rm -f /tmp/keys
  mkfifo /tmp/keys
  # shellcheck disable=SC2086
  { sleep 1; timeout -k 2 120 "$@" < /tmp/keys 2>&1; echo "status $?"; } | tee /tmp/out |
    button_uhid "$kind" $how > /tmp/keys
  cp /tmp/out "/results/buttons-$kind-$how.txt"
  says /tmp/out "status 0"
}
# answered STUDY WHO COUNT: so many answers of the study's log were entered so.
answered() {
  found=$(grep -ao "\"entered_by\":\"$2\"" "$1" | wc -l)
  [ "$found" = "$3" ] && return 0
  echo "$found answers by the $2 instead of $3"
  return 1
}

check "without its mapping a session is refused" exits 3 10 jnd run /guest/session.json --study /tmp/none.sqlite \
  --participant P01 --buttons /tmp/none.json
kinds=pedal
[ "$(cat /guest/length)" = long ] && kinds="pedal gamepad keyboard"
for kind in $kinds; do
  check "the buttons of a $kind are learnt" with_box $kind "" jnd device learn-buttons --to /tmp/$kind.json --stop
  check "a session is answered with a $kind" with_box $kind troubled jnd run /guest/session.json \
    --study /results/$kind.sqlite --seed 7 --participant P01 --plain --fast --buttons /tmp/$kind.json
  cp /tmp/$kind.json /results/
  check "the operator is told of both at once, the stop, and the box that went and came back" says /tmp/out \
    "both buttons at once: no answer" "STOP by the button" "not counted (stopped)" "the button box has gone" \
    "the button box is there again" "The session of P01 is complete"
  check "every answer but the operator's own is the participant's" answered /results/$kind.sqlite participant 7
  check "and the operator's is the one while the box was gone" answered /results/$kind.sqlite operator 1
  check "a session without its box is refused" exits 4 10 jnd run /guest/session.json --study /tmp/none.sqlite \
    --participant P01 --buttons /tmp/$kind.json
  check "and the study is not made" sh -c "! test -e /tmp/none.sqlite"
done
