// The newest of a series of values, from one thread to one other, neither of which ever waits for the other: not even
// where one has a real-time priority and has interrupted the other in the middle of it, on the same processor. There a
// sequence lock, whose reader tries again while it is written to, would try for ever.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace jnd {

// Three places: the writer's, the reader's, and one between them that they swap for.
// Thread rule: one thread at a time puts, one at a time looks. Nothing allocates, locks or tries again.
template <typename Value>
class NewestSlot {
 public:
  void put(const Value& value) noexcept {
    values_[writers_] = value;
    writers_ = between_.exchange(static_cast<std::uint8_t>(writers_ | kFresh), std::memory_order_acq_rel) & kPlace;
  }

  // The newest whole value; Value{} before the first. Valid until the next look.
  const Value& look() noexcept {
    if ((between_.load(std::memory_order_relaxed) & kFresh) != 0)
      readers_ = between_.exchange(readers_, std::memory_order_acq_rel) & kPlace;
    return values_[readers_];
  }

 private:
  static constexpr std::uint8_t kPlace = 3, kFresh = 4;
  std::array<Value, 3> values_{};
  std::atomic<std::uint8_t> between_{1};
  std::uint8_t writers_ = 0, readers_ = 2;
};

}  // namespace jnd
