// How late the ticks of a loop woke, as percentiles, without keeping them: a histogram of whole microseconds.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace jnd {

// Lateness above kBuckets - 1 us shares the last bucket; the largest is kept exactly.
class LatenessHistogram {
 public:
  void clear() noexcept { *this = LatenessHistogram{}; }
  void add(std::int64_t lateness_ns) noexcept {
    const std::int64_t late = std::max<std::int64_t>(lateness_ns, 0);
    largest_ns_ = std::max(largest_ns_, late);
    ++counts_[static_cast<std::size_t>(std::min<std::int64_t>(late / 1000, kBuckets - 1))];
    ++total_;
  }
  // The least whole number of microseconds that at least `share` (0..1) of the ticks did not exceed, rounded down to
  // the bucket; 0 without ticks.
  double percentile_us(double share) const noexcept {
    const double wanted = share * static_cast<double>(total_);
    std::int64_t seen = 0;
    for (std::size_t bucket = 0; bucket < counts_.size(); ++bucket) {
      seen += counts_[bucket];
      if (seen > 0 && static_cast<double>(seen) >= wanted) return static_cast<double>(bucket);
    }
    return 0;
  }
  double largest_us() const noexcept { return 1e-3 * static_cast<double>(largest_ns_); }

 private:
  static constexpr std::int64_t kBuckets = 2048;
  std::array<std::uint32_t, kBuckets> counts_{};
  std::int64_t total_ = 0, largest_ns_ = 0;
};

}  // namespace jnd
