// Notices a force sensor that has stopped telling: its reading stays the same to the last bit while the force that is
// given to the device goes up or down.
#pragma once

#include <algorithm>
#include <cstdint>

namespace jnd {

// Thread rule: the control loop's thread. Nothing allocates.
class SensorWatch {
 public:
  // A change of force that a working sensor must notice: ten times the resolution of a cheap 8-bit one over 5 N.
  static constexpr double kChange_n = 0.5;
  // How long it may take: the valve and muscle of a McKibben finger answer within 100 ms.
  static constexpr std::int64_t kPatience_ns = 150'000'000;

  void begin() noexcept { *this = SensorWatch{}; }

  // given_n: what the governor let through at this tick. True where the reading is no longer to be believed.
  bool stuck(double measured_n, double given_n, std::int64_t now_ns) noexcept {
    if (!seen_ || measured_n != measured_n_) {
      seen_ = true;
      measured_n_ = measured_n;
      lowest_n_ = highest_n_ = given_n;
      changed_ns_ = -1;
      return false;
    }
    lowest_n_ = std::min(lowest_n_, given_n);
    highest_n_ = std::max(highest_n_, given_n);
    if (highest_n_ - lowest_n_ <= kChange_n) return false;
    if (changed_ns_ < 0) changed_ns_ = now_ns;
    return now_ns - changed_ns_ > kPatience_ns;
  }

 private:
  bool seen_ = false;
  double measured_n_ = 0, lowest_n_ = 0, highest_n_ = 0;
  std::int64_t changed_ns_ = -1;  // since when the reading ought to have moved
};

}  // namespace jnd
