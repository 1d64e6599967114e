# Who is connected: lists and identities.
check "two devices can be plugged in" plug_both
check "jnd device list runs" exits 0 10 jnd device list
check "it names both devices" says /tmp/out T1 I1
check "jnd device list --json runs" exits 0 10 jnd device list --json
cp /tmp/out /results/identity-list.json
for serial in T1 I1; do
  check "jnd device info $serial runs" exits 0 10 jnd device info "$serial"
  check "it says what the device is" says /tmp/out "$serial" 1.0.0 "a model in software"
done
check "jnd device info of a device that is not there fails, with those that are" exits 3 10 jnd device info NOBODY
check "jnd device test runs, without giving force" exits 0 30 jnd device test T1 --json
check "and tells a model from a device" says /tmp/out '"simulated":true'
stop_both
