// The board of a study: what stands on it, and that it fits its window.
#include "runner/study_commands/study_board.h"

#include <algorithm>

#include <fmt/format.h>

#include "runner/study_commands/study_overview.h"
#include "runner/terminal/terminal.h"
#include "tests/catch.h"

namespace jnd {
namespace {

StudyOverview overview_with(int sessions) {
  StudyOverview overview;
  overview.title = "Stiffness by force and by vibration";
  overview.planned = 24;
  overview.finished = sessions - 1;
  overview.next_number = sessions + 1;
  for (int i = 1; i <= sessions; ++i) {
    SessionInfo session;
    session.participant = fmt::format("P{:02}", i);
    session.kind = SessionKind::real;
    session.state = i == sessions ? "open" : "closed";
    session.trials_total = 40;
    session.trials_done = i == sessions ? 10 : 40;
    session.started = fmt::format("2026-11-{:02}T09:00:00.000000000Z", i);
    overview.sessions.push_back(session);
  }
  return overview;
}

constexpr std::int64_t kTenPastNine_ns = 1'794'906'600'000'000'000;  // 2026-11-17T09:10:00Z

// Lines of a screen, on which a long one takes several.
int lines_of(const std::string& text, std::size_t columns) {
  int lines = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = text.find('\n', from);
    const std::size_t width = display_width(text.substr(from, to - from));
    lines += static_cast<int>(std::max<std::size_t>(1, (width + columns - 1) / columns));
    from = to + 1;
  }
  return lines;
}

TEST_CASE("The board says who is at it, since when, and what comes next") {
  const std::string text = board_text(overview_with(17), "s.sqlite", kTenPastNine_ns, 0, 0);
  INFO(text);
  CHECK(text.starts_with("s.sqlite: Stiffness by force and by vibration\n"));
  CHECK(text.find("16 of 24 finished") != std::string::npos);
  CHECK(text.find("P17  [#######.......................] 10 of 40, 0 voided\n                began 10 min ago\n") !=
        std::string::npos);
  CHECK(text.find("number 18 of the plan") != std::string::npos);
  CHECK(text.find("P01") > text.find("P16"));  // the latest first
}

TEST_CASE("The board says where an open session has no program") {
  StudyOverview overview = overview_with(17);
  const auto says = [&overview] {
    return board_text(overview, "s.sqlite", kTenPastNine_ns, 0, 0).find("not running") != std::string::npos;
  };
  CHECK_FALSE(says());  // nobody looked
  overview.in_use = true;
  CHECK_FALSE(says());
  overview.in_use = false;
  CHECK(says());
  overview.sessions.pop_back();
  CHECK_FALSE(says());
}

TEST_CASE("The board fits its window, and leaves out the oldest sessions for it") {
  for (const int sessions : {1, 5, 17})
    for (const std::size_t columns : {40, 60, 80, 120})
      for (int rows = 12; rows <= 50; ++rows) {
        StudyOverview overview = overview_with(sessions);
        overview.in_use = false;
        const std::string text = board_text(overview, "s.sqlite", kTenPastNine_ns, rows, columns);
        INFO(text);
        CHECK(lines_of(text, columns) <= rows);
        CHECK(text.find("open now") != std::string::npos);
      }
  CHECK(board_text(overview_with(17), "s.sqlite", kTenPastNine_ns, 20, 80).find("earlier sessions") !=
        std::string::npos);
}

}  // namespace
}  // namespace jnd
