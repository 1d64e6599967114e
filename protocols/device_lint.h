// Does a protocol ask more of a device than it can do? Told before the first participant, with the numbers.
#pragma once

#include <string>
#include <vector>

#include "protocols/device_spec.h"
#include "protocols/input_error.h"
#include "protocols/protocol.h"

namespace jnd {

struct DeviceLint {
  std::vector<Diagnostic> errors;    // the study could not measure what it says
  std::vector<Diagnostic> warnings;  // it can, and the numbers should be known
};

// file: for messages; places come from Protocol::bytes (0 where a protocol was not loaded from a file).
//
// Errors: a stiffness above the device's limit; a pair that the device cannot tell apart in a condition, because both
// vibrations clamp to one amplitude, or because the force limit is reached within a quarter of the expected press
// already at the softer stiffness. Warnings: presses beyond the force limit, clamped vibrations.
DeviceLint lint_against_device(const Protocol& protocol, const DeviceSpec& spec, const std::string& file);

// The penetration at which the force limit is reached (m): max_force / stiffness.
double depth_at_force_limit_m(double stiffness_n_per_m, const DeviceSpec& spec) noexcept;

// The share of intervals, 0..1, in which at least one press goes deeper than the force limit allows. Presses are
// Gaussian, the protocol's expected depth with a standard deviation of 1 mm, one a second on each finger.
double expected_saturated_intervals(double stiffness_n_per_m, const Protocol& protocol,
                                    const DeviceSpec& spec) noexcept;

// Amplitude of the contact burst in g, unclamped: k / 1500 + 0.4 (Chinello et al. 2017, equation 38).
double burst_amplitude_g(double stiffness_n_per_m) noexcept;

}  // namespace jnd
