#include "runner/held_keys.h"

namespace jnd {

Heard HeldKeys::hear(const Key& key) noexcept {
  const bool again = any_ && key.same_key(latest_) && key.time_ns - latest_ns_ <= kRepeatGap_ns;
  if (!again) began_ns_ = key.time_ns;
  any_ = true;
  latest_ = key;
  latest_ns_ = key.time_ns;
  if (key.time_ns < prompt_ns_) return Heard::early;
  return began_ns_ < prompt_ns_ ? Heard::held : Heard::counts;
}

}  // namespace jnd
