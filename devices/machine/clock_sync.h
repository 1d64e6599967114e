// What time it was on the host when a device's clock showed something. Pure.
//
// Of the delays between two clocks only the shortest say much: the others were waits. In each window of a second the
// report that came fastest is kept; through those of the last two minutes goes the line that lies below all of them and
// as close as can be, whose slope is the drift. How long even the fastest report takes is half the shortest round trip
// of the windows, from a command's writing to its echo, less the time it lay in the device. Where there are no round
// trips, as with trackers, that share of the delay is unknown and taken as none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace jnd {

// Thread rule: one thread at a time. Nothing allocates or throws.
class ClockSync {
 public:
  // Another connection, or another device: what was learned is forgotten.
  void begin() noexcept { *this = ClockSync{}; }

  // A report came at arrival_ns (host) of what was true at device_us (device).
  void add_arrival(std::uint64_t device_us, std::int64_t arrival_ns) noexcept;
  // The same, where it also echoes a command: written at written_ns (host), arrived at echoed_us (device). Ignored
  // where that cannot be.
  void add_round_trip(std::int64_t written_ns, std::uint64_t echoed_us, std::uint64_t device_us,
                      std::int64_t arrival_ns) noexcept;

  // Host time of a device's time; 0 before the first report.
  std::int64_t to_host_ns(std::uint64_t device_us) const noexcept;

  // Device clock = offset + (1 + drift) * host clock.
  double offset_s() const noexcept;
  double drift_ppm() const noexcept;
  // Half the shortest round trip; infinite where there was none.
  double uncertainty_s() const noexcept;
  // How often a clock was found to have been set, and everything was learned anew.
  int steps() const noexcept { return steps_; }

 private:
  // Ahead: host clock less device clock, ns, less what it was at the first report.
  struct Window {
    std::int64_t fastest_at_us = 0, fastest_ahead_ns = 0;  // device time since the first report, and ahead at arrival
    std::int64_t trip_at_us = 0, trip_ahead_ns = 0;        // of the shortest round trip: ahead in its middle
    std::int64_t trip_ns = -1;                             // that round trip; below 0: none
  };
  static constexpr std::size_t kWindows = 120;

  bool place(std::uint64_t device_us, std::int64_t& at_us) const noexcept;
  void restart(std::uint64_t device_us, std::int64_t arrival_ns) noexcept;
  double line_ns(std::int64_t at_us) const noexcept;
  double shortest_way_ns() const noexcept;
  void close_window() noexcept;
  void fit() noexcept;
  void note_trip(Window& window, std::int64_t trip_ns, std::int64_t at_us, std::int64_t ahead_ns) const noexcept;

  bool begun_ = false;
  std::uint64_t first_us_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t window_began_ns_ = 0;
  Window open_;
  std::array<Window, kWindows> windows_{};
  std::size_t count_ = 0, next_ = 0;
  // The line: ahead = level + slope * (at - centre).
  double level_ns_ = 0, slope_ = 0, centre_us_ = 0;
  // Of the shortest round trip of all windows.
  std::int64_t trip_ns_ = -1;
  std::int64_t trip_at_us_ = 0, trip_ahead_ns_ = 0;
  int steps_ = 0;
};

}  // namespace jnd
