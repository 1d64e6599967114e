#include "devices/rrs3/vibration_motor.h"

#include <algorithm>
#include <cmath>

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
  const bool runs = amplitude_g > 0 && !std::isnan(frequency_hz);
  amplitude_g_ = runs ? std::clamp(amplitude_g, limits_.min_g, limits_.max_g) : 0;
}

}  // namespace jnd
