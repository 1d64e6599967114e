// Parts of the screen: each gives the rows that it needs.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runner/screen/screen_layout.h"

namespace jnd {

// How wide the window is and what it can show.
struct Area {
  int columns = 80;
  bool unicode = true;
  int rows = 24;
};

inline constexpr Style kBold{.bold = true}, kDim{.dim = true};

Span span(const Area& area, int column, const std::string& text, Style style = {});
// The text from column 1, and the style to the edges of the window.
Row filled(const Area& area, const std::string& text, Style style);
Style style_of(Tone tone);
// Bold and in reverse, in its colours where there are some.
Style style_of(Shade shade);
// A bar of `cells` cells; share 0..1.
std::string bar(double share, int cells, bool unicode);
// "0:42", "1:05:00".
std::string elapsed_text(double seconds);
// At each line end, and where the window ends.
void add_text(const Area& area, const std::string& text, Style style, std::vector<Row>& rows);

// Who takes part and how far the session is: always on view.
std::vector<Row> head_rows(const Area& area, const ScreenModel& model);
Row rule_row(const Area& area, const std::string& title = "");
// Answers and devices.
std::vector<Row> status_rows(const Area& area, const ScreenModel& model);
Row health_row(const Area& area, const std::optional<DeviceHealth>& health);
// At most so many rows: where there is too little room the less important keys are left out, the stop never.
std::vector<Row> key_rows(const Area& area, const std::vector<KeyHint>& keys, int most);
// Where there is no pane for it: the latest of what is notable and not over, in at most so many rows.
std::vector<Row> recent_rows(const Area& area, const ScreenModel& model, int room);
// The log, the latest last, in exactly so many rows, a title among them.
std::vector<Row> log_rows(const Area& area, const ScreenModel& model, int room);

// The middle: what to do and to say now, a dialog, a text, a page. cursor: its row within the part, and its column.
struct MainPart {
  std::vector<Row> rows;
  std::optional<std::pair<int, int>> cursor;
  std::size_t least = 0;  // rows from the top that must be seen
  std::size_t foot = 0;   // rows from the end that must be seen; what is between may be scrolled
};
// room: rows that letters and texts may take without making others give way.
MainPart main_part(const Area& area, const ScreenModel& model, int room);

}  // namespace jnd
