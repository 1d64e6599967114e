// What the control loop sums up tick by tick: what one device did to its finger in one interval, for the log, and how late
// the ticks woke.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "protocols/vocabulary.h"

namespace jnd {

// One tick of one device.
struct IntervalSample {
  double duration_s = 0;  // of the tick
  bool touching = false;
  double penetration = 0;      // m or rad
  double force_n = 0;          // delivered, measured
  bool force_reduced = false;  // a limit reduced the asked force
  bool soft_start = false;
  double vibration_g = 0;  // delivered amplitude
  bool vibration_clamped = false;
};

// Sums only; nothing allocates in add. Thread rule: the control loop's thread, then the thread that calls result().
class IntervalSummary {
 public:
  // force_commanded: whether this condition carries force on this device; without it there is no stiffness to fit.
  // path_per_penetration: travel of the fingertip against the force, m, per unit of penetration; 1 where that is in m.
  void begin(bool force_commanded, double path_per_penetration = 1) noexcept;
  void add(const IntervalSample& sample) noexcept;
  FingerPresentation result() const;

 private:
  bool force_commanded_ = false;
  double path_per_penetration_ = 1;
  bool touching_ = false;
  double previous_penetration_ = 0, previous_force_n_ = 0;
  double sum_xf_ = 0, sum_xx_ = 0, sum_ff_ = 0;
  double travel_ = 0, travel_s_ = 0, saturated_s_ = 0;
  FingerPresentation so_far_;
};

// How late the ticks of a loop woke, as percentiles and by the edges that a presentation keeps, without keeping them.

// Percentiles come of buckets of whole microseconds: lateness above kBuckets - 2 us shares the last bucket, whose
// percentile is the largest of all, which is kept exactly.
class LatenessHistogram {
 public:
  void clear() noexcept { *this = LatenessHistogram{}; }
  void add(std::int64_t lateness_ns) noexcept {
    const std::int64_t late = std::max<std::int64_t>(lateness_ns, 0);
    largest_ns_ = std::max(largest_ns_, late);
    ++counts_[static_cast<std::size_t>(std::min<std::int64_t>(late / 1000, kBuckets - 1))];
    ++total_;
    ++by_edges_[static_cast<std::size_t>(std::lower_bound(kEdges_ns.begin(), kEdges_ns.end(), late) -
                                         kEdges_ns.begin())];
  }
  // The least whole number of microseconds that at least `share` (0..1) of the ticks did not exceed, rounded down to
  // the bucket; 0 without ticks.
  double percentile_us(double share) const noexcept {
    const double wanted = share * static_cast<double>(total_);
    std::int64_t seen = 0;
    for (std::size_t bucket = 0; bucket < counts_.size(); ++bucket) {
      seen += counts_[bucket];
      if (seen > 0 && static_cast<double>(seen) >= wanted)
        return bucket + 1 < counts_.size() ? static_cast<double>(bucket) : largest_us();
    }
    return 0;
  }
  double largest_us() const noexcept { return 1e-3 * static_cast<double>(largest_ns_); }

  // Ticks by kLatenessEdges_us: entry i those later than edge i - 1 and not later than edge i; the last those later
  // than every edge.
  using ByEdges = std::array<std::int64_t, kLatenessEdges_us.size() + 1>;
  const ByEdges& by_edges() const noexcept { return by_edges_; }

 private:
  static constexpr auto kEdges_ns = [] {
    std::array<std::int64_t, kLatenessEdges_us.size()> edges{};
    for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = static_cast<std::int64_t>(kLatenessEdges_us[i] * 1000);
    return edges;
  }();
  static constexpr std::int64_t kBuckets = 2048;
  std::array<std::uint32_t, kBuckets> counts_{};
  ByEdges by_edges_{};
  std::int64_t total_ = 0, largest_ns_ = 0;
};

}  // namespace jnd
