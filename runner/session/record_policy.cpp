#include "runner/session/record_policy.h"

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "runner/terminal/exit_code.h"

namespace jnd {

namespace {

constexpr auto kPolicies =
    words<RecordPolicy>({{"off", RecordPolicy::off}, {"events", RecordPolicy::events}, {"full", RecordPolicy::full}});

}  // namespace

std::string_view to_string(RecordPolicy policy) noexcept {
  return word_of(kPolicies, policy);
}

std::optional<RecordPolicy> record_policy_from(std::string_view text) noexcept {
  return value_of(kPolicies, text);
}

RecordPolicy record_policy_of(const std::string& text) {
  if (const std::optional<RecordPolicy> policy = record_policy_from(text)) return *policy;
  throw UsageError(fmt::format("--record {} is not known: off, events or full", text));
}

RealtimePolicy realtime_policy_of(const std::string& text) {
  if (const std::optional<RealtimePolicy> policy = parse_realtime_policy(text)) return *policy;
  throw UsageError(fmt::format("--realtime {} is not known: off, prefer or require", text));
}

RigOptions rig_options(RecordPolicy policy, const Protocol& protocol, const RigDescription& rig) noexcept {
  RigOptions options;
  if (policy == RecordPolicy::full) options.telemetry_ticks = telemetry_ticks(protocol, rig.spec);
  return options;
}

}  // namespace jnd
