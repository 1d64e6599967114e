// What one finger got in one interval, gathered sample by sample: the numbers that the log keeps of a presentation.
#pragma once

#include <cstdint>

#include "protocols/vocabulary.h"

namespace jnd {

// One tick of one finger.
struct IntervalSample {
  double duration_s = 0;  // of the tick
  bool touching = false;
  double penetration_m = 0;
  double force_n = 0;          // delivered, measured
  bool force_reduced = false;  // a limit reduced the asked force
  bool soft_start = false;
  double vibration_g = 0;  // delivered amplitude
  bool vibration_clamped = false;
};

// Sums only; nothing allocates. Thread rule: the control loop's thread, then whoever calls result().
class IntervalSummary {
 public:
  // force_commanded: whether this condition carries force; without it there is no stiffness to fit.
  void begin(bool force_commanded) noexcept;
  void add(const IntervalSample& sample) noexcept;
  FingerPresentation result() const noexcept;

 private:
  bool force_commanded_ = false;
  bool touching_ = false;
  double previous_penetration_m_ = 0, previous_force_n_ = 0;
  double sum_xf_ = 0, sum_xx_ = 0;
  double travel_m_ = 0, travel_s_ = 0, saturated_s_ = 0;
  FingerPresentation so_far_;
};

}  // namespace jnd
