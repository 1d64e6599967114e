// What the full screen shows, as rows of styled text: a pure function of what is to be shown and of the window's size.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "runner/console/console.h"
#include "runner/console/console_display.h"
#include "runner/screen/screen_colours.h"

namespace jnd {

inline constexpr int kLeastColumns = 60, kLeastRows = 16;  // less shows one line that says so
inline constexpr int kLogColumns = 100, kLogRows = 30;     // from here on there is a log pane

// What happened, with the time of day. Notable: shown where there is no log pane too.
struct LogLine {
  std::string time, text;
  Tone tone = Tone::quiet;
  bool notable = false;
};

// Everything that may be on view.
struct ScreenModel {
  SessionCard card;
  std::optional<TrialOutline> outline;
  std::vector<ConditionProgress> progress;
  std::optional<DeviceHealth> health;
  const ForceTrace* forces = nullptr;  // where the operator may see them
  Scene scene;
  int scrolled = 0;  // lines of the scene's text, or of the page, above the window
  std::string say;   // to the participant, now; or what goes on
  bool aloud = false;
  Phase phase;
  std::int64_t now_ns = 0;  // of the machine's steady clock
  std::string clock;        // the time of day: "14:32"
  std::string left, ends;   // of the session: "19 min", "14:51"; empty: unknown
  std::optional<StopShown> stop;
  std::vector<std::string> queued;   // what was asked for and comes later
  std::string answered, answer, by;  // the last one: of which trial, what, and who entered it
  std::deque<std::string> before;    // attempts before the last answer, latest first: "same, 1.22 s", "void"
  AnswerCounts counts;
  std::deque<LogLine> log;     // oldest first
  std::size_t log_of_now = 0;  // the first line of what is going on: those before it are over
  int log_back = 0;            // lines of the log below its pane
  TonedLine hint;              // about the key that was just pressed
  struct Field {
    std::string label, text, before_cursor;
  };
  std::optional<Field> field;
  struct Dialog {
    std::string question;
    std::vector<KeyHint> keys;
  };
  std::optional<Dialog> dialog;
  const QuestionnairePage* page = nullptr;
  bool help = false;   // the keys that work now, over the rest
  bool large = false;  // the participant's texts in large letters
  bool first = false;  // nothing was answered yet: in large letters, whether the session counts
};

struct Style {
  bool bold = false, reverse = false, dim = false, underline = false;  // where the shade has colours, without reverse
  Shade shade = Shade::none;
  bool operator==(const Style&) const = default;
};

struct Span {
  int column = 0;
  std::string text;
  Style style;
};
using Row = std::vector<Span>;

// What keeps a text, a page or a dialog from being answered.
enum class Unseen {
  nothing,
  below,     // some of it is below the window, or not yet scrolled to
  too_small  // the window cannot show it
};

struct Frame {
  std::vector<Row> rows;
  std::optional<std::pair<int, int>> cursor;  // row and column
  int hidden_lines = 0;                       // of the scene's text or of the page, below the window
  int window_lines = 0;                       // of them, in the window
  Unseen unseen = Unseen::nothing;
  int log_lines = 0;  // of the log pane; 0: there is none
};

// The keys that are shown, of whatever asks just now.
std::vector<KeyHint> keys_now(const ScreenModel& model);
// unicode: block characters, lines and ellipses; otherwise ASCII.
Frame lay_out(const ScreenModel& model, int rows, int columns, bool unicode);

}  // namespace jnd
