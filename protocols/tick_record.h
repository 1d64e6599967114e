// What one device asked, got and measured at one tick of the control loop: the record that telemetry is made of, and
// that says what led to a stop.
#pragma once

#include <array>
#include <cstdint>

namespace jnd {

// Plain data of fixed size, so that it passes through a ring without allocation. data/log/telemetry.h stores it.
struct TickRecord {
  std::int64_t time_ns = 0;      // of the loop's monotonic clock
  std::int64_t lateness_ns = 0;  // of this tick's wake-up, >= 0; 0 on the simulated clock
  std::int32_t channel = 0;      // place in Presentation::fingers
  std::uint32_t limits = 0;      // bits of namespace limit: what the governor did
  double penetration = 0;        // m, or rad at a joint
  double asked_n = 0, given_n = 0, measured_n = 0;
  double vibration_g = 0;            // amplitude given
  double travel = 0;                 // of the device: platform height in m, or joint angle in rad
  std::array<double, 3> finger_m{};  // position of the fingertip in the world
};

}  // namespace jnd
