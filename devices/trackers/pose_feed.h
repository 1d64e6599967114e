// What trackers share whose poses come as a stream: the newest pose of each finger for the loop, and what the stream
// was like for people.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "devices/loop/governor.h"
#include "devices/loop/newest_slot.h"
#include "devices/machine/clock_sync.h"
#include "devices/tracker.h"
#include "devices/trackers/pose_line.h"

namespace jnd {

// A pose whose time lies further ahead of its arrival is refused, ns: the source's clock is wrong.
inline constexpr std::int64_t kMostAhead_ns = 20'000'000;
// A finger whose newest pose is older has none, ns: the governor gives no force on it.
inline constexpr std::int64_t kOldestPose_ns = kMaxAge_ns;
// Slowest stream of a finger that a session can rest on, 1/s: 20 ms apart.
inline constexpr double kLeastPoseRate_hz = 50;

// Delays as percentiles without keeping them: in steps of 50 us to 102 ms, the largest exactly.
class DelayHistogram {
 public:
  void add(std::int64_t delay_ns) noexcept;
  double percentile_ms(double share) const noexcept;  // rounded down to the step; 0 without any
  double largest_ms() const noexcept { return 1e-6 * static_cast<double>(largest_ns_); }

 private:
  static constexpr std::int64_t kStep_ns = 50'000;
  static constexpr std::size_t kSteps = 2048;
  std::array<std::int64_t, kSteps> counts_{};
  std::int64_t total_ = 0, largest_ns_ = 0;
};

class PoseFeed {
 public:
  // fingers: as in $.rig.fingers; their order is the loop's. Poses of other fingers are let pass unused.
  PoseFeed(const std::vector<std::string>& fingers, const Eigen::Isometry3d& to_world);

  // -- the source's thread only; nothing allocates ------------------------------------------------------------------

  // The source begins (anew): its numbering and its clock are not those of before.
  void begin() noexcept;
  // clock: whose time the pose has. What is refused is counted: a time that lies ahead, or is not newer than that of
  // the finger's pose before. Returns whether it was taken.
  bool take(const PoseLine& pose, PoseClock clock, std::int64_t arrival_ns) noexcept;
  // A line or report that was no pose.
  void refuse() noexcept;

  // -- the loop's thread ----------------------------------------------------------------------------------------------

  // The newest pose, with the time it was true: it grows stale without a newer one. False where there has been none.
  bool read(int finger, FingerPose& pose) noexcept;

  // -- any thread -----------------------------------------------------------------------------------------------------

  // Adds the numbers of the stream: poses, gaps, refused, rate, latency, longest wait.
  void add_to(TrackerReport& report) const;
  // The first finger without a pose younger than kOldestPose_ns, in the operator's words; empty: all have one.
  std::string missing(std::int64_t now_ns) const;

 private:
  struct Slot {  // a FingerPose that can be copied word by word
    std::array<double, 3> position{};
    std::array<double, 9> axes{};  // column by column
    double flexion = 0;
    std::int64_t time_ns = 0;
    std::int64_t any = 0;
  };
  struct Stream {
    bool any = false;                        // a pose, ever
    bool lost = false;                       // by the source's own word, since the last pose
    std::int64_t time_ns = 0;                // of the last pose, on the source's clock
    std::int64_t true_ns = 0;                // the same on ours
    std::optional<std::int64_t> arrival_ns;  // of the last pose of this run
    std::int64_t waits = 0, waited_ns = 0;   // between poses, while they came
  };
  std::int64_t on_our_clock_ns(std::int64_t source_ns, std::int64_t arrival_ns) noexcept;
  void count_sequence(const PoseLine& pose) noexcept;
  void count_wait(Stream& stream, std::int64_t arrival_ns) noexcept;

  std::vector<std::string> fingers_;
  std::array<int, kFingerNames.size()> places_{};  // of each named finger in fingers_; -1: not worn
  Eigen::Isometry3d to_world_;
  std::vector<NewestSlot<Slot>> slots_;
  ClockSync clock_;

  mutable std::mutex mutex_;  // never the loop's
  std::vector<Stream> streams_;
  DelayHistogram delays_;
  std::optional<std::uint32_t> sequence_;  // the last one
  std::int64_t poses_ = 0, gaps_ = 0, refused_ = 0, longest_wait_ns_ = 0;
};

}  // namespace jnd
