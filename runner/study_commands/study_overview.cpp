#include "runner/study_commands/study_overview.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>

#include "data/study/blinding.h"
#include "data/study/schema.h"
#include "data/study/study_admin.h"
#include "protocols/planning/allotment.h"
#include "runner/opening/study_access.h"

namespace jnd {

namespace {

// What the sessions of one participant come to.
struct Attendance {
  int closed = 0;
  bool open = false, early = false, excluded = false;
};

// Where all real participants were excluded, it is still a study of people.
SessionKind kind_of(const std::vector<SessionInfo>& sessions) {
  for (const SessionKind kind : {SessionKind::real, SessionKind::pilot, SessionKind::simulated})
    if (std::any_of(sessions.begin(), sessions.end(), [kind](const SessionInfo& one) { return one.kind == kind; }))
      return kind;
  return SessionKind::real;
}

void count_participants(StudyOverview& overview, int sessions_each) {
  std::map<std::string, Attendance> participants;
  for (const SessionInfo& session : overview.sessions) {
    Attendance& one = participants[session.participant];
    one.closed += session.state == "closed" ? 1 : 0;
    one.open = one.open || session.state == "open";
    one.early = one.early || session.ended_early;
    one.excluded = one.excluded || session.excluded;
  }
  for (const auto& [code, one] : participants) {
    if (one.excluded)
      ++overview.excluded;
    else if (one.early)
      ++overview.left_early;
    else if (!one.open && one.closed >= sessions_each)
      ++overview.finished;
  }
}

}  // namespace

std::vector<SessionInfo> StudyOverview::open() const {
  std::vector<SessionInfo> found;
  std::copy_if(sessions.begin(), sessions.end(), std::back_inserter(found),
               [](const SessionInfo& one) { return one.state == "open" && !one.excluded; });
  return found;
}

std::string StudyOverview::last_session() const {
  std::string last;
  for (const SessionInfo& session : sessions) last = std::max(last, session.started);
  return last;
}

StudyOverview overview_of(const Study& study) {
  const Protocol protocol = protocol_of(study);
  StudyOverview overview;
  overview.protocol = study.info().protocol_name;
  overview.title = protocol.title;
  overview.planned = protocol.design.participants;
  overview.blinded = blinding_of(study, protocol, SessionKind::real).blinded && plan_sealed(study, protocol);
  const std::vector<SessionInfo> all = study.sessions();
  overview.kind = kind_of(all);
  std::copy_if(all.begin(), all.end(), std::back_inserter(overview.sessions),
               [&](const SessionInfo& one) { return one.kind == overview.kind; });
  count_participants(overview, protocol.design.sessions);
  if (!operator_says_group(protocol)) overview.next_number = next_participant_number(all, overview.kind);
  return overview;
}

std::string state_text(const StudyOverview& overview) {
  std::string state = overview.sessions.empty()               ? "not begun"
                      : !overview.open().empty()              ? "open"
                      : overview.finished >= overview.planned ? "complete"
                                                              : "in progress";
  if (overview.blinded) state += ", blinded";
  return state;
}

bool claims_to_be_study(const std::filesystem::path& file) noexcept {
  try {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;  // a pipe would wait for its writer
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    constexpr std::size_t kPlaceOfId = 68;  // of the application's number, in the header of SQLite's files
    std::array<char, kPlaceOfId + 4> start{};
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(start.data(), start.size())) return false;
    std::uint32_t id = 0;
    for (std::size_t i = kPlaceOfId; i < start.size(); ++i) id = (id << 8U) | static_cast<unsigned char>(start[i]);
    return std::string_view(start.data(), kMagic.size()) == kMagic &&
           (id == static_cast<std::uint32_t>(kApplicationId) ||
            id == static_cast<std::uint32_t>(kApplicationIdBeforeRelease));
  } catch (...) {
    return false;
  }
}

}  // namespace jnd
