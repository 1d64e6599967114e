# An ordinary user, without and with the shipped udev rule.
plugdev=46
check "a device is plugged in" start_device P1 index
check "without the rule an ordinary user may not use it" fails 20 asuser 1000 "$plugdev" link_campaign trips P1 10
check "and is told of the rule" says /tmp/out 70-jnd.rules
check "jnd device list tells of it too" exits 0 10 asuser 1000 "$plugdev" jnd device list
check "with the rule's name" says /tmp/out P1 70-jnd.rules
stop_device P1

mkdir -p /etc/udev/rules.d /run/udev
cp /guest/70-jnd.rules /etc/udev/rules.d/
check "udevd runs" systemd-udevd --daemon --resolve-names=early
check "a device is plugged in" start_device P2 index
udevadm settle --timeout=10
check "with the rule a user in plugdev uses it" exits 0 60 asuser 1000 "$plugdev" link_campaign trips P2 100
check "jnd device info too" exits 0 20 asuser 1000 "$plugdev" jnd device info P2
check "a user outside plugdev may not" fails 20 asuser 1000 0 link_campaign trips P2 10
stop_device P2
kill "$(pidof systemd-udevd)"
