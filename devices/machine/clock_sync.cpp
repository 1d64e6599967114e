#include "devices/machine/clock_sync.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr std::int64_t kWindow_ns = 1'000'000'000;
// A report that comes by this much too early, or a whole window in which the fastest comes by this much too late: a
// clock was set.
constexpr std::int64_t kStep_ns = 10'000'000;
// No two crystals differ by more: a line through few windows says nothing else.
constexpr double kMostDrift = 300e-6;
// Device times farther from the first report are those of another clock.
constexpr std::int64_t kFarthest_us = std::int64_t{10'000'000} * 1'000'000;

}  // namespace

// Device time since the first report; false where that is not sensible.
bool ClockSync::place(std::uint64_t device_us, std::int64_t& at_us) const noexcept {
  at_us = static_cast<std::int64_t>(device_us - first_us_);
  return at_us >= -kFarthest_us && at_us <= kFarthest_us;
}

void ClockSync::restart(std::uint64_t device_us, std::int64_t arrival_ns) noexcept {
  const int steps = steps_;
  *this = ClockSync{};
  steps_ = steps;
  begun_ = true;
  first_us_ = device_us;
  first_ns_ = window_began_ns_ = arrival_ns;
}

double ClockSync::line_ns(std::int64_t at_us) const noexcept {
  return level_ns_ + slope_ * 1e3 * (static_cast<double>(at_us) - centre_us_);
}

// How long the fastest report takes from the device to here.
double ClockSync::shortest_way_ns() const noexcept {
  if (trip_ns_ < 0) return 0;
  return std::clamp(line_ns(trip_at_us_) - static_cast<double>(trip_ahead_ns_), 0.0, static_cast<double>(trip_ns_));
}

void ClockSync::add_arrival(std::uint64_t device_us, std::int64_t arrival_ns) noexcept {
  std::int64_t at_us = 0;
  if (!begun_) restart(device_us, arrival_ns);
  if (!place(device_us, at_us)) {
    ++steps_;
    restart(device_us, arrival_ns);
    at_us = 0;
  }
  std::int64_t ahead_ns = arrival_ns - first_ns_ - 1000 * at_us;
  if (static_cast<double>(ahead_ns) < line_ns(at_us) - static_cast<double>(kStep_ns)) {
    ++steps_;
    restart(device_us, arrival_ns);
    at_us = ahead_ns = 0;
  }
  if (arrival_ns - window_began_ns_ >= kWindow_ns) {
    close_window();
    if (!begun_) {
      restart(device_us, arrival_ns);
      at_us = ahead_ns = 0;
    }
    window_began_ns_ = arrival_ns;
    open_ = Window{.fastest_at_us = at_us, .fastest_ahead_ns = ahead_ns};
  }
  if (ahead_ns < open_.fastest_ahead_ns) {
    open_.fastest_at_us = at_us;
    open_.fastest_ahead_ns = ahead_ns;
  }
  // The line lies below every report, also below those of the window that is still open.
  const double above_ns = line_ns(at_us) - static_cast<double>(ahead_ns);
  if (above_ns > 0) level_ns_ -= above_ns;
}

void ClockSync::add_round_trip(std::int64_t written_ns, std::uint64_t echoed_us, std::uint64_t device_us,
                               std::int64_t arrival_ns) noexcept {
  add_arrival(device_us, arrival_ns);
  std::int64_t at_us = 0;
  const auto lay_us = static_cast<std::int64_t>(device_us - echoed_us);
  if (!place(device_us, at_us) || lay_us < 0 || lay_us > kFarthest_us) return;
  const std::int64_t trip_ns = arrival_ns - written_ns - 1000 * lay_us;
  if (trip_ns < 0) return;  // the device's clock is not that exact, or it lies
  const std::int64_t ahead_ns = arrival_ns - first_ns_ - 1000 * at_us - trip_ns / 2;
  note_trip(open_, trip_ns, at_us, ahead_ns);
  if (trip_ns_ >= 0 && trip_ns >= trip_ns_) return;
  trip_ns_ = trip_ns;
  trip_at_us_ = at_us;
  trip_ahead_ns_ = ahead_ns;
}

void ClockSync::note_trip(Window& window, std::int64_t trip_ns, std::int64_t at_us,
                          std::int64_t ahead_ns) const noexcept {
  if (window.trip_ns >= 0 && trip_ns >= window.trip_ns) return;
  window.trip_ns = trip_ns;
  window.trip_at_us = at_us;
  window.trip_ahead_ns = ahead_ns;
}

// Afterwards not begun_ where a clock was set.
void ClockSync::close_window() noexcept {
  const auto fastest_ns = static_cast<double>(open_.fastest_ahead_ns);
  if (count_ > 0 && fastest_ns > line_ns(open_.fastest_at_us) + static_cast<double>(kStep_ns)) {
    ++steps_;
    begun_ = false;
    return;
  }
  windows_[next_] = open_;
  next_ = (next_ + 1) % kWindows;
  count_ = std::min(count_ + 1, kWindows);
  fit();
}

// The edge, below the mean of the times, of the lower convex hull of the windows' fastest reports: of all lines below
// them the one with the least sum of distances.
void ClockSync::fit() noexcept {
  std::array<const Window*, kWindows> hull{};
  std::size_t size = 0;
  double mean_us = 0;
  const double way_ns = shortest_way_ns();
  bool trips = false;
  const auto cross = [](const Window& a, const Window& b, const Window& c) {
    return static_cast<double>(b.fastest_at_us - a.fastest_at_us) *
               static_cast<double>(c.fastest_ahead_ns - a.fastest_ahead_ns) -
           static_cast<double>(b.fastest_ahead_ns - a.fastest_ahead_ns) *
               static_cast<double>(c.fastest_at_us - a.fastest_at_us);
  };
  for (std::size_t i = 0; i < count_; ++i) {
    const Window& window = windows_[(next_ + kWindows - count_ + i) % kWindows];
    mean_us += static_cast<double>(window.fastest_at_us) / static_cast<double>(count_);
    if (window.trip_ns >= 0 && (!trips || window.trip_ns < trip_ns_)) {
      trips = true;
      trip_ns_ = window.trip_ns;
      trip_at_us_ = window.trip_at_us;
      trip_ahead_ns_ = window.trip_ahead_ns;
    }
    // Reports out of order, or a clock that stands: no line goes through two of the same time.
    if (size > 0 && window.fastest_at_us <= hull[size - 1]->fastest_at_us) continue;
    while (size >= 2 && cross(*hull[size - 2], *hull[size - 1], window) <= 0) --size;
    hull[size++] = &window;
  }
  std::size_t right = 1;
  while (right + 1 < size && static_cast<double>(hull[right]->fastest_at_us) < mean_us) ++right;
  const Window& a = *hull[size > 1 ? right - 1 : 0];
  centre_us_ = static_cast<double>(a.fastest_at_us);
  level_ns_ = static_cast<double>(a.fastest_ahead_ns);
  slope_ = 0;
  if (size > 1) {
    const Window& b = *hull[right];
    slope_ = std::clamp(1e-3 * static_cast<double>(b.fastest_ahead_ns - a.fastest_ahead_ns) /
                            static_cast<double>(b.fastest_at_us - a.fastest_at_us),
                        -kMostDrift, kMostDrift);
  }
  for (std::size_t i = 0; i < size; ++i)  // where the slope was clamped, the line may lie above some
    level_ns_ -= std::max(0.0, line_ns(hull[i]->fastest_at_us) - static_cast<double>(hull[i]->fastest_ahead_ns));
  if (trips || trip_ns_ < 0) return;
  // No command for two minutes: the way is what it was.
  trip_at_us_ = a.fastest_at_us;
  trip_ahead_ns_ = std::llround(line_ns(trip_at_us_) - way_ns);
}

std::int64_t ClockSync::to_host_ns(std::uint64_t device_us) const noexcept {
  std::int64_t at_us = 0;
  if (!begun_ || !place(device_us, at_us)) return 0;
  return first_ns_ + 1000 * at_us + std::llround(line_ns(at_us) - shortest_way_ns());
}

double ClockSync::drift_ppm() const noexcept {
  return 1e6 * (1 / (1 + slope_) - 1);
}

double ClockSync::offset_s() const noexcept {
  if (!begun_) return 0;
  // host = first_ns + t + level + slope (t - centre) - way, t = device - first_us; solved for device at host 0.
  const double constant_s =
      1e-9 * static_cast<double>(first_ns_) +
      1e-9 * (level_ns_ - shortest_way_ns() - slope_ * 1e3 * (static_cast<double>(first_us_) + centre_us_));
  return (1e-6 * static_cast<double>(first_us_) - constant_s) / (1 + slope_);
}

double ClockSync::uncertainty_s() const noexcept {
  return trip_ns_ >= 0 ? 0.5e-9 * static_cast<double>(trip_ns_) : kInf;
}

}  // namespace jnd
