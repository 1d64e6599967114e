// Does a protocol ask more of its rig than the devices can do? Told before the first participant, with the numbers.
#pragma once

#include <string>
#include <vector>

#include "protocols/input/input_error.h"
#include "protocols/protocol.h"
#include "protocols/rigs/press_saturation.h"
#include "protocols/rigs/rig_description.h"

namespace jnd {

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

// Amplitude of the contact burst in g, unclamped: k / 1500 + 0.4 (Chinello et al. 2017, equation 38).
double burst_amplitude_g(double stiffness_n_per_m) noexcept;

// Viscosity and stiffness at the fingertip that a finger's own damping keeps passive at the loop's rate: b > K T / 2 +
// |B| (Colgate and Schenkel 1997), with T of one period of 1 ms and one of delay. The damping needed, in N s/m or N
// s/rad.
double needed_damping(double stiffness, double viscosity) noexcept;

// Of the fingertip, N s/m; assumed, as in the stiffness limit of devices/specs/rrs3.json.
inline constexpr double kFingerDamping_n_s_per_m = 2;
// Of the finger pulp, N/m; assumed.
inline constexpr double kPulpStiffness_n_per_m = 1000;

}  // namespace jnd
