# Devices unplugged at random instants.
. /guest/campaigns.sh
campaign_of_unplugs 20 30 120
