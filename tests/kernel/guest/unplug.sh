# Devices unplugged at random instants.
. /guest/campaigns.sh
campaign_of_unplugs 8 12 60
