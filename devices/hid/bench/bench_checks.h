// What `jnd device test` checks of a real device, one subject a function: each adds lines of what was expected and what
// was measured. They drive the device through a BenchLink, and leave it at rest.
#pragma once

#include <string>
#include <vector>

#include "devices/check.h"
#include "devices/hid/bench/bench_link.h"
#include "devices/hid/firmware/jnd_report.h"
#include "devices/hid/hid_bus.h"

namespace jnd {

// What the pages say against what was listed, and against what every device must be.
void check_description(const HidInfo& info, const jnd_identity& identity, const jnd_limits& limits, Checks& checks);
// For `seconds` at rest: rate, gaps and damaged reports, the device's clock, its state and faults.
void check_stream(BenchLink& link, const jnd_identity& identity, double seconds, Checks& checks);
// From a command to the first telemetry that echoes it, at rest.
void check_round_trip(BenchLink& link, Checks& checks);
// Active without force: silence, and nothing but damaged or repeated commands, must each stop it in time.
void check_watchdog(BenchLink& link, const jnd_identity& identity, Checks& checks);
void check_refusals(BenchLink& link, const jnd_identity& identity, Checks& checks);

// From here on the device moves and presses. Largest force of a test: the bench's own cap.
inline constexpr double kTestForce_n = 0.5;
void check_force(BenchLink& link, Checks& checks);
void check_vibration(BenchLink& link, Checks& checks);
void check_rest(BenchLink& link, Checks& checks);

// Poses of a tracker for `seconds`: rate, gaps, clock, how often each finger was seen. Throws DeviceError where the
// tracker is gone.
void check_poses(HidHandle& handle, Clock& clock, double seconds, const std::atomic<bool>& interrupted, Checks& checks);

}  // namespace jnd
