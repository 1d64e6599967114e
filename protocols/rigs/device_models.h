// The models of devices, and what holds of every device of a model whatever its description says.
#pragma once

#include <algorithm>
#include <string_view>

#include "protocols/vocabulary.h"

namespace jnd {

// Amplitude of the contact burst, A = (kS / 1500 + 0.4) g, in g, unclamped (Chinello et al. 2017, equation 38). Above 1 g
// (kS > 900 N/m) the device clamps.
constexpr double burst_amplitude_g(double stiffness_n_per_m) noexcept {
  return stiffness_n_per_m / 1500 + 0.4;
}

enum class DeviceModel { rrs3, mckibben };

// The most that a device of a model is ever given: a description may lower a limit, never raise it. The reader of
// descriptions refuses more with words. Force, tilt and vibration are capped once more by the governor, force and
// vibration also by the models of the devices, stroke and joint speed by the platform's model. A stiffness gives
// nothing but forces, which are capped.
struct HardLimits {
  double force_n = 0;    // on the finger
  double stiffness = 0;  // N/m, or N/rad of a joint
  // Of a platform; a joint has none.
  double stroke_m = 0;
  double roll_rad = 0, pitch_rad = 0;
  double joint_speed_rad_per_s = 0;
  double vibration_g = 0, vibration_hz = 0;
};

struct DeviceModelFacts {
  std::string_view title;      // "3RRS device", for messages
  std::string_view renders;    // what it does to the finger, in words
  bool acts_on_joint = false;  // else it presses the pulp
  std::string_view place;      // "pulp" or "joint", for messages
  Unit unit = Unit::n_per_m;   // of its stiffnesses
  HardLimits limits{};
};

// Limits of the 3RRS platform: Chinello et al. 2017, Table 1, and the passivity bound of specs/rrs3.json; of the
// McKibben finger: "Use of McKibben Muscle in a Haptic Interface", the force and the stiffest object of its tests.
constexpr DeviceModelFacts facts_of(DeviceModel model) noexcept {
  switch (model) {
    case DeviceModel::rrs3:
      return {.title = "3RRS device",
              .renders = "presses and tilts on the pulp, vibrates",
              .acts_on_joint = false,
              .place = "pulp",
              .unit = Unit::n_per_m,
              .limits = {.force_n = 4.7,
                         .stiffness = 2000,
                         .stroke_m = 0.015,
                         .roll_rad = 0.6283185307179586,
                         .pitch_rad = 0.5235987755982988,
                         .joint_speed_rad_per_s = 10.471975511965978,
                         .vibration_g = 1,
                         .vibration_hz = 240}};
    case DeviceModel::mckibben:
      return {.title = "McKibben finger",
              .renders = "resists the finger's flexion",
              .acts_on_joint = true,
              .place = "joint",
              .unit = Unit::n_per_rad,
              .limits = {.force_n = 30, .stiffness = 50}};
  }
  return {};
}

constexpr HardLimits hard_limits(DeviceModel model) noexcept {
  return facts_of(model).limits;
}

// A described limit as it holds: at most the hard one, 0 where it is negative or no number.
constexpr double limit_in_force(double described, double hard) noexcept {
  return described > 0 ? std::min(described, hard) : 0;
}

}  // namespace jnd
