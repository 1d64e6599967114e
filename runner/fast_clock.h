// A clock for quick rehearsals: a person's thinking takes real time, waiting takes none.
#pragma once

#include "devices/clock.h"

namespace jnd {

class FastClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override { return steady_.now_ns() + skipped_ns_; }
  std::int64_t utc_ns() const noexcept override { return steady_.utc_ns() + skipped_ns_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    const std::int64_t wait = deadline - now_ns();
    if (wait > 0) skipped_ns_ += wait;
  }

 private:
  SteadyClock steady_;
  std::int64_t skipped_ns_ = 0;
};

}  // namespace jnd
