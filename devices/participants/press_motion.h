// How a finger presses an object again and again: half sines in, smooth arcs out, from a rest outside it. Depths may be
// lengths or angles.
#pragma once

#include <vector>

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

}  // namespace jnd
