// Which keys answer a prompt: not those pressed before it was shown, nor a key that was held down since then.
#pragma once

#include <cstdint>
#include <limits>

#include "runner/key_parser.h"

namespace jnd {

enum class Heard {
  counts,
  early,  // pressed before the prompt
  held    // a repetition of a key that was down before the prompt
};

// Pure: time comes with the keys and prompts. A terminal says only that a key came, not that it was let go. A key that
// comes again within kRepeatGap_ns of its last coming is taken to be held down: keyboards wait at most that long before
// they repeat, and repeat faster.
class HeldKeys {
 public:
  static constexpr std::int64_t kRepeatGap_ns = 600'000'000;

  void prompt(std::int64_t now_ns) noexcept { prompt_ns_ = now_ns; }
  // Every key, in the order of its coming, also those that nobody waits for.
  Heard hear(const Key& key) noexcept;
  // Whether the latest key may still be down.
  bool maybe_down(std::int64_t now_ns) const noexcept { return any_ && now_ns - latest_ns_ <= kRepeatGap_ns; }

 private:
  bool any_ = false;
  Key latest_;
  std::int64_t latest_ns_ = 0;
  std::int64_t began_ns_ = 0;  // first coming of the latest key
  std::int64_t prompt_ns_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace jnd
