# Sourced by the parts that come in a short and in a long form.

# campaign_of_reports REQUESTS SECONDS: requests for pages, each answered; then commands and telemetry at 1 kHz. L1 is
# plugged in.
campaign_of_reports() {
  check "$1 requests" exits 0 600 link_campaign trips L1 "$1"
  cp /tmp/out "/results/$part-trips.json"
  status_of L1 > "/results/$part-stream-status.json"
  check "$2 s at 1 kHz" exits 0 "$(($2 * 5 + 35))" link_campaign stream L1 index "$2"
  cp /tmp/out "/results/$part-stream.json"
  status_of L1 >> "/results/$part-stream-status.json"
}

# unplug_at_random COUNT SERIAL...: each for 0.1 to 0.6 s, 0.2 to 1.5 s after the one before. The same ones in every run.
unplug_at_random() {
  count=$1
  shift
  awk -v count="$count" -v devices="$*" 'BEGIN {
    srand(7)
    n = split(devices, names, " ")
    for (i = 0; i < count; i++)
      printf "%d %s %d\n", 2e5 + rand() * 1.3e6, names[1 + int(rand() * n)], 100 + rand() * 500
  }' | while read -r wait_us serial ms; do
    usleep "$wait_us"
    tell_device "$serial" "unplug $ms"
    usleep "$((ms * 1000))"
  done
}

# campaign_of_unplugs COUNT STREAM_SECONDS SESSION_SECONDS: of a link, then in a session.
campaign_of_unplugs() {
  check "a device is plugged in" start_device U1 index
  timeout "$(($2 * 2))" link_campaign stream U1 index "$2" > "/results/$part-stream-unplugged.json" &
  stream=$!
  unplug_at_random "$1" U1
  check "$1 unplugs at random instants: the link ends well" wait "$stream"
  stop_device U1

  check "two devices are plugged in" plug_both
  small_protocol
  session "$3" > /tmp/session.out &
  session=$!
  check "the session has begun" wait_for_push T1
  unplug_at_random "$1" T1 I1
  check "$1 unplugs in a session: it goes on and ends well" wait "$session"
  cat /tmp/session.out
  check "jnd verify --deep finds nothing" exits 0 600 jnd verify --deep "/results/$part.sqlite"
  stop_both
}
