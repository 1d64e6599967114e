# What takes too long for every change: ten times the short campaigns.
. /guest/campaigns.sh
check "a device is plugged in" start_device L1 index
campaign_of_reports 100000 60
stop_device L1
campaign_of_unplugs 200 300 1200
