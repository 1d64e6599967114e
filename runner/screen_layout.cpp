#include "runner/screen_layout.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "runner/screen_parts.h"
#include "runner/screen_text.h"

namespace jnd {

namespace {

constexpr std::size_t kMostPast = 4;
constexpr int kMostKeyRows = 3;

Frame too_small(const ScreenModel& model, int rows, const Paper& paper) {
  Frame frame;
  frame.rows.resize(static_cast<std::size_t>(std::max(rows, 1)));
  frame.rows[0] = {span(
      paper, 0,
      fmt::format("{} x {}: too small ({} x {}). The session goes on.", paper.columns, rows, kLeastColumns, kLeastRows),
      style_of(Tone::warning))};
  const std::vector<KeyHint>& keys = model.dialog ? model.dialog->keys : model.scene.keys;
  if (rows > 1) frame.rows[1] = {span(paper, 0, model.dialog ? model.dialog->question : model.scene.heading)};
  if (rows > 2) frame.rows[2] = key_rows(paper, keys, 1).front();
  return frame;
}

// The latest of what has happened, as much as there is room for.
std::vector<Row> past_rows(const Paper& paper, const ScreenModel& model, int room) {
  std::vector<Row> rows;
  for (std::size_t back = 1; back <= std::min(model.past.size(), kMostPast); ++back) {
    const TonedLine& line = model.past[model.past.size() - back];
    const Style style = back == 1 && line.tone == Tone::warning ? style_of(Tone::strong) : style_of(Tone::quiet);
    std::vector<Row> event;
    for (const std::string& part : wrapped(line.text, paper.columns - 2))
      event.push_back({span(paper, 1, part, style)});
    if (static_cast<int>(rows.size() + event.size()) > room) break;
    rows.insert(rows.begin(), event.begin(), event.end());
  }
  return rows;
}

std::vector<KeyHint> keys_now(const ScreenModel& model) {
  if (model.dialog) return model.dialog->keys;
  if (model.field) return {{"Enter", "done", true}, {"Esc", "cancel", true}};
  if (model.page == nullptr) return model.scene.keys;
  if (model.page->reviewing())
    return {{"Enter", "saves the answers", true}, {"up", "back", true}, {"Esc", "leave", true}};
  const char* enter = model.page->items().size() == 1 ? "saves the answer" : "next";
  if (model.page->at() == 0) return {{"Enter", enter, true}, {"Esc", "leave", true}};
  return {{"Enter", enter, true}, {"up", "back", true}, {"Esc", "leave", true}};
}

}  // namespace

Frame lay_out(const ScreenModel& model, int rows, int columns, bool unicode) {
  const Paper paper{columns, unicode, rows};
  if (rows < kLeastRows || columns < kLeastColumns) return too_small(model, rows, paper);
  std::vector<Row> top = {banner_row(paper, model.card), card_row(paper, model.card), trial_row(paper, model)};
  top.push_back(progress_row(paper, model.progress));
  top.push_back(rule_row(paper));

  std::vector<Row> bottom = {rule_row(paper)};
  for (Row& row : key_rows(paper, keys_now(model), kMostKeyRows)) bottom.push_back(std::move(row));

  // The middle first; what has happened and the devices get the rest, and make way for a long text.
  MainPart middle = main_part(paper, model);
  const int free = rows - static_cast<int>(top.size() + bottom.size());
  const int wanted = static_cast<int>(middle.rows.size());
  std::vector<Row> status;
  const bool text_first = wanted + 2 > free;
  if (!text_first) status = {answer_row(paper, model), health_row(paper, model.health)};
  const std::vector<Row> past = past_rows(paper, model, free - wanted - static_cast<int>(status.size()) - 1);

  Frame frame;
  frame.rows = std::move(top);
  const auto main_from = static_cast<int>(frame.rows.size());
  const int main_rows = free - static_cast<int>(status.size() + past.size());
  const int scrollable = std::max(0, wanted - main_rows);
  const int scrolled = std::min(model.scrolled, scrollable);
  // The head and the foot of the middle stay; what is between them is seen through a window.
  const int head = std::min(static_cast<int>(middle.least), main_rows);
  const int foot = scrollable > 0 ? std::min(static_cast<int>(middle.foot), main_rows - head) : 0;
  const int window_end = main_rows - foot;
  for (int i = 0; i < main_rows; ++i) {
    const int from = i < head ? i : i < window_end ? i + scrolled : i + scrollable;
    frame.rows.push_back(from < wanted ? middle.rows[static_cast<std::size_t>(from)] : Row{});
  }
  frame.window_lines = window_end - head;
  frame.hidden_lines = scrollable - scrolled;
  if (frame.hidden_lines > 0 && frame.window_lines > 0)
    frame.rows[static_cast<std::size_t>(main_from + window_end - 1)] = {span(
        paper, 1,
        fmt::format("{} more lines: {}", frame.hidden_lines + 1, model.page != nullptr ? "Page Down" : "arrow down"),
        {.reverse = true})};
  if (middle.cursor) {
    const int row = middle.cursor->first;
    frame.cursor = {main_from + (row < wanted - foot ? row : row - scrollable), middle.cursor->second};
  }
  for (const std::vector<Row>* part : {&past, &std::as_const(status), &std::as_const(bottom)})
    frame.rows.insert(frame.rows.end(), part->begin(), part->end());
  return frame;
}

}  // namespace jnd
