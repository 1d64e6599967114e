// The trials of one kind of session as analyses read them, and the registered rules that leave some of them out.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "data/log/trial_body.h"
#include "data/study/study.h"
#include "protocols/protocol.h"

namespace jnd {

// Reasons, in the order in which they are tried; the first that applies is counted.
inline constexpr std::string_view kResponseTimeBelow = "response_time_below";
inline constexpr std::string_view kResponseTimeAbove = "response_time_above";
inline constexpr std::string_view kSaturatedShareAbove = "saturated_share_above";
inline constexpr std::string_view kOffPrescription = "off_prescription";

// Why a trial is left out, or an empty text. Response times are judged only where the participant pressed the key: an
// operator's time says nothing about the participant.
std::string_view exclusion_reason(const Exclusions& rules, bool by_participant, double response_time_s,
                                  double saturated_share, bool off_prescription) noexcept;
std::string_view exclusion_reason(const Exclusions& rules, const CountedTrial& trial) noexcept;

// By session: seq of the answers that were taken back.
std::map<std::string, std::set<std::int64_t>> taken_back_of(const Study& study);

// One pass over the file: the answered main trials of `sessions`, without answers that were taken back; those of one
// session are in the order in which they were answered. Throws StorageError where a trial names a condition or series
// that the protocol does not have.
std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions);

}  // namespace jnd
