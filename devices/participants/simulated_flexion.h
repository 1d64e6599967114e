// A finger that flexes its joint against a virtual object, actively, as a person would: it closes, presses and lets go
// about every two seconds, and never repeats a press exactly.
//
// As the simulated hand, it knows neither the stimulus nor the force: what it does is a pure function of (seed,
// participant, trial, attempt, interval).
#pragma once

#include <cstdint>

#include "devices/mckibben/mckibben_device.h"
#include "devices/participants/press_motion.h"
#include "devices/rig.h"

namespace jnd {

struct FlexionHabits {
  double straight_rad = 0;         // rocker angle of the straight finger
  double range_rad = 0;            // from there to the fully flexed one
  double contact_flexion_rad = 0;  // from straight: where the object is met
  double press_depth_rad = 0;      // mean of the depths
  double press_depth_sd_rad = 0;
  double closing_speed_rad_per_s = 0.3;  // mean, from straight to the object
  double press_period_s = 2.0;           // the tracking experiments of the McKibben paper flex at 0.5 Hz
};

class SimulatedFlexion final : public FingerFlexion {
 public:
  // Throws InputError where the object cannot be met within the finger's range, or a habit is not positive.
  SimulatedFlexion(const FlexionHabits& habits, std::uint64_t seed, int participant);

  // An interval begins at start_ns. May allocate.
  void begin(const PresentRequest& request, std::int64_t start_ns);
  double angle_rad(std::int64_t time_ns) const noexcept override;

 private:
  FlexionHabits habits_;
  std::uint64_t seed_;
  int participant_;
  PressMotion motion_;
  std::int64_t start_ns_ = 0;
};

}  // namespace jnd
