// A force sensor of a fingertip device, such as the piezoresistive one under the 3RRS platform (Chinello et al. 2017,
// figure 1): Gaussian noise, then steps, then a range. The paper prints no data of it: ideal unless told otherwise.
//
// Thread rule: one thread. A measurement does not allocate, lock or wait. The noise is counter-based: it depends on the
// seed, the part and the number of measurements since the part began, on nothing else.
#pragma once

#include <cstdint>

#include "analysis/numerics/special_values.h"
#include "protocols/random_stream.h"

namespace jnd {

struct ForceSensorOptions {
  double noise_sd_n = 0;    // of one measurement, N; independent of the next one's
  double resolution_n = 0;  // of a step, N; 0: continuous
  // What the converter can tell apart; beyond, it stays at the end. N.
  double min_n = -kInf;
  double max_n = kInf;
};

class ForceSensor {
 public:
  // Throws InputError where a figure is negative or not a number, or where the range is empty.
  explicit ForceSensor(const ForceSensorOptions& options = {}, std::uint64_t seed = 0);

  // From here on the noise is that of (seed, part): an interval's, for example.
  void begin(std::uint64_t part) noexcept;

  // What the sensor says, N. A force that is not a number stays one, so that it is found by who relies on it.
  double measure(double force_n) noexcept;

 private:
  ForceSensorOptions options_;
  std::uint64_t seed_;
  RandomStream noise_;
};

}  // namespace jnd
