// Readiness of what is on the disk and in the plan: room for the session, balance, the participant, the wall clock.
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "data/log/utc_time.h"
#include "data/study/database.h"
#include "data/verify/chain_check.h"
#include "protocols/planning/cohort.h"
#include "protocols/tasks/level_source.h"
#include "protocols/tasks/task.h"
#include "runner/opening/readiness_items.h"

namespace jnd {

namespace {

// One record of one device as telemetry stores it, compressed: what data/README.md measures, and half as much again.
constexpr double kBytesPerTick = 60;
constexpr double kTicks_per_s = 1000;
constexpr double kReach_s = 2;  // to the object, before an interval's time begins to count
constexpr std::int64_t kFirstPlausible_utc_ns = 1'735'689'600LL * 1'000'000'000;  // 2025-01-01

Check item(const char* name, std::string found) {
  return {.what = name, .verdict = Verdict::ok, .found = std::move(found)};
}

void complain(Check& check, Verdict verdict, const std::string& why, const std::string& what_to_do) {
  check.verdict = std::max(check.verdict, verdict);
  check.found += (check.found.empty() ? "" : "; ") + why;
  check.what_to_do += (check.what_to_do.empty() ? "" : "; ") + what_to_do;
}

// What chance gave this participant tells of the trials to come, even where cells are only counted.
void judge_cells(const Protocol& protocol, const Plan& plan, Check& check) {
  if (!task_of(protocol.task.kind).has_pairs()) return;
  std::map<std::pair<int, int>, std::array<int, 2>> cells;  // by series and condition: same, different
  for (const Trial& trial : plan.trials) {
    if (trial.practice) continue;
    ++cells[{trial.series, trial.condition}][trial.target == kClassSame ? 0 : 1];
  }
  const bool balanced = protocol.design.sampling == Sampling::balanced && levels_given(protocol);
  int unequal = 0, one_sided = 0;
  for (const auto& [place, cell] : cells) {
    unequal += balanced && cell[0] != cell[1] ? 1 : 0;
    one_sided += cell[0] == 0 || cell[1] == 0 ? 1 : 0;
  }
  if (unequal > 0)
    complain(check, Verdict::bad,
             fmt::format("{} of {} cells do not have as many same as different trials, as the design asks", unequal,
                         cells.size()),
             "run jnd verify; the plan is not the protocol's");
  if (one_sided > 0 && !protocol.blinded)
    complain(check, Verdict::warn,
             fmt::format("{} of {} cells have same or different trials only: d' cannot be computed there", one_sided,
                         cells.size()),
             "plan more trials per cell, or balanced sampling, in the next study");
}

}  // namespace

double telemetry_bytes(const Protocol& protocol, const Plan& plan, const RigSpec& spec) noexcept {
  double seconds = 0;
  for (const Trial& trial : plan.trials)
    seconds += static_cast<double>(trial.stimuli.size()) * (protocol.timeline.explore_s + kReach_s);
  for (const ExplorationSlot& slot : plan.explorations) seconds += slot.duration_s;
  const double devices = static_cast<double>(protocol.rig.fingers.size() * spec.devices.size());
  return seconds * kTicks_per_s * devices * kBytesPerTick;
}

Check check_session_storage(const std::filesystem::path& study, double needed_bytes, SessionKind kind) {
  Check check = check_storage(study, {.root = "/",
                                      .is_network = is_network_file_system,
                                      .syncs = 5,
                                      .real = kind == SessionKind::real,
                                      .needed_bytes = needed_bytes});
  check.what = kStorageItem;
  return check;
}

Check check_plan_balance(const Protocol& protocol, const Plan& plan) {
  const int planned = protocol.design.participants;
  Check check = item("plan", fmt::format("participant {} of {} planned, session {} of {}, {} trials", plan.participant,
                                         planned, plan.session, protocol.design.sessions, main_trial_count(plan)));
  if (!plan.explorations.empty()) check.found += fmt::format(", {} free interactions", plan.explorations.size());
  // Where the operator says the group, one may have more members than another, and numbers of the others are left out.
  if (plan.participant > planned && (protocol.groups.empty() || protocol.allotment == Allotment::balanced))
    complain(check, Verdict::warn, "more participants than the protocol plans",
             "say in the report why, or end the study here");
  if (!plan.trials.empty()) judge_cells(protocol, plan, check);
  const int balanced = balanced_at(protocol);
  if (balanced > 1 && planned % balanced != 0)
    complain(check, Verdict::warn,
             fmt::format("orders are balanced at multiples of {}, {} participants are planned", balanced, planned),
             fmt::format("plan {} participants in the next study (jnd plan --cohort shows the balance)",
                         (planned / balanced + 1) * balanced));
  return check;
}

Check check_study(const Study& study) {
  Check check = item("study", "");
  try {
    check.found = fmt::format("every hash of its {} events agrees", require_whole_chains(study).events);
  } catch (const BrokenChain& error) {
    complain(check, Verdict::bad, error.what(), "go on with a backup, or with what jnd recover makes of it");
  }
  return check;
}

Check check_participant(const std::vector<SessionInfo>& sessions, const std::string& participant, SessionKind kind,
                        const Plan& plan, int planned_sessions) {
  Check check = item(kParticipantItem, fmt::format("{}, number {}", participant, plan.participant));
  bool excluded = false;
  for (const SessionInfo& session : sessions) {
    if (session.kind != kind) continue;
    if (session.participant == participant) {
      excluded = excluded || session.excluded;
      if (session.state == "closed" && session.number == plan.session)
        complain(check, Verdict::bad,
                 fmt::format("has finished session {} of {} ({})", session.number, planned_sessions, session.ended),
                 session.number >= planned_sessions ? "use another code for the next participant"
                                                    : "begin the next session of this participant");
    } else if (session.participant_number == plan.participant && !session.replaced) {
      complain(check, Verdict::bad, fmt::format("number {} is {}'s", plan.participant, session.participant),
               "begin the session again, so that another number is given");
    } else if (session.state == "open" && !session.excluded) {
      complain(check, Verdict::warn, fmt::format("the session of {} is not finished", session.participant),
               "make sure that it is this participant who sits here");
    }
  }
  if (excluded)
    complain(check, Verdict::bad, "is excluded from this study", "use another code for the next participant");
  return check;
}

Check check_clock(const std::vector<SessionInfo>& sessions, std::int64_t utc_ns) {
  const std::string now = to_iso8601(utc_ns);
  Check check = item("clock", now.substr(0, now.find('.')) + " UTC");
  const char* set = "set the clock (timedatectl set-ntp true, or date as root)";
  if (utc_ns < kFirstPlausible_utc_ns) complain(check, Verdict::bad, "that is long past", set);
  std::string last;  // ISO 8601 in UTC: the order of the texts is that of the times
  for (const SessionInfo& session : sessions) last = std::max({last, session.started, session.ended});
  if (!last.empty() && last > now)
    complain(check, Verdict::warn,
             fmt::format("the study has a session of {}, which is to come", last.substr(0, last.find('.'))), set);
  return check;
}

}  // namespace jnd
