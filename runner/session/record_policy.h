// How much of a presentation is kept beside its result (--record).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "devices/rigs/rig_factory.h"

namespace jnd {

enum class RecordPolicy {
  off,     // results only
  events,  // also every fault, with its cause and the ticks that led to it
  full     // also every tick of every presentation
};

std::string_view to_string(RecordPolicy policy) noexcept;
std::optional<RecordPolicy> record_policy_from(std::string_view text) noexcept;

// Throws UsageError.
RecordPolicy record_policy_of(const std::string& text);
RealtimePolicy realtime_policy_of(const std::string& text);

// The options of a rig that can record so much.
RigOptions rig_options(RecordPolicy policy, const Protocol& protocol, const RigDescription& rig) noexcept;

}  // namespace jnd
