#include "runner/keys/held_keys.h"

#include <algorithm>

namespace jnd {

Heard HeldKeys::hear(const Key& key) {
  std::erase_if(chains_, [&](const Chain& chain) {
    return !chain.may_go_on(key.time_ns) || (!chain.repeats() && !key.same_key(chain.key));
  });
  auto chain = std::find_if(chains_.begin(), chains_.end(), [&](const Chain& one) { return key.same_key(one.key); });
  if (chain == chains_.end()) chain = chains_.insert(chain, {key, key.time_ns, key.time_ns});
  chain->latest_ns = key.time_ns;
  if (key.time_ns < prompt_ns_) return Heard::early;
  return chain->first_ns < prompt_ns_ ? Heard::held : Heard::counts;
}

bool HeldKeys::maybe_down(std::int64_t now_ns) const noexcept {
  return std::any_of(chains_.begin(), chains_.end(), [&](const Chain& chain) { return chain.may_go_on(now_ns); });
}

}  // namespace jnd
