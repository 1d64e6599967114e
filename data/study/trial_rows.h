// The trials of one kind of session as analyses read them, and the registered rules that leave some of them out.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
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

using WithTrial = std::function<void(const CountedTrial&)>;

// One pass over the file, which holds one trial at a time: the answered main trials of `sessions`, without answers that
// were taken back, in the order of the file; in a file whose chains are whole, those of one session are in the order in
// which they were answered. `with` must not ask the study for anything. Throws StorageError where a trial names a
// condition or series that the protocol does not have.
void for_counted_trials(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions,
                        const WithTrial& with);

// All of them at once, some 230 bytes each. Those of one session are in the order in which they were answered, whatever
// the file's is.
std::vector<CountedTrial> read_counted_trials(const Study& study, const Protocol& protocol,
                                              const std::vector<SessionInfo>& sessions);

// The trials of some sessions for analyses that go through them more than once: held, where people are few enough to be
// looked at one by one, else read again at every pass, so that memory does not grow with the trials. What it is made of
// must outlive it.
class CountedTrials {
 public:
  CountedTrials(const Study& study, const Protocol& protocol, const std::vector<SessionInfo>& sessions, bool held);
  bool are_held() const noexcept { return held_.has_value(); }
  const std::vector<CountedTrial>& held() const { return held_.value(); }
  // As for_counted_trials().
  void for_each(const WithTrial& with) const;

 private:
  const Study& study_;
  const Protocol& protocol_;
  const std::vector<SessionInfo>& sessions_;
  std::optional<std::vector<CountedTrial>> held_;
};

}  // namespace jnd
