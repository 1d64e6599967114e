// How simulated hands and fingers move.
//
// A finger presses an object again and again: half sines in, smooth arcs out, from a rest outside it. Depths may be lengths
// or angles.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "devices/mckibben/mckibben_device.h"
#include "devices/rig.h"
#include "devices/tracker.h"

namespace jnd {

// Share of the period that the finger is in the object.
inline constexpr double kPressShare = 0.65;
// The finger never reaches the surface sooner than this after the cue: the soft start (200 ms) is then over.
inline constexpr double kLeastApproach_s = 0.3;

// Thread rule: depth is const and allocates nothing; set_depths is called outside the tick.
class PressMotion {
 public:
  PressMotion() = default;
  // gap: from rest to the surface, > 0; speed: mean of the approach, the gap's unit per second; period_s of the
  // presses.
  PressMotion(double gap, double speed, double period_s) noexcept;

  // How many presses an interval of this length needs.
  std::size_t presses_in(double seconds) const noexcept;
  // One depth a press, > 0.
  void set_depths(std::vector<double> depths) noexcept { depths_ = std::move(depths); }

  // Below the surface (negative above it) at a time after the interval's start; -gap before any depths are set.
  double depth(double time_s) const noexcept;
  double approach_s() const noexcept { return approach_s_; }

 private:
  double gap_ = 1, approach_s_ = 1, period_s_ = 1;
  std::vector<double> depths_;
};

// A hand that explores a sphere between thumb and index as a person would: it closes, presses about once a second,
// lets go between presses, and never repeats a press exactly.
//
// It knows neither the stimulus nor the force: what it does is a pure function of (seed, participant, trial, attempt,
// interval), so nothing about the answer can leak through it, and a resumed session moves as an undisturbed one.
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

// A finger that flexes its joint against a virtual object, actively, as a person would: it closes, presses and lets go
// about every two seconds, and never repeats a press exactly.
//
// As the simulated hand, it knows neither the stimulus nor the force: what it does is a pure function of (seed,
// participant, trial, attempt, interval).
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
