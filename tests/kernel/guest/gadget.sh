# Writes that block: a device on a USB bus of software stops reading for 12 s, so that the kernel holds every write 5 s.
usb_device USB1 3 12 60 > /results/usb_device.json 2> /tmp/usb_device.err &
usb_device=$!
check "a device on a USB bus is there" wait_until 5 is_plugged USB1
check "1,000 round trips over USB" exits 0 60 link_campaign trips USB1 1000
cp /tmp/out /results/usb_trips.json
check "the link goes on while writes block" exits 0 60 link_campaign stream USB1 index 20
cp /tmp/out /results/usb_stream.json
wait "$usb_device"
