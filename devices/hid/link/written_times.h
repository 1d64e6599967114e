// When the last commands were written, to compare with their echoes.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace jnd {

// Thread rule: one thread notes, one looks up. Nothing allocates or waits.
class WrittenTimes {
 public:
  static constexpr std::size_t kKept = 256;

  // sequence: not 0.
  void note(std::uint32_t sequence, std::int64_t time_ns) noexcept {
    Entry& entry = entries_[sequence % kKept];
    entry.sequence.store(0, std::memory_order_release);
    entry.time_ns.store(time_ns, std::memory_order_release);
    entry.sequence.store(sequence, std::memory_order_release);
  }
  // False where it was never noted, or long ago.
  bool find(std::uint32_t sequence, std::int64_t& time_ns) const noexcept {
    const Entry& entry = entries_[sequence % kKept];
    if (sequence == 0 || entry.sequence.load(std::memory_order_acquire) != sequence) return false;
    const std::int64_t found = entry.time_ns.load(std::memory_order_acquire);
    if (entry.sequence.load(std::memory_order_acquire) != sequence) return false;
    time_ns = found;
    return true;
  }
  void clear() noexcept {
    for (Entry& entry : entries_) entry.sequence.store(0, std::memory_order_release);
  }

 private:
  struct Entry {
    std::atomic<std::uint32_t> sequence{0};
    std::atomic<std::int64_t> time_ns{0};
  };
  std::array<Entry, kKept> entries_{};
};

}  // namespace jnd
