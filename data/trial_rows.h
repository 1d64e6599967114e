// The trials of one kind of session as analyses read them, and the registered rules that leave some of them out.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/study.h"
#include "protocols/protocol.h"

namespace jnd {

// What counts and times are made of: one answered trial of the main part.
struct CountedTrial {
  int session = 0;                // place in the list of sessions given to read_counted_trials
  int series = 0, condition = 0;  // places in the protocol
  bool same = true;
  bool said_different = false;
  bool by_participant = true;
  double response_time_s = 0, duration_s = 0, saturated_share = 0;
  std::array<double, 2> asked{};                     // stiffness of the intervals, in the study's unit
  std::array<std::optional<double>, 2> delivered{};  // mean over the devices with a fitted stiffness; none without one
};

// Reasons, in the order in which they are tried; the first that applies is counted.
inline constexpr std::string_view kResponseTimeBelow = "response_time_below";
inline constexpr std::string_view kResponseTimeAbove = "response_time_above";
inline constexpr std::string_view kSaturatedShareAbove = "saturated_share_above";

// Why a trial is left out, or an empty text. Response times are judged only where the participant pressed the key: an
// operator's time says nothing about the participant.
std::string_view exclusion_reason(const Exclusions& rules, bool by_participant, double response_time_s,
                                  double saturated_share) noexcept;

// One pass over the answered main trials of `sessions`, in their order. Throws StorageError where a trial names a
// condition or series that the protocol does not have.
std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions);

}  // namespace jnd
