// Time. The engine and the control loop see only this seam, so that hours of session pass in milliseconds in tests.
#pragma once

#include <cstdint>

namespace jnd {

// Thread rule: now_* may be called from any thread; sleep_until_ns by the thread that drives the session.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now_ns() const noexcept = 0;                 // monotonic
  virtual std::int64_t utc_ns() const noexcept = 0;                 // since 1970-01-01T00:00:00Z
  virtual void sleep_until_ns(std::int64_t deadline) noexcept = 0;  // absolute, monotonic; returns at once if past
};

class SteadyClock final : public Clock {
 public:
  std::int64_t now_ns() const noexcept override;
  std::int64_t utc_ns() const noexcept override;
  void sleep_until_ns(std::int64_t deadline) noexcept override;
};

// Sleeping is jumping. Starts at monotonic 0 and the given UTC.
class SimulatedClock final : public Clock {
 public:
  explicit SimulatedClock(std::int64_t utc_start_ns) noexcept : utc_start_ns_(utc_start_ns) {}
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  std::int64_t utc_ns() const noexcept override { return utc_start_ns_ + now_ns_; }
  void sleep_until_ns(std::int64_t deadline) noexcept override {
    if (deadline > now_ns_) now_ns_ = deadline;
  }

 private:
  std::int64_t utc_start_ns_;
  std::int64_t now_ns_ = 0;
};

}  // namespace jnd
