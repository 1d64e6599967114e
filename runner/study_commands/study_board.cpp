#include "runner/study_commands/study_board.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "data/fields/number_text.h"
#include "data/log/utc_time.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

constexpr int kBar = 30;  // columns
constexpr double kNanoseconds = 1e9;
constexpr std::size_t kSecond = 19;  // 2026-11-25T14:03:22

std::string bar(int done, int total) {
  const int filled = total > 0 ? std::clamp(done * kBar / total, 0, kBar) : 0;
  return fmt::format("[{}{}]", std::string(static_cast<std::size_t>(filled), '#'),
                     std::string(static_cast<std::size_t>(kBar - filled), '.'));
}

// A line of its own, "began 12 min ago". Simulated sessions have days of their own.
std::string began_text(const SessionInfo& session, std::int64_t now_utc_ns) {
  if (session.kind == SessionKind::simulated) return "";
  const double seconds = static_cast<double>(now_utc_ns - utc_ns_from(session.started)) / kNanoseconds;
  return seconds < 0 ? "" : fmt::format("                began {} ago\n", duration_text(seconds));
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
    text += fmt::format("  {}  {}  {} {} of {}, {} voided\n{}", text.empty() ? "open now    " : "            ",
                        bold(printable(one.participant)), bar(one.trials_done, one.trials_total), one.trials_done,
                        one.trials_total, one.trials_voided, began_text(one, now_utc_ns));
  if (text.empty()) return "  open now      no session\n";
  // Which of several sessions a program that writes is at, the lock does not tell.
  return text + (overview.in_use == false ? "                not running: it was closed or killed\n" : "");
}

std::string sessions_text(const StudyOverview& overview, std::size_t most, std::size_t columns) {
  std::vector<SessionInfo> sessions = overview.sessions;
  std::stable_sort(sessions.begin(), sessions.end(),
                   [](const SessionInfo& a, const SessionInfo& b) { return a.started > b.started; });
  using Align = TextTable::Align;
  TextTable table({"participant", "state", "trials", "voided", "started (UTC)"},
                  {Align::left, Align::left, Align::right, Align::right, Align::left});
  for (std::size_t i = 0; i < std::min(sessions.size(), most); ++i)
    table.add({printable(sessions[i].participant), state_text(sessions[i]),
               fmt::format("{} of {}", sessions[i].trials_done, sessions[i].trials_total),
               std::to_string(sessions[i].trials_voided), sessions[i].started.substr(0, kSecond)});
  std::string text = most == 0 || sessions.empty() ? "" : "\n" + table.text(columns);
  if (sessions.size() > most)
    text += fmt::format("  and {}\n", counted(static_cast<std::int64_t>(sessions.size() - most), "earlier session"));
  return text;
}

// A line that is wider than the screen takes several.
int lines_on_screen(const std::string& text, std::size_t columns) {
  int lines = 0;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines +=
        columns == 0 ? 1 : static_cast<int>(std::max<std::size_t>(1, (display_width(line) + columns - 1) / columns));
  return lines;
}

}  // namespace

std::string board_text(const StudyOverview& overview, const std::string& study, std::int64_t now_utc_ns, int rows,
                       std::size_t columns) {
  std::string head = fmt::format("{}: {}\n", bold(printable(study)), printable(overview.title));
  head += fmt::format("  {} sessions; {}\n\n", to_string(overview.kind), state_text(overview));
  head += fmt::format("  participants  {}\n", participants_text(overview));
  head += open_text(overview, now_utc_ns);
  head += fmt::format("  next          {}\n", next_text(overview));
  std::size_t most = overview.sessions.size();
  if (rows > 0) most = std::min(most, static_cast<std::size_t>(rows));
  for (;; --most) {
    std::string text = head + sessions_text(overview, most, columns);
    if (rows <= 0 || most == 0 || lines_on_screen(text, columns) <= rows) return text;
  }
}

}  // namespace jnd
