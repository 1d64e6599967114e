#include "devices/rrs3/force_sensor.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/input/input_error.h"

namespace jnd {

namespace {
constexpr std::string_view kPurpose = "force_sensor";
}  // namespace

ForceSensor::ForceSensor(const ForceSensorOptions& options, std::uint64_t seed)
    : options_(options), seed_(seed), noise_(seed, 0, kPurpose) {
  if (!(options.noise_sd_n >= 0) || !std::isfinite(options.noise_sd_n))
    throw InputError(fmt::format("the force sensor's noise_sd_n is {}: give 0 or more newtons", options.noise_sd_n));
  if (!(options.resolution_n >= 0) || !std::isfinite(options.resolution_n))
    throw InputError(fmt::format("the force sensor's resolution_n is {}: give 0 (continuous) or more newtons",
                                 options.resolution_n));
  if (!(options.min_n < options.max_n))
    throw InputError(fmt::format("the force sensor's range {} to {} N is empty: give min_n below max_n", options.min_n,
                                 options.max_n));
}

void ForceSensor::begin(std::uint64_t part) noexcept {
  noise_ = RandomStream(seed_, 0, kPurpose, part);
}

double ForceSensor::measure(double force_n) noexcept {
  double value = force_n;
  if (options_.noise_sd_n > 0) value += options_.noise_sd_n * noise_.normal();
  if (std::isnan(value)) return value;
  if (options_.resolution_n > 0) value = options_.resolution_n * std::nearbyint(value / options_.resolution_n);
  return std::clamp(value, options_.min_n, options_.max_n);
}

}  // namespace jnd
