// The eccentric motor under the platform (Precision Microdrives 304-101; Chinello et al. 2017, Table 1): 50..240 Hz,
// 0.05..1 g. It starts, stops and changes at once, without a jump of phase while it runs.
//
// Thread rule: one thread. Nothing allocates, locks or throws after construction.
#pragma once

namespace jnd {

inline constexpr double kStandardGravity_m_per_s2 = 9.80665;

struct VibrationLimits {
  double min_g = 0.05, max_g = 1;
  double min_hz = 50, max_hz = 240;
};

class VibrationMotor {
 public:
  // Throws InputError where a limit is negative or not a number, or a range is empty.
  explicit VibrationMotor(const VibrationLimits& limits = {});

  // Runs at the nearest amplitude and frequency within the limits. amplitude <= 0, or not a number: off.
  void set(double amplitude_g, double frequency_hz) noexcept;
  void stop() noexcept { set(0, 0); }

  // Lets time pass, s; what is negative or not finite is no time.
  void advance(double elapsed_s) noexcept;

  double amplitude_g() const noexcept { return amplitude_g_; }    // 0: off
  double frequency_hz() const noexcept { return frequency_hz_; }  // 0: off
  // a(t) = A sin(phase), phase' = 2 pi f, from phase 0 where the motor starts.
  double acceleration_m_per_s2() const noexcept;

 private:
  VibrationLimits limits_;
  double amplitude_g_ = 0, frequency_hz_ = 0;
  double turns_ = 0;  // phase, 0..1
};

}  // namespace jnd
