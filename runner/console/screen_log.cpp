// What has happened, each line with the time of day: a pane where there is room, the latest lines elsewhere.
#include <algorithm>

#include <fmt/format.h>

#include "runner/console/screen_parts.h"
#include "runner/console/screen_text.h"

namespace jnd {

namespace {

std::vector<Row> rows_of(const Area& area, const LogLine& line, Style style) {
  std::vector<Row> rows;
  const int from = 1 + columns_of(line.time) + 2;
  for (const std::string& part : wrapped(line.text, area.columns - from - 1)) {
    Row row;
    if (rows.empty()) row.push_back(span(area, 1, line.time, kDim));
    row.push_back(span(area, from, part, style));
    rows.push_back(std::move(row));
  }
  return rows;
}

Style style_in_log(const LogLine& line) {
  if (!line.notable) return kDim;
  return line.tone == Tone::warning || line.tone == Tone::strong ? kBold : Style{};
}

}  // namespace

std::vector<Row> recent_rows(const Area& area, const ScreenModel& model, int room) {
  constexpr std::size_t kMost = 4;
  std::vector<Row> rows;
  std::size_t shown = 0;
  for (std::size_t i = model.log.size(); i > model.log_of_now && shown < kMost; --i) {
    const LogLine& line = model.log[i - 1];
    if (!line.notable) continue;
    const bool latest = shown++ == 0;
    const std::vector<Row> event =
        rows_of(area, line, latest && line.tone == Tone::warning ? style_of(Tone::strong) : style_of(Tone::quiet));
    if (static_cast<int>(rows.size() + event.size()) > room) break;
    rows.insert(rows.begin(), event.begin(), event.end());
  }
  return rows;
}

std::vector<Row> log_rows(const Area& area, const ScreenModel& model, int room) {
  const auto lines = static_cast<std::size_t>(std::max(0, room - 1));
  const std::size_t below = std::min(static_cast<std::size_t>(std::max(0, model.log_back)), model.log.size());
  std::vector<Row> rows;
  for (std::size_t i = model.log.size() - below; i > 0 && rows.size() < lines; --i) {
    const std::vector<Row> event = rows_of(area, model.log[i - 1], style_in_log(model.log[i - 1]));
    rows.insert(rows.begin(), event.begin(), event.end());
  }
  if (rows.size() > lines) rows.erase(rows.begin(), rows.end() - static_cast<std::ptrdiff_t>(lines));
  rows.resize(lines);
  const std::string title = below == 0 ? "Log   Page Up: earlier" : fmt::format("Log   {} later: Page Down", below);
  rows.insert(rows.begin(), rule_row(area, title));
  return rows;
}

}  // namespace jnd
