// What one device did to its finger in one interval, gathered sample by sample: the numbers that the log keeps.
#pragma once

#include <cstdint>

#include "protocols/vocabulary.h"

namespace jnd {

// One tick of one device.
struct IntervalSample {
  double duration_s = 0;  // of the tick
  bool touching = false;
  double penetration = 0;      // m or rad
  double force_n = 0;          // delivered, measured
  bool force_reduced = false;  // a limit reduced the asked force
  bool soft_start = false;
  double vibration_g = 0;  // delivered amplitude
  bool vibration_clamped = false;
};

// Sums only; nothing allocates in add. Thread rule: the control loop's thread, then the thread that calls result().
class IntervalSummary {
 public:
  // force_commanded: whether this condition carries force on this device; without it there is no stiffness to fit.
  // path_per_penetration: travel of the fingertip against the force, m, per unit of penetration; 1 where that is in m.
  void begin(bool force_commanded, double path_per_penetration = 1) noexcept;
  void add(const IntervalSample& sample) noexcept;
  FingerPresentation result() const;

 private:
  bool force_commanded_ = false;
  double path_per_penetration_ = 1;
  bool touching_ = false;
  double previous_penetration_ = 0, previous_force_n_ = 0;
  double sum_xf_ = 0, sum_xx_ = 0, sum_ff_ = 0;
  double travel_ = 0, travel_s_ = 0, saturated_s_ = 0;
  FingerPresentation so_far_;
};

}  // namespace jnd
