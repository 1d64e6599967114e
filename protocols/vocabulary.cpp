#include "protocols/vocabulary.h"

namespace jnd {

namespace {

constexpr auto kSessionKinds = words<SessionKind>(
    {{"real", SessionKind::real}, {"pilot", SessionKind::pilot}, {"simulated", SessionKind::simulated}});
constexpr auto kUnits = words<StiffnessUnit>({{"N/m", StiffnessUnit::n_per_m}, {"N/rad", StiffnessUnit::n_per_rad}});
constexpr auto kUnitSuffixes =
    words<StiffnessUnit>({{"n_per_m", StiffnessUnit::n_per_m}, {"n_per_rad", StiffnessUnit::n_per_rad}});
constexpr auto kLengthSuffixes =
    words<StiffnessUnit>({{"m", StiffnessUnit::n_per_m}, {"rad", StiffnessUnit::n_per_rad}});
constexpr auto kChannels = words<Channel>({{"cutaneous", Channel::cutaneous}, {"kinaesthetic", Channel::kinaesthetic}});
constexpr auto kJudgements = words<Judgement>({{"same", Judgement::same}, {"different", Judgement::different}});
constexpr auto kEnteredBy =
    words<EnteredBy>({{"participant", EnteredBy::participant}, {"operator", EnteredBy::operator_}});

}  // namespace

std::string_view to_string(SessionKind kind) noexcept {
  return word_of(kSessionKinds, kind);
}

std::string_view to_string(StiffnessUnit unit) noexcept {
  return word_of(kUnits, unit);
}

std::string_view name_suffix(StiffnessUnit unit) noexcept {
  return word_of(kUnitSuffixes, unit);
}

std::string_view length_suffix(StiffnessUnit unit) noexcept {
  return word_of(kLengthSuffixes, unit);
}

std::string_view to_string(Channel channel) noexcept {
  return word_of(kChannels, channel);
}

std::string_view to_string(RenderingMode mode) noexcept {
  return word_of(kRenderingModeWords, mode);
}

std::string_view to_string(Judgement judgement) noexcept {
  return word_of(kJudgements, judgement);
}

std::string_view to_string(EnteredBy who) noexcept {
  return word_of(kEnteredBy, who);
}

std::string_view to_string(Fault fault) noexcept {
  return word_of(kFaultWords, fault);
}

std::optional<SessionKind> session_kind_from(std::string_view text) noexcept {
  return value_of(kSessionKinds, text);
}

std::optional<StiffnessUnit> stiffness_unit_from(std::string_view text) noexcept {
  return value_of(kUnits, text);
}

std::optional<Channel> channel_from(std::string_view text) noexcept {
  return value_of(kChannels, text);
}

std::optional<EnteredBy> entered_by_from(std::string_view text) noexcept {
  return value_of(kEnteredBy, text);
}

std::optional<Fault> fault_from(std::string_view text) noexcept {
  return value_of(kFaultWords, text);
}

std::optional<RenderingMode> rendering_mode_from(std::string_view text) noexcept {
  return value_of(kRenderingModeWords, text);
}

std::optional<Judgement> judgement_from(std::string_view text) noexcept {
  return value_of(kJudgements, text);
}

}  // namespace jnd
