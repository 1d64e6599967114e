#include "runner/console/screen_layout.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "runner/console/screen_parts.h"
#include "runner/console/screen_text.h"

namespace jnd {

namespace {

constexpr std::size_t kMostPast = 4;
constexpr int kMostKeyRows = 3;

std::vector<KeyHint> keys_now(const ScreenModel& model) {
  if (model.dialog) return model.dialog->keys;
  if (model.field) return {{"Enter", "done", true}, {"Esc", "cancel", true}, stop_hint_of_text()};
  if (model.page == nullptr) return model.scene.keys;
  const char* const enter = model.page->reviewing()           ? "saves the answers"
                            : model.page->items().size() == 1 ? "saves the answer"
                                                              : "next";
  std::vector<KeyHint> keys = {{"Enter", enter, true}};
  if (model.page->at() > 0) keys.push_back({"up", "back", true});
  keys.push_back({"Esc", "leave", true});
  keys.push_back(stop_hint_of_text());
  return keys;
}

// The stop first, then what is asked or said, then the other keys, as much of it as there are rows.
Frame too_small(const ScreenModel& model, int rows, const Area& area) {
  const std::vector<KeyHint> keys = keys_now(model);
  std::string first;
  for (const KeyHint& hint : keys)
    if (hint.stop) first += fmt::format("[{}] {}   ", hint.key, hint.what);
  first += fmt::format("too small, {} x {} needed", kLeastColumns, kLeastRows);

  const bool reading = !model.dialog && (model.page != nullptr || model.scene.to_read);
  std::string words = model.dialog  ? model.dialog->question
                      : model.field ? model.field->label + ": " + model.field->text
                      : reading     ? "Make the window larger to read what is asked. "
                                      "Nothing is answered before."
                      : !model.say.empty() && !model.scene.keys.empty() && model.scene.heading.empty()
                          ? (model.aloud ? "SAY " : "") + model.say
                          : model.scene.heading;
  Frame frame;
  frame.rows.push_back({span(area, 0, first, style_of(Tone::warning))});
  for (const std::string& line : wrapped(showable(words, area.unicode), area.columns))
    frame.rows.push_back({span(area, 0, line, style_of(Tone::strong))});
  const bool fits = static_cast<int>(frame.rows.size()) <= rows;
  if (!model.hint.text.empty()) frame.rows.push_back({span(area, 0, model.hint.text, style_of(model.hint.tone))});
  for (Row& row : key_rows(area, keys, std::max(1, rows - static_cast<int>(frame.rows.size()))))
    frame.rows.push_back(std::move(row));
  frame.rows.resize(static_cast<std::size_t>(std::max(rows, 1)));
  if (reading || (model.dialog && !fits)) frame.unseen = Unseen::too_small;
  return frame;
}

// The latest of what has happened, as much as there is room for.
std::vector<Row> past_rows(const Area& area, const ScreenModel& model, int room) {
  std::vector<Row> rows;
  for (std::size_t back = 1; back <= std::min(model.past.size(), kMostPast); ++back) {
    const TonedLine& line = model.past[model.past.size() - back];
    const Style style = back == 1 && line.tone == Tone::warning ? style_of(Tone::strong) : style_of(Tone::quiet);
    std::vector<Row> event;
    for (const std::string& part : wrapped(line.text, area.columns - 2)) event.push_back({span(area, 1, part, style)});
    if (static_cast<int>(rows.size() + event.size()) > room) break;
    rows.insert(rows.begin(), event.begin(), event.end());
  }
  return rows;
}

}  // namespace

Frame lay_out(const ScreenModel& model, int rows, int columns, bool unicode) {
  const Area area{columns, unicode, rows};
  if (rows < kLeastRows || columns < kLeastColumns) return too_small(model, rows, area);
  std::vector<Row> top = {banner_row(area, model.card), card_row(area, model.card), trial_row(area, model)};
  top.push_back(progress_row(area, model.progress));
  top.push_back(rule_row(area));

  std::vector<Row> bottom = {rule_row(area)};
  for (Row& row : key_rows(area, keys_now(model), kMostKeyRows)) bottom.push_back(std::move(row));

  // The middle first; what has happened and the devices get the rest, and make way for a long text.
  MainPart middle = main_part(area, model);
  const int free = rows - static_cast<int>(top.size() + bottom.size());
  const int wanted = static_cast<int>(middle.rows.size());
  std::vector<Row> status;
  const bool text_first = wanted + 2 > free;
  if (!text_first) status = {answer_row(area, model), health_row(area, model.health)};
  const std::vector<Row> past = past_rows(area, model, free - wanted - static_cast<int>(status.size()) - 1);

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
  if (scrollable > 0 && frame.window_lines < 1)
    frame.unseen = Unseen::too_small;
  else if (frame.hidden_lines > 0)
    frame.unseen = Unseen::below;
  if (frame.hidden_lines > 0 && frame.window_lines > 0)
    frame.rows[static_cast<std::size_t>(main_from + window_end - 1)] = {span(
        area, 1,
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
