// The eccentric motor under the platform (Precision Microdrives 304-101; Chinello et al. 2017, Table 1): 50..240 Hz,
// 0.05..1 g. It starts, stops and changes at once.
//
// Thread rule: one thread. Nothing allocates, locks or throws after construction.
#pragma once

namespace jnd {

struct VibrationLimits {
  double min_g = 0.05, max_g = 1;
  double min_hz = 50, max_hz = 240;
};

class VibrationMotor {
 public:
  // Throws InputError where a limit is negative or not a number, or a range is empty.
  explicit VibrationMotor(const VibrationLimits& limits = {});

  // Runs at the nearest amplitude within the limits. amplitude <= 0, or either not a number: off.
  void set(double amplitude_g, double frequency_hz) noexcept;
  void stop() noexcept { set(0, 0); }

  double amplitude_g() const noexcept { return amplitude_g_; }  // 0: off

 private:
  VibrationLimits limits_;
  double amplitude_g_ = 0;
};

}  // namespace jnd
