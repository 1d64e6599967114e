// Which stiffness the 3RRS device really renders on a finger: the model is pressed through the governor as a study
// would, slowly, held until it has settled at several depths, and a line through the origin is fitted.
#pragma once

#include <vector>

#include "protocols/rigs/device_description.h"
#include "protocols/vocabulary.h"

namespace jnd {

struct Rrs3StiffnessQuery {
  double stiffness_n_per_m = 0;  // kS asked
  RenderingMode mode = RenderingMode::wrench;
  double finger_n_per_m = 1000;        // kf of the pulp
  double roll_rad = 0, pitch_rad = 0;  // of the platform: the surface's normal lies along the platform's
  int depths = 10;                     // held one after the other, equally spaced
  double deepest_m = 0.005;            // or the depth at which the contact law asks 0.9 of the device's force, if less
};

struct DepthAndForce {
  double depth_m = 0;  // of the finger in the virtual surface
  double force_n = 0;  // on the finger, measured, settled
};

struct Rrs3StiffnessAnswer {
  RenderingMode mode = RenderingMode::wrench;
  double asked_n_per_m = 0;
  double rendered_n_per_m = 0;  // sum(F x) / sum(x^2)
  // By the mode's law: kS in wrench mode, the series value kS kf / (kS + kf) in both position-controlled ones. What
  // pd_literal renders below that is the error of its law.
  double expected_n_per_m = 0;
  std::vector<DepthAndForce> curve;
};

// kS kf / (kS + kf), N/m.
double series_stiffness_n_per_m(double rendered_n_per_m, double finger_n_per_m) noexcept;

// Throws InputError where the stiffness is not in (0, max_stiffness] of the device, where the tilt is beyond its
// limits, where the finger is too soft for the device's stroke, or where there is nothing to press.
Rrs3StiffnessAnswer measure_rendered_stiffness(const DeviceSpec& spec, const Rrs3StiffnessQuery& query);

}  // namespace jnd
