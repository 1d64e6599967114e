#include "devices/clock.h"

#include <cerrno>
#include <ctime>

namespace jnd {

namespace {
std::int64_t read_clock(clockid_t id) noexcept {
  timespec time{};
  clock_gettime(id, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}
}  // namespace

std::int64_t SteadyClock::now_ns() const noexcept {
  return read_clock(CLOCK_MONOTONIC);
}
std::int64_t SteadyClock::utc_ns() const noexcept {
  return read_clock(CLOCK_REALTIME);
}

// To an absolute deadline: a signal handler in between neither shortens the wait nor makes it drift.
void SteadyClock::sleep_until_ns(std::int64_t deadline) noexcept {
  if (deadline <= 0) return;  // long past, and not what the kernel takes
  const timespec time{static_cast<time_t>(deadline / 1'000'000'000), static_cast<long>(deadline % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

}  // namespace jnd
