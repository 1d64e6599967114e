# Devices unplugged at random instants.
. /guest/campaigns.sh
campaign_of_unplugs "$(by_length 4 8)" "$(by_length 7 12)" 60
