// What the full screen shows, as rows of styled text: a pure function of what is to be shown and of the window's size.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "runner/console/console.h"
#include "runner/console/console_display.h"

namespace jnd {

inline constexpr int kLeastColumns = 60, kLeastRows = 16;  // less shows one line that says so

// Everything that may be on view.
struct ScreenModel {
  SessionCard card;
  std::optional<TrialOutline> outline;
  std::vector<ConditionProgress> progress;
  std::optional<DeviceHealth> health;
  Scene scene;
  int scrolled = 0;  // lines of the scene's text, or of the page, above the window
  std::string say;   // to the participant, now; or what goes on
  bool aloud = false;
  std::string answered, answer, by;  // the last one: of which trial, what, and who entered it
  std::deque<TonedLine> past;        // notes, voided trials: oldest first
  TonedLine hint;                    // about the key that was just pressed
  struct Countdown {
    std::string what;
    double left_s = 0, total_s = 0;
  };
  std::optional<Countdown> countdown;
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
};

struct Style {
  bool bold = false, reverse = false, dim = false, underline = false;
  enum class Colour { none, blue, yellow, cyan } colour = Colour::none;  // never the only carrier of meaning
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
};

// unicode: block characters, lines and ellipses; otherwise ASCII.
Frame lay_out(const ScreenModel& model, int rows, int columns, bool unicode);

}  // namespace jnd
