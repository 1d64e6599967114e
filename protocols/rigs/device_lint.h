// Does a protocol ask more of its rig than the devices can do? Told before the first participant, with the numbers.
#pragma once

#include <string>
#include <vector>

#include "protocols/input/input_error.h"
#include "protocols/protocol.h"
#include "protocols/rigs/device_description.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

// Presses on a virtual object, and how much of them a device's force limit takes away. Depths and stiffnesses are in
// the study's unit: m and N/m, or rad and N/rad.
//
// A press is half a sine in time. Depths are Gaussian: the protocol's expected press with a standard deviation of 1 mm,
// one press a second, on every finger of a hand; or, where a joint flexes, of a fifth of it, one press in two seconds
// (the 0.5 Hz of the McKibben paper's tests).
//
// force_gain: force asked of the device per force of the contact; of a joint, the ratio of two lever arms.

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

struct DeviceLint {
  std::vector<Diagnostic> errors;    // the study could not measure what it says
  std::vector<Diagnostic> warnings;  // it can, and the numbers should be known
};

// rig: the one that the protocol names. file: for messages; places come from Protocol::bytes (0 where a protocol was
// not loaded from a file).
//
// Errors: a stiffness above a device's limit; a pair that feels the same in a condition, because each of its cues does:
// vibrations clamp to one amplitude, or the force limit is reached within a quarter of the expected press already at
// the softer stiffness; an object or a press beyond the range of the joint or of the platform; a viscosity that cannot
// be rendered at 1 kHz. Warnings: presses beyond the force limit, or sometimes beyond the range; clamped vibrations;
// stiffnesses that a position-controlled platform compresses, or that rely on more than the finger's own damping.
DeviceLint lint_against_device(const Protocol& protocol, const RigSpec& rig, const std::string& file);

// Viscosity and stiffness at the fingertip that a finger's own damping keeps passive at the loop's rate: b > K T / 2 +
// |B| (Colgate and Schenkel 1997), with T of one period of 1 ms and one of delay. The damping needed, in N s/m or N
// s/rad.
double needed_damping(double stiffness, double viscosity) noexcept;

// Of the fingertip, N s/m; assumed, as in the stiffness limit of devices/specs/rrs3.json.
inline constexpr double kFingerDamping_n_s_per_m = 2;
// Of the finger pulp, N/m; assumed.
inline constexpr double kPulpStiffness_n_per_m = 1000;

}  // namespace jnd
