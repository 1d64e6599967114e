#include "runner/console/screen_parts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/loop/loop_limits.h"
#include "runner/console/screen_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

std::string lateness_text(double latest_us) {
  if (latest_us < kTightLoop.largest_us) return "on time";
  return fmt::format("late by up to {:.0f} ms", std::ceil(latest_us / 1000));
}
}  // namespace

Span span(const Area& area, int column, const std::string& text, Style style) {
  return {column, clipped(showable(text, area.unicode), area.columns - column, area.unicode), style};
}

Style style_of(Tone tone) {
  switch (tone) {
    case Tone::strong:
      return kBold;
    case Tone::quiet:
      return kDim;
    case Tone::warning:
      return {.bold = true, .reverse = true, .colour = Style::Colour::yellow};
    case Tone::plain:
      break;
  }
  return {};
}

std::string bar(double share, int cells, bool unicode) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * cells));
  std::string text;
  for (int i = 0; i < cells; ++i) text += i < full ? (unicode ? "█" : "#") : (unicode ? "░" : ".");
  return text;
}

// The three kinds differ in their words, in how they are lettered and in what fills the line.
Row banner_row(const Area& area, const SessionCard& card) {
  std::string words, fill;
  Style style;
  switch (card.kind) {
    case SessionKind::real:
      words = " REAL SESSION - this counts as data ";
      fill = " ";
      style = {.bold = true, .reverse = true, .colour = Style::Colour::blue};
      break;
    case SessionKind::pilot:
      words = " REHEARSAL (pilot) - never counted as real data ";
      fill = "/";
      style = {.bold = true, .underline = true, .colour = Style::Colour::yellow};
      break;
    case SessionKind::simulated:
      words = " SIMULATED participant - a demonstration ";
      fill = ".";
      style = {.dim = true};
      break;
  }
  std::string text = fill + fill + words;
  while (columns_of(text) < area.columns) text += fill;
  return {span(area, 0, text, style)};
}

Row card_row(const Area& area, const SessionCard& card) {
  std::string text = fmt::format("Participant {}", card.participant);
  if (!card.group.empty()) text += fmt::format("   group {}", card.group);
  if (card.sessions > 1) text += fmt::format("   session {} of {}", card.session, card.sessions);
  if (card.resumed) text += "   resumed";
  if (card.fast) text += "   --fast";
  Row row = {span(area, 1, text, kBold)};
  const int used = 1 + columns_of(text) + 3;
  if (used + 12 < area.columns) row.push_back(span(area, used, card.title, kDim));
  return row;
}

Row trial_row(const Area& area, const ScreenModel& model) {
  if (!model.outline) {
    return {span(area, 1, fmt::format("{} of {} trials done", model.card.trials_done, model.card.trials_total))};
  }
  const TrialOutline& outline = *model.outline;
  const std::string head = trial_heading(outline);
  std::string rest;
  if (!outline.practice) rest += fmt::format("   block {} of {}", outline.block, outline.blocks);
  if (outline.practice && outline.round > 1) rest += fmt::format("   round {}", outline.round);
  if (!outline.condition_code.empty()) rest += fmt::format("   condition {}", outline.condition_code);
  if (!outline.practice) rest += fmt::format("   about {} left", duration_text(outline.time_left_s));
  if (outline.attempt > 1) rest += fmt::format("   attempt {}", outline.attempt);
  rest += fmt::format("   plan no. {}", outline.plan_number);
  return {span(area, 1, head, kBold), span(area, 1 + columns_of(head), rest)};
}

Row progress_row(const Area& area, const std::vector<ConditionProgress>& progress) {
  if (progress.empty()) return {};
  const int each = (area.columns - 1) / static_cast<int>(progress.size());
  Row row;
  int column = 1;
  for (const ConditionProgress& condition : progress) {
    const std::string counts = fmt::format("{}/{}", condition.done, condition.total);
    const int cells = std::min(20, each - columns_of(condition.code) - columns_of(counts) - 4);
    const double share = condition.total > 0 ? static_cast<double>(condition.done) / condition.total : 0;
    const std::string text = cells >= 4
                                 ? fmt::format("{} {} {}", condition.code, bar(share, cells, area.unicode), counts)
                                 : fmt::format("{} {}", condition.code, counts);
    if (column + columns_of(text) > area.columns) {
      row.push_back(span(area, std::min(column, area.columns - 3), area.unicode ? "…" : "...", kDim));
      break;
    }
    row.push_back(span(area, column, text));
    column += columns_of(text) + 3;
  }
  return row;
}

Row rule_row(const Area& area) {
  std::string text;
  for (int i = 0; i < area.columns; ++i) text += area.unicode ? "─" : "-";
  return {span(area, 0, text, kDim)};
}

Row answer_row(const Area& area, const ScreenModel& model) {
  if (model.answer.empty()) return {span(area, 1, "No answer to show", kDim)};
  const std::string saved = fmt::format("Saved: {},", model.answered);
  const int from = 2 + columns_of(saved);
  return {span(area, 1, saved, kDim), span(area, from, model.answer, kBold),
          span(area, from + 2 + columns_of(model.answer), fmt::format("entered by the {}", model.by), kDim)};
}

Row health_row(const Area& area, const std::optional<DeviceHealth>& health) {
  if (!health) return {span(area, 1, "Devices: nothing presented yet", kDim)};
  Row row;
  int column = 1;
  const auto add = [&](const std::string& text, Style style) {
    row.push_back(span(area, column, text, style));
    column += columns_of(row.back().text) + 2;
  };
  if (!health->fault.empty()) add(fmt::format("FAULT: {}", health->fault), style_of(Tone::warning));
  if (!health->presenting)
    add("Devices at rest", {});
  else
    add(health->contact ? "Devices at work: contact" : "Devices at work: no contact", {});
  if (health->rate_hz > 0)
    add(fmt::format("{}{:.0f} Hz, {}", health->presenting ? "" : "last: ", health->rate_hz,
                    lateness_text(health->lateness_max_us)),
        kDim);
  return row;
}

namespace {

int width_of(const KeyHint& hint) {
  return columns_of(hint.key) + 3 + columns_of(hint.what);
}

std::vector<Row> rows_of_keys(const Area& area, const std::vector<KeyHint>& keys) {
  std::vector<Row> rows(1);
  int column = 1;
  for (const KeyHint& hint : keys) {
    if (column > 1 && column + width_of(hint) > area.columns) {
      rows.emplace_back();
      column = 1;
    }
    rows.back().push_back(span(area, column, fmt::format("[{}]", hint.key), kBold));
    rows.back().push_back(span(area, column + columns_of(hint.key) + 3, hint.what));
    column += width_of(hint) + 3;
  }
  return rows;
}

}  // namespace

std::vector<Row> key_rows(const Area& area, const std::vector<KeyHint>& keys, int most) {
  std::vector<KeyHint> shown = keys;
  std::vector<Row> rows = rows_of_keys(area, shown);
  const auto too_many = [&] { return static_cast<int>(rows.size()) > std::max(most, 1); };
  if (too_many()) {
    std::erase_if(shown, [](const KeyHint& hint) { return !hint.brief; });
    rows = rows_of_keys(area, shown);
  }
  // The last one that is not the stop goes first.
  while (too_many() && shown.size() > 1) {
    const auto last = std::find_if(shown.rbegin(), shown.rend(), [](const KeyHint& hint) { return !hint.stop; });
    if (last == shown.rend()) break;
    shown.erase(std::next(last).base());
    rows = rows_of_keys(area, shown);
  }
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(std::max(most, 1))));
  return rows;
}

}  // namespace jnd
