#include "runner/screen/screen_layout.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "runner/screen/force_pane.h"
#include "runner/screen/screen_parts.h"
#include "runner/screen/screen_text.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr int kMostKeyRows = 4;
constexpr int kLeastLog = 6;     // rows of its pane
constexpr int kLeastMiddle = 5;  // beside curves of forces
constexpr int kLeastRecent = 2;  // rows of what happened, where there is no pane

}  // namespace

std::vector<KeyHint> keys_now(const ScreenModel& model) {
  if (model.dialog) return model.dialog->keys;
  if (model.field) return {{"Enter", tr("done"), true}, {"Esc", tr("cancel"), true}, stop_hint_of_text()};
  if (model.page == nullptr) return model.scene.keys;
  const std::string enter = model.page->reviewing()           ? tr("saves the answers")
                            : model.page->items().size() == 1 ? tr("saves the answer")
                                                              : tr("next");
  std::vector<KeyHint> keys;
  if (!model.page->reviewing() && model.page->items()[model.page->at()].question->kind == Question::Kind::confirm)
    keys.push_back({"y", tr("it is so"), true});
  keys.push_back({"Enter", enter, true});
  if (model.page->at() > 0) keys.push_back({tr("up"), tr("back"), true});
  keys.push_back({"Esc", tr("leave"), true});
  keys.push_back({"Ctrl-L", model.large ? tr("usual text") : tr("large text"), false});
  keys.push_back(stop_hint_of_text());
  return keys;
}

namespace {

// The stop first, then what is asked or said, then the other keys, as much of it as there are rows.
Frame too_small(const ScreenModel& model, int rows, const Area& area) {
  const std::vector<KeyHint> keys = keys_now(model);
  std::string first;
  for (const KeyHint& hint : keys)
    if (hint.stop) first += fmt::format("{}[{}] {}", first.empty() ? "" : "   ", hint.key, hint.what);
  const std::string small = tr("too small, {} x {} needed", kLeastColumns, kLeastRows);
  constexpr int kRowsForBoth = 5;
  const bool beside = rows < kRowsForBoth || columns_of(first) + 3 + columns_of(small) <= area.columns;
  if (beside) first += "   " + small;

  const bool reading = !model.dialog && (model.page != nullptr || model.scene.to_read);
  std::string words = model.dialog  ? model.dialog->question
                      : model.field ? model.field->label + ": " + model.field->text
                      : model.stop  ? tr("STOPPED ({}). The devices are at rest.", model.stop->by)
                      : reading     ? tr("Make the window larger to read what is asked. Nothing is answered before.")
                      : !model.say.empty() && !model.scene.keys.empty() && model.scene.heading.empty()
                          ? (model.aloud ? tr("SAY") + " " : "") + model.say
                          : model.scene.heading;
  Frame frame;
  frame.rows.push_back({span(area, 0, first, style_of(Tone::warning))});
  if (!beside) frame.rows.push_back({span(area, 0, small, style_of(Tone::warning))});
  for (const std::string& line : wrapped(showable(words, area.unicode), area.columns))
    frame.rows.push_back({span(area, 0, line, model.stop ? style_of(Shade::stop) : style_of(Tone::strong))});
  const bool fits = static_cast<int>(frame.rows.size()) <= rows;
  if (!model.hint.text.empty()) frame.rows.push_back({span(area, 0, model.hint.text, style_of(model.hint.tone))});
  for (Row& row : key_rows(area, keys, std::max(1, rows - static_cast<int>(frame.rows.size()))))
    frame.rows.push_back(std::move(row));
  frame.rows.resize(static_cast<std::size_t>(std::max(rows, 1)));
  if (reading || (model.dialog && !fits)) frame.unseen = Unseen::too_small;
  return frame;
}

// What of the middle is seen, where it is longer than its room: its head and its foot stay, and what is between them is
// seen through a window.
void put_middle(const Area& area, const ScreenModel& model, const MainPart& middle, int room, Frame& frame) {
  const auto from = static_cast<int>(frame.rows.size());
  const auto wanted = static_cast<int>(middle.rows.size());
  const int scrollable = std::max(0, wanted - room);
  const int scrolled = std::min(model.scrolled, scrollable);
  const int head = std::min(static_cast<int>(middle.least), room);
  const int foot = scrollable > 0 ? std::min(static_cast<int>(middle.foot), room - head) : 0;
  const int window_end = room - foot;
  for (int i = 0; i < room; ++i) {
    const int at = i < head ? i : i < window_end ? i + scrolled : i + scrollable;
    frame.rows.push_back(at < wanted ? middle.rows[static_cast<std::size_t>(at)] : Row{});
  }
  frame.window_lines = window_end - head;
  frame.hidden_lines = scrollable - scrolled;
  if (scrollable > 0 && frame.window_lines < 1)
    frame.unseen = Unseen::too_small;
  else if (frame.hidden_lines > 0 || model.help)
    frame.unseen = Unseen::below;
  if (frame.hidden_lines > 0 && frame.window_lines > 0)
    frame.rows[static_cast<std::size_t>(from + window_end - 1)] = {span(
        area, 1,
        tr("{} more lines: {}", frame.hidden_lines + 1, model.page != nullptr ? tr("Page Down") : tr("arrow down")),
        {.reverse = true})};
  if (!middle.cursor) return;
  const int row = middle.cursor->first;
  frame.cursor = {from + (row < wanted - foot ? row : row - scrollable), middle.cursor->second};
}

void append(const std::vector<Row>& part, Frame& frame) {
  frame.rows.insert(frame.rows.end(), part.begin(), part.end());
}

}  // namespace

Frame lay_out(const ScreenModel& model, int rows, int columns, bool unicode) {
  const Area area{columns, unicode, rows};
  if (rows < kLeastRows || columns < kLeastColumns) return too_small(model, rows, area);
  Frame frame;
  frame.rows = head_rows(area, model);
  std::vector<Row> bottom = {rule_row(area)};
  for (Row& row : key_rows(area, keys_now(model), kMostKeyRows)) bottom.push_back(std::move(row));

  // The middle first; what has happened and the devices get the rest, and make way for a long text.
  const bool pane = columns >= kLogColumns && rows >= kLogRows;
  const int free = rows - static_cast<int>(frame.rows.size() + bottom.size());
  std::vector<Row> status = status_rows(area, model);
  const int kept = pane ? kLeastLog : static_cast<int>(recent_rows(area, model, kLeastRecent).size());
  const bool reads = model.page != nullptr || model.scene.to_read || model.help;
  if (model.forces != nullptr && !reads) {
    // What is drawn of them comes before messages: those are in the log.
    const int taken = static_cast<int>(status.size()) + (pane ? kept : 0) + kLeastMiddle;
    const std::vector<Row> forces = force_rows(area, *model.forces, free - taken);
    status.insert(status.begin(), forces.begin(), forces.end());
  }
  const auto least = static_cast<int>(status.size());
  // Of the first screen nothing has happened yet.
  const MainPart middle = main_part(area, model, model.first ? free : free - least - kept);
  const auto wanted = static_cast<int>(middle.rows.size());
  if (wanted + least > free) status.clear();
  const int rest = free - static_cast<int>(status.size()) - wanted;
  std::vector<Row> past;
  if (pane && rest >= kLeastLog) {
    past = log_rows(area, model, rest);
    frame.log_lines = rest - 1;
  } else {
    past = recent_rows(area, model, rest - 1);
  }
  put_middle(area, model, middle, free - static_cast<int>(status.size() + past.size()), frame);
  if (frame.log_lines > 0) {
    append(status, frame);
    append(past, frame);
  } else {
    append(past, frame);
    append(status, frame);
  }
  append(bottom, frame);
  return frame;
}

}  // namespace jnd
