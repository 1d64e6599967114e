# The program's link to a device, without a session: what is sent is received, or counted as missing.
. /guest/campaigns.sh
check "a device can be plugged in" start_device L1 index
campaign_of_reports "$(by_length 2000 10000)" "$(by_length 2 5)"

timeout 60 link_campaign stream L1 index 2 > /results/link-spoilt.json &
stream=$!
sleep 1
tell_device L1 "drop 7"
tell_device L1 "damage 5"
check "2 s with reports left out and spoilt" wait "$stream"
stop_device L1
