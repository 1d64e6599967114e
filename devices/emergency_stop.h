// The latch that stops a rig: set from anywhere, cleared only by name.
#pragma once

#include <atomic>
#include <string_view>

#include "analysis/numerics/words.h"

namespace jnd {

enum class StopSource : int { none, program, signal, key, button };

constexpr std::string_view to_string(StopSource source) noexcept {
  constexpr auto kWords = words<StopSource>({{"none", StopSource::none},
                                             {"program", StopSource::program},
                                             {"signal", StopSource::signal},
                                             {"key", StopSource::key},
                                             {"button", StopSource::button}});
  return word_of(kWords, source);
}

// Thread rule: every member from any thread, latch also from a signal handler. While latched, a rig gives no force
// within two ticks and presents nothing; only clear() ends that, and nothing in the loop calls it.
class EmergencyStop {
 public:
  // The first source is kept until the latch is cleared; only that a person's key or button outranks what came from the
  // program or a signal, which the program may take back by itself.
  void latch(StopSource source) noexcept {
    StopSource now = this->source();
    while (rank(now) < rank(source) && !source_.compare_exchange_weak(now, source, std::memory_order_acq_rel)) {
    }
  }
  // Clears the latch only where it is set by `expected`; says whether it was.
  bool clear_if(StopSource expected) noexcept {
    return source_.compare_exchange_strong(expected, StopSource::none, std::memory_order_acq_rel);
  }
  void clear() noexcept { source_.store(StopSource::none, std::memory_order_release); }
  bool latched() const noexcept { return source() != StopSource::none; }
  StopSource source() const noexcept { return source_.load(std::memory_order_acquire); }

 private:
  static constexpr int rank(StopSource source) noexcept {
    return source == StopSource::none ? 0 : source == StopSource::key || source == StopSource::button ? 2 : 1;
  }

  std::atomic<StopSource> source_{StopSource::none};
  static_assert(std::atomic<StopSource>::is_always_lock_free, "a signal handler sets it");
};

}  // namespace jnd
