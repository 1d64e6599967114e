# A whole session through hidraw, and the same one on the models inside the program.
check "two devices are plugged in" plug_both
protocol
check "a whole session through hidraw" session 120
check "jnd verify --deep finds nothing" exits 0 60 jnd verify --deep /results/session.sqlite
check "the plan" exits 0 10 jnd plan /tmp/session.json --participant 1 --seed 7 --json
cp /tmp/out /results/session-plan.json
check "the same session on the models" exits 0 60 jnd simulate /tmp/session.json --study /results/session-models.sqlite \
  --participants 1 --seed 7 --profile chinello2017
stop_both
