# The program in the guest, before anything is plugged in.
check "jnd runs" exits 0 5 jnd --version
check "jnd device list runs without any device" exits 0 5 jnd device list
check "it lists the shipped rig" says /tmp/out rrs3
