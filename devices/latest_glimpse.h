// The control loop's last words about itself, for whoever looks: one writer that never waits, one value, the newest.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "devices/rig.h"

namespace jnd {

// A sequence lock whose words are atomic, so that a torn reading is not undefined but seen, and read again. Without
// fences, which the thread sanitizer does not follow: every word is stored with release and loaded with acquire, so
// that a reader who meets a new word also meets the odd count before it.
//
// Thread rule: one thread at a time puts; any others look.
class LatestGlimpse {
 public:
  // Neither waits nor allocates: eight stores.
  void put(const LoopGlimpse& glimpse) noexcept {
    const std::uint32_t before = count_.load(std::memory_order_relaxed);
    count_.store(before + 1, std::memory_order_relaxed);
    const std::array<std::uint64_t, kWords> words = {std::bit_cast<std::uint64_t>(glimpse.ticks),
                                                     std::bit_cast<std::uint64_t>(glimpse.elapsed_s),
                                                     std::bit_cast<std::uint64_t>(glimpse.lateness_p99_us),
                                                     std::bit_cast<std::uint64_t>(glimpse.lateness_max_us),
                                                     std::bit_cast<std::uint64_t>(glimpse.force_n),
                                                     std::bit_cast<std::uint64_t>(glimpse.force_cap_n),
                                                     std::uint64_t{glimpse.saturated ? 1U : 0U}};
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    count_.store(before + 2, std::memory_order_release);
  }

  // The newest whole glimpse; all zero before the first. Tries again while one is being put.
  LoopGlimpse look() const noexcept {
    std::array<std::uint64_t, kWords> words{};
    for (;;) {
      const std::uint32_t before = count_.load(std::memory_order_acquire);
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (before % 2 == 0 && count_.load(std::memory_order_relaxed) == before) break;
    }
    LoopGlimpse glimpse;
    glimpse.ticks = std::bit_cast<std::int64_t>(words[0]);
    glimpse.elapsed_s = std::bit_cast<double>(words[1]);
    glimpse.lateness_p99_us = std::bit_cast<double>(words[2]);
    glimpse.lateness_max_us = std::bit_cast<double>(words[3]);
    glimpse.force_n = std::bit_cast<double>(words[4]);
    glimpse.force_cap_n = std::bit_cast<double>(words[5]);
    glimpse.saturated = words[6] != 0;
    return glimpse;
  }

 private:
  static constexpr std::size_t kWords = 7;
  std::atomic<std::uint32_t> count_{0};  // odd while a glimpse is being put
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace jnd
