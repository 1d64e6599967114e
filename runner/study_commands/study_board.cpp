#include "runner/study_commands/study_board.h"

#include <algorithm>

#include <fmt/format.h>

#include "data/log/utc_time.h"
#include "runner/terminal/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

constexpr int kBar = 30;  // columns
constexpr double kNanoseconds = 1e9;
constexpr int kRowsOfTheRest = 12;   // what stands above and below the sessions
constexpr std::size_t kSecond = 19;  // 2026-11-25T14:03:22

std::string bar(int done, int total) {
  const int filled = total > 0 ? std::clamp(done * kBar / total, 0, kBar) : 0;
  return fmt::format("[{}{}]", std::string(static_cast<std::size_t>(filled), '#'),
                     std::string(static_cast<std::size_t>(kBar - filled), '.'));
}

// "; began 12 min ago". Simulated sessions have days of their own.
std::string began_text(const SessionInfo& session, std::int64_t now_utc_ns) {
  if (session.kind == SessionKind::simulated) return "";
  const double seconds = static_cast<double>(now_utc_ns - utc_ns_from(session.started)) / kNanoseconds;
  return seconds < 0 ? "" : fmt::format("; began {} ago", duration_text(seconds));
}

std::string participants_text(const StudyOverview& overview) {
  std::string text = fmt::format("{} of {} finished", overview.finished, overview.planned);
  if (overview.left_early > 0) text += fmt::format(", {} ended early", overview.left_early);
  if (overview.excluded > 0) text += fmt::format(", {} excluded", overview.excluded);
  return text;
}

std::string next_text(const StudyOverview& overview) {
  if (!overview.next_number) return "the number follows from the newcomer's group";
  return fmt::format("number {} of the plan", *overview.next_number);
}

std::string open_text(const StudyOverview& overview, std::int64_t now_utc_ns) {
  std::string text;
  for (const SessionInfo& one : overview.open())
    text += fmt::format("  {}  {}  {} {} of {}, {} voided{}\n", text.empty() ? "open now    " : "            ",
                        bold(printable(one.participant)), bar(one.trials_done, one.trials_total), one.trials_done,
                        one.trials_total, one.trials_voided, began_text(one, now_utc_ns));
  return text.empty() ? "  open now      no session\n" : text;
}

std::string sessions_text(const StudyOverview& overview, std::size_t most) {
  std::vector<SessionInfo> sessions = overview.sessions;
  std::stable_sort(sessions.begin(), sessions.end(),
                   [](const SessionInfo& a, const SessionInfo& b) { return a.started > b.started; });
  using Align = TextTable::Align;
  TextTable table({"participant", "state", "trials", "voided", "started (UTC)"},
                  {Align::left, Align::left, Align::right, Align::right, Align::left});
  for (std::size_t i = 0; i < std::min(sessions.size(), most); ++i)
    table.add({printable(sessions[i].participant), sessions[i].state,
               fmt::format("{} of {}", sessions[i].trials_done, sessions[i].trials_total),
               std::to_string(sessions[i].trials_voided), sessions[i].started.substr(0, kSecond)});
  std::string text = sessions.empty() ? "" : "\n" + table.text();
  if (sessions.size() > most)
    text += fmt::format("  and {} before\n", counted(static_cast<std::int64_t>(sessions.size() - most), "session"));
  return text;
}

}  // namespace

std::string board_text(const StudyOverview& overview, const std::string& study, std::int64_t now_utc_ns, int rows) {
  const int room = std::max(rows - kRowsOfTheRest - static_cast<int>(overview.open().size()), 1);
  const std::size_t most = rows > 0 ? static_cast<std::size_t>(room) : overview.sessions.size();
  std::string text = fmt::format("{}: {}\n", bold(printable(study)), printable(overview.title));
  text += fmt::format("  {} sessions; {}\n\n", to_string(overview.kind), state_text(overview));
  text += fmt::format("  participants  {}\n", participants_text(overview));
  text += open_text(overview, now_utc_ns);
  text += fmt::format("  next          {}\n", next_text(overview));
  return text + sessions_text(overview, most);
}

}  // namespace jnd
