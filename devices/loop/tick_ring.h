// The last ticks of a loop, overwritten in a circle: what led to a stop.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "protocols/tick_record.h"

namespace jnd {

// Thread rule: the control loop's thread. Nothing in next() allocates.
class TickRing {
 public:
  static constexpr std::size_t kSize = 512;  // more than kTicksBeforeStop of each of four devices
  void clear() noexcept { written_ = 0; }
  TickRecord& next() noexcept { return records_[written_++ % kSize]; }
  // Oldest first, at most `most` of them.
  std::vector<TickRecord> in_order(std::size_t most = kSize) const {
    std::vector<TickRecord> records;
    for (std::size_t i = written_ - std::min({written_, kSize, most}); i < written_; ++i)
      records.push_back(records_[i % kSize]);
    return records;
  }

 private:
  std::array<TickRecord, kSize> records_{};
  std::size_t written_ = 0;
};

}  // namespace jnd
