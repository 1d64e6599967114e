// Presses on a virtual object, and how much of them a device's force limit takes away. Depths and stiffnesses are in
// the study's unit: m and N/m, or rad and N/rad.
//
// A press is half a sine in time. Depths are Gaussian: the protocol's expected press with a standard deviation of 1 mm,
// one press a second, on every finger of a hand; or, where a joint flexes, of a fifth of it, one press in two seconds
// (the 0.5 Hz of the McKibben paper's tests).
//
// force_gain: force asked of the device per force of the contact; of a joint, the ratio of two lever arms.
#pragma once

#include "protocols/protocol.h"
#include "protocols/rigs/device_description.h"

namespace jnd {

// The depth at which the force limit is reached: max_force / (force_gain stiffness).
double depth_at_force_limit(double stiffness, const DeviceSpec& spec, double force_gain = 1) noexcept;

// Standard deviation of the depth of presses.
double expected_press_sd(const Protocol& protocol) noexcept;

// The share of intervals, 0..1, in which at least one press goes deeper than the force limit allows.
double expected_saturated_intervals(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                    double force_gain = 1) noexcept;

// The share of contact time, 0..1, that is spent deeper than that, over all presses.
double expected_saturated_share(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                double force_gain = 1) noexcept;

}  // namespace jnd
