#include "devices/mckibben/mckibben_sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/random_stream.h"

namespace jnd {

double Encoder::read_rad(double angle_rad) const noexcept {
  if (!(pulses_per_turn > 0)) return angle_rad;
  const double pulse = 2 * std::numbers::pi / pulses_per_turn;
  return zero_rad + pulse * std::nearbyint((angle_rad - zero_rad) / pulse);
}

double BeamForceSensor::noise_n(std::int64_t time_ns) const noexcept {
  if (!(noise_sd_n > 0)) return 0;
  return noise_sd_n * RandomStream(seed, 0, "mckibben/force sensor", static_cast<std::uint64_t>(time_ns)).normal();
}

double BeamForceSensor::read_n(double force_n, double noise_n) const noexcept {
  const double limited = std::clamp(force_n + noise_n, -capacity_n, capacity_n);
  return resolution_n > 0 ? resolution_n * std::nearbyint(limited / resolution_n) : limited;
}

}  // namespace jnd
