// Where a flexing finger's joint is at any time: what moves a model of the McKibben finger, as a person's finger would.
#pragma once

#include <cstdint>

namespace jnd {

// Thread rule: const and safe within a tick; the control loop's thread.
class FingerFlexion {
 public:
  virtual ~FingerFlexion() = default;
  // Angle of the rocker, rad: alpha1 of the McKibben finger, at a time of the loop's clock.
  virtual double angle_rad(std::int64_t time_ns) const noexcept = 0;
};

}  // namespace jnd
