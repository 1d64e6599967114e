// The crystal of a virtual device: its timer runs beside the machine's monotonic clock, and may be a little slow.
#pragma once

#include <cmath>
#include <cstdint>

namespace jnd {

class DeviceClock {
 public:
  explicit DeviceClock(std::int64_t real_ns) noexcept : real_ns_(real_ns) {}

  // From that instant on the timer is so many parts per million slow; negative: fast.
  void slow(double ppm, std::int64_t real_ns) noexcept {
    timer_ns_ = timer_ns(real_ns);
    real_ns_ = real_ns;
    rate_ = 1 - 1e-6 * ppm;
  }
  std::int64_t timer_ns(std::int64_t real_ns) const noexcept {
    return timer_ns_ + std::llround(rate_ * static_cast<double>(real_ns - real_ns_));
  }
  std::int64_t real_ns(std::int64_t timer_ns) const noexcept {
    return real_ns_ + std::llround(static_cast<double>(timer_ns - timer_ns_) / rate_);
  }

 private:
  std::int64_t real_ns_, timer_ns_ = 0;
  double rate_ = 1;  // of the timer by the real clock
};

}  // namespace jnd
