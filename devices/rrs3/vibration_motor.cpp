#include "devices/rrs3/vibration_motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "protocols/input/input_error.h"

namespace jnd {

VibrationMotor::VibrationMotor(const VibrationLimits& limits) : limits_(limits) {
  const auto check = [](double low, double high, const char* unit) {
    if (!(low >= 0) || !(high >= low) || !std::isfinite(high))
      throw InputError(
          fmt::format("a vibration motor cannot run from {} to {} {}: give 0 <= low <= high", low, high, unit));
  };
  check(limits.min_g, limits.max_g, "g");
  check(limits.min_hz, limits.max_hz, "Hz");
}

void VibrationMotor::set(double amplitude_g, double frequency_hz) noexcept {
  if (!(amplitude_g > 0) || std::isnan(frequency_hz)) {
    amplitude_g_ = frequency_hz_ = turns_ = 0;
    return;
  }
  amplitude_g_ = std::clamp(amplitude_g, limits_.min_g, limits_.max_g);
  frequency_hz_ = std::clamp(frequency_hz, limits_.min_hz, limits_.max_hz);
}

void VibrationMotor::advance(double elapsed_s) noexcept {
  if (amplitude_g_ <= 0 || !(elapsed_s > 0) || !std::isfinite(elapsed_s)) return;
  turns_ += frequency_hz_ * elapsed_s;
  turns_ -= std::floor(turns_);
}

double VibrationMotor::acceleration_m_per_s2() const noexcept {
  if (amplitude_g_ <= 0) return 0;
  return amplitude_g_ * kStandardGravity_m_per_s2 * std::sin(2 * std::numbers::pi * turns_);
}

}  // namespace jnd
