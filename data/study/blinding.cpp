#include "data/study/blinding.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "data/study/study_admin.h"

namespace jnd {

namespace {

std::string counted(int count, const char* thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

}  // namespace

BlindingState blinding_of(const Study& study, const Protocol& protocol, SessionKind kind) {
  BlindingState state;
  state.planned = protocol.design.participants;
  bool any_real = false;
  std::map<std::string, int> closed;  // sessions, by participant
  for (const SessionInfo& session : study.sessions()) {
    any_real = any_real || session.kind == SessionKind::real;
    if (session.kind != SessionKind::real || session.excluded) continue;
    if (session.state != "closed")
      ++state.unfinished;
    else if (!session.ended_early)
      ++closed[session.participant];
  }
  state.finished = static_cast<int>(std::count_if(
      closed.begin(), closed.end(), [&](const auto& entry) { return entry.second >= protocol.design.sessions; }));
  state.blinded = (any_real || kind == SessionKind::real) && protocol.blinded &&
                  (state.unfinished > 0 || state.finished < state.planned) && !is_unblinded(study);
  return state;
}

bool plan_sealed(const Study& study, const Protocol& protocol) {
  if (!protocol.blinded) return false;
  const std::vector<SessionInfo> sessions = study.sessions();
  const bool of_people = sessions.empty() || std::any_of(sessions.begin(), sessions.end(), [](const SessionInfo& one) {
                           return one.kind != SessionKind::simulated;
                         });
  return of_people && blinding_of(study, protocol, SessionKind::real).blinded;
}

std::string seed_text(const Study& study, const Protocol& protocol, std::string_view sealed) {
  return plan_sealed(study, protocol) ? std::string(sealed) : std::to_string(study.info().seed);
}

std::string shown_head(const SessionInfo& session, bool sealed) {
  return sealed && session.state != "closed" ? std::string() : session.head;
}

std::string blinding_line(const BlindingState& state, const std::string& study) {
  const int missing = std::max(0, state.planned - state.finished);
  std::string ends;
  if (missing > 0) ends = counted(missing, "more finished participant");
  if (state.unfinished > 0) {
    if (!ends.empty()) ends += " and ";
    ends += fmt::format("the end of {}", counted(state.unfinished, "open session"));
  }
  return fmt::format(
      "BLINDED: {} of {} finished, {}. Conditions are in code or pooled, stimuli and seed are sealed. "
      "This ends with {}, or with: jnd unblind {} --reason \"...\"",
      state.finished, counted(state.planned, "planned participant"),
      counted(state.unfinished, "real session") + " open", ends, study);
}

}  // namespace jnd
