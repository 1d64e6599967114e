// The McKibben finger's two sensors: what they make of the true angle and force.
//
// Thread rule: const; the control loop's thread. Nothing allocates or throws.
#pragma once

#include <cstdint>

namespace jnd {

// Rotary encoder on the rocker: Baumer BDK, 1024 pulses a turn, each edge of one channel counted.
struct Encoder {
  double pulses_per_turn = 1024;  // 0: ideal
  double zero_rad = 0;            // where it counts from

  // The nearest position that the encoder can tell, rad.
  double read_rad(double angle_rad) const noexcept;
};

// Planar beam force sensor: Futek FR1020, 89 N. Its combined error of 0.25 % of the capacity, 0.22 N, is a bound on
// nonlinearity, hysteresis and repeatability and not noise: noise and quantisation depend on the amplifier and are
// given.
struct BeamForceSensor {
  double capacity_n = 89;
  double noise_sd_n = 0;    // 0: ideal
  double resolution_n = 0;  // 0: ideal
  std::uint64_t seed = 0;

  // The noise is a pure function of (seed, time): it does not depend on what was read before.
  double noise_n(std::int64_t time_ns) const noexcept;
  double read_n(double force_n, double noise_n) const noexcept;  // limited to the capacity, both ways
};

}  // namespace jnd
