// Parts of the screen: each gives the rows that it needs.
#pragma once

#include <string>
#include <vector>

#include "runner/console/screen_layout.h"

namespace jnd {

// How wide the window is and what it can show.
struct Area {
  int columns = 80;
  bool unicode = true;
  int rows = 24;
};

inline constexpr Style kBold{.bold = true}, kDim{.dim = true};

Span span(const Area& area, int column, const std::string& text, Style style = {});
Style style_of(Tone tone);
// A bar of `cells` cells; share 0..1.
std::string bar(double share, int cells, bool unicode);

Row banner_row(const Area& area, const SessionCard& card);
Row card_row(const Area& area, const SessionCard& card);
Row trial_row(const Area& area, const ScreenModel& model);
Row progress_row(const Area& area, const std::vector<ConditionProgress>& progress);
Row rule_row(const Area& area);
Row answer_row(const Area& area, const ScreenModel& model);
Row health_row(const Area& area, const std::optional<DeviceHealth>& health);
// At most so many rows: where there is too little room the less important keys are left out, the stop never.
std::vector<Row> key_rows(const Area& area, const std::vector<KeyHint>& keys, int most);

// The middle: what to do and to say now, a dialog, a text, a page. cursor: its row within the part, and its column.
struct MainPart {
  std::vector<Row> rows;
  std::optional<std::pair<int, int>> cursor;
  std::size_t least = 0;  // rows from the top that must be seen
  std::size_t foot = 0;   // rows from the end that must be seen; what is between may be scrolled
};
MainPart main_part(const Area& area, const ScreenModel& model);
MainPart page_part(const Area& area, const QuestionnairePage& page);

}  // namespace jnd
