// A hand that explores a sphere between thumb and index as a person would: it closes, presses about once a second,
// lets go between presses, and never repeats a press exactly.
//
// It knows neither the stimulus nor the force: what it does is a pure function of (seed, participant, trial, attempt,
// interval), so nothing about the answer can leak through it, and a resumed session moves as an undisturbed one.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "devices/participants/press_motion.h"
#include "devices/tracker.h"

namespace jnd {

struct HandHabits {
  double separation_m = 0.130;                     // between the fingertips at rest, along x
  double sphere_radius_m = 0.040;                  // where the surface is expected
  std::map<std::string, double> named_radius_m{};  // and of the objects of free interaction, by name
  double press_depth_m = 0.005;                    // mean of the depths; a normal cut at kLeastPress_m
  double press_depth_sd_m = 0.001;
  double closing_speed_m_per_s = 0.05;  // mean, from rest to the surface
  double press_period_s = 1.0;
  double lateral_sd_m = 0.001;  // wander of the contact point on the surface, each direction, from press to press
};

inline constexpr double kLeastPress_m = 0.0005;
class SimulatedHand final : public Tracker {
 public:
  // fingers: 1 or 2, thumb (at -x) first. Throws InputError where the fingers would rest inside the sphere or a named
  // object, or a habit is not positive.
  SimulatedHand(const HandHabits& habits, int fingers, std::uint64_t seed, int participant);

  void begin(const PresentRequest& request, std::int64_t start_ns) override;
  bool read(int finger, std::int64_t now_ns, FingerPose& pose) noexcept override;

  double approach_s() const noexcept { return approach_s_; }
  // Depth of the finger below the expected surface (negative above it) at a time after the interval's start, m.
  double depth_m(int finger, double time_s) const noexcept;

 private:
  struct Wander {  // of the contact point, at one press
    double y_m = 0, z_m = 0;
  };
  struct Finger {
    double side = 1;  // of the sphere, along x
    Eigen::Matrix3d axes;
    PressMotion motion;
    std::vector<Wander> wanders;
  };
  HandHabits habits_;
  double radius_m_;  // where the surface of the present object is expected
  std::vector<Finger> fingers_;
  std::uint64_t seed_;
  int participant_;
  double approach_s_ = 0;
  std::int64_t start_ns_ = 0;
};

}  // namespace jnd
