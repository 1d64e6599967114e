// Which keys answer a prompt: not those pressed before it was shown, nor a key that was held down since then.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "runner/keys/key_parser.h"

namespace jnd {

enum class Heard {
  counts,
  early,  // pressed before the prompt
  held    // a repetition of a key that was down before the prompt
};

// Pure: time comes with the keys and prompts. A terminal says only that a key came, not that it was let go. A key that
// comes again soon enough is taken to be held down. One that repeats is so also where other keys came in between, as of
// a second keyboard; one that came once is not: who types s, space, s within a second has let go of s.
class HeldKeys {
 public:
  // From a key's first coming to its first repetition: X11 waits 660 ms unless told otherwise, keyboards of a console
  // up to 1000 ms. Then they repeat faster; the slowest repeat every 500 ms.
  static constexpr std::int64_t kFirstGap_ns = 1'100'000'000, kRepeatGap_ns = 600'000'000;

  void prompt(std::int64_t now_ns) noexcept { prompt_ns_ = now_ns; }
  // Every key, in the order of its coming, also those that are not waited for.
  Heard hear(const Key& key);
  // Whether any key may still be down.
  bool maybe_down(std::int64_t now_ns) const noexcept;

 private:
  struct Chain {
    Key key;
    std::int64_t first_ns = 0, latest_ns = 0;
    bool repeats() const noexcept { return latest_ns != first_ns; }
    bool may_go_on(std::int64_t now_ns) const noexcept {
      return now_ns - latest_ns <= (repeats() ? kRepeatGap_ns : kFirstGap_ns);
    }
  };
  std::vector<Chain> chains_;  // of the keys that may be down
  std::int64_t prompt_ns_ = std::numeric_limits<std::int64_t>::min();
};

}  // namespace jnd
