#include "runner/screen/screen_parts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/loop/control_loop.h"
#include "runner/screen/screen_text.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr int kFewRows = 20;  // below it what is said twice, or could be, gives way

std::string lateness_text(double latest_us) {
  if (latest_us < kTightLoop.largest_us) return tr("on time");
  return tr("late by up to {:.0f} ms", std::ceil(latest_us / 1000));
}

}  // namespace

Span span(const Area& area, int column, const std::string& text, Style style) {
  return {column, clipped(showable(text, area.unicode), area.columns - column, area.unicode), style};
}

Row filled(const Area& area, const std::string& text, Style style) {
  std::string line = clipped(" " + showable(text, area.unicode), area.columns, area.unicode);
  line.append(static_cast<std::size_t>(std::max(0, area.columns - columns_of(line))), ' ');
  return {{0, line, style}};
}

Style style_of(Tone tone) {
  switch (tone) {
    case Tone::strong:
      return kBold;
    case Tone::quiet:
      return kDim;
    case Tone::warning:
      return style_of(Shade::warning);
    case Tone::plain:
      break;
  }
  return {};
}

Style style_of(Shade shade) {
  if (shade == Shade::none) return kBold;
  return {.bold = true, .reverse = true, .shade = shade};
}

std::string bar(double share, int cells, bool unicode) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * cells));
  std::string text;
  for (int i = 0; i < cells; ++i) text += i < full ? (unicode ? "█" : "#") : (unicode ? "░" : ".");
  return text;
}

std::string elapsed_text(double seconds) {
  constexpr long kMinute_s = 60, kHour_s = 3600;
  const long whole = std::lround(std::floor(std::max(0.0, seconds)));
  if (whole < kHour_s) return fmt::format("{}:{:02}", whole / kMinute_s, whole % kMinute_s);
  return fmt::format("{}:{:02}:{:02}", whole / kHour_s, whole % kHour_s / kMinute_s, whole % kMinute_s);
}

void add_text(const Area& area, const std::string& text, Style style, std::vector<Row>& rows) {
  // Line by line, since what is showable has no line ends.
  for (const std::string& line : wrapped(text, area.columns - 2)) rows.push_back({span(area, 1, line, style)});
}

namespace {

// The three kinds differ in their words, in how they are lettered and in what fills the line.
Row banner_row(const Area& area, const SessionCard& card) {
  std::string words, fill;
  Style style;
  switch (card.kind) {
    case SessionKind::real:
      words = tr("REAL SESSION - this counts as data");
      fill = " ";
      style = style_of(Shade::real);
      break;
    case SessionKind::pilot:
      words = tr("REHEARSAL (pilot) - never counted as real data");
      fill = "/";
      style = {.bold = true, .underline = true, .shade = Shade::rehearsal};
      break;
    case SessionKind::simulated:
      words = tr("SIMULATED participant - a demonstration");
      fill = ".";
      style = {.dim = true};
      break;
  }
  if (card.unblinded) words = fmt::format("{}   {}", tr("UNBLINDED"), words);
  std::string text = fmt::format("{}{} {} ", fill, fill, words);
  for (int column = columns_of(text); column < area.columns; ++column) text += fill;
  return {span(area, 0, text, style)};
}

Row card_row(const Area& area, const ScreenModel& model) {
  const SessionCard& card = model.card;
  std::string text = tr("Participant {}", card.participant);
  if (!card.group.empty()) text += fmt::format("   {}", tr("group {}", card.group));
  if (card.sessions > 1) text += fmt::format("   {}", tr("session {} of {}", card.session, card.sessions));
  if (card.resumed) text += fmt::format("   {}", tr("resumed"));
  if (card.fast) text += "   --fast";
  Row row = {span(area, 1, text, kBold)};
  const int used = 1 + columns_of(text) + 3;
  const int room = area.columns - used - (model.clock.empty() ? 0 : columns_of(model.clock) + 3);
  if (room > 12) row.push_back({used, clipped(showable(card.title, area.unicode), room, area.unicode), kDim});
  if (!model.clock.empty()) row.push_back(span(area, area.columns - columns_of(model.clock) - 1, model.clock, kBold));
  return row;
}

// Where the trial stands, in words, or shorter where there is little room.
// letter: of the condition. Beside a question that names a condition it would say what it stands for.
std::vector<std::string> places_of(const TrialOutline& outline, bool brief, bool letter) {
  std::vector<std::string> parts;
  if (!outline.practice)
    parts.push_back(brief ? tr("block {}/{}", outline.block, outline.blocks)
                          : tr("block {} of {}", outline.block, outline.blocks));
  if (outline.practice && outline.round > 1) parts.push_back(tr("round {}", outline.round));
  if (letter && !outline.condition_code.empty()) parts.push_back(tr("condition {}", outline.condition_code));
  parts.push_back(tr("plan no. {}", outline.plan_number));
  if (outline.attempt > 1) parts.push_back(tr("attempt {}", outline.attempt));
  return parts;
}

Row trial_row(const Area& area, const ScreenModel& model) {
  if (!model.outline) {
    return {span(area, 1, tr("{} of {} trials done", model.card.trials_done, model.card.trials_total), kBold)};
  }
  const std::string head = trial_heading(*model.outline);
  const bool letter = model.page == nullptr;
  std::string rest = fmt::format("   {}", fmt::join(places_of(*model.outline, false, letter), "   "));
  if (columns_of(head) + columns_of(rest) + 1 > area.columns)
    rest = fmt::format("  {}", fmt::join(places_of(*model.outline, true, letter), "  "));
  return {span(area, 1, head, kBold), span(area, 1 + columns_of(head), rest)};
}

constexpr int kRoomForLeft = 80, kRoomForPace = 110;     // columns for "about 1 h 30 min left", for its pace
constexpr int kShortEnd = 12, kEnd = 35, kLongEnd = 49;  // columns that it takes at most

std::string end_text(const Area& area, const ScreenModel& model) {
  if (model.left.empty()) return "";
  const bool pace = model.card.fast && area.columns >= kRoomForPace;
  if (area.columns < kRoomForLeft) return tr("ends {}", model.ends);
  return pace ? tr("about {} left at full pace, ends {}", model.left, model.ends)
              : tr("about {} left, ends {}", model.left, model.ends);
}

int done_of(const std::vector<ConditionProgress>& progress) {
  int done = 0;
  for (const ConditionProgress& condition : progress) done += condition.done;
  return done;
}

int total_of(const std::vector<ConditionProgress>& progress) {
  int total = 0;
  for (const ConditionProgress& condition : progress) total += condition.total;
  return total;
}

// A condition's letter, its bar where there is room for one, and its counts.
std::string condition_text(const ConditionProgress& condition, int room, bool unicode) {
  constexpr int kLeastCells = 4, kMostCells = 20;
  const std::string counts = fmt::format("{}/{}", condition.done, condition.total);
  const int cells = std::min(kMostCells, room - columns_of(condition.code) - columns_of(counts) - 2);
  const double share = condition.total > 0 ? static_cast<double>(condition.done) / condition.total : 0;
  return cells >= kLeastCells ? fmt::format("{} {} {}", condition.code, bar(share, cells, unicode), counts)
                              : fmt::format("{} {}", condition.code, counts);
}

// All of it, then each condition, and at the right when it will be over.
Row progress_row(const Area& area, const ScreenModel& model) {
  constexpr int kGap = 3, kWholeCells = 20, kNarrowCells = 8, kWide = 100;
  const std::vector<ConditionProgress>& progress = model.progress;
  Row row;
  const std::string end = end_text(area, model);
  const int right = end.empty() ? area.columns - 1 : area.columns - columns_of(end) - 1;
  if (!end.empty()) row.push_back(span(area, right, end, kBold));
  if (total_of(progress) == 0) return row;
  const double share = static_cast<double>(done_of(progress)) / total_of(progress);
  const std::string whole = fmt::format(
      "{} {:.0f} %", bar(share, area.columns < kWide ? kNarrowCells : kWholeCells, area.unicode), 100 * share);
  row.push_back(span(area, 1, whole, kBold));
  int column = 1 + columns_of(whole) + kGap;
  // As long as the longest words at the right, so that no bar changes its length with them.
  const int kept = end.empty()                   ? 0
                   : area.columns < kRoomForLeft ? kShortEnd
                   : area.columns < kRoomForPace ? kEnd
                                                 : kLongEnd;
  const int each = (std::min(right, area.columns - kept) - column) / static_cast<int>(progress.size()) - kGap;
  for (const ConditionProgress& condition : progress) {
    const std::string text = condition_text(condition, each, area.unicode);
    if (column + columns_of(text) + 1 > right) {
      row.push_back(span(area, std::min(column, right - 3), area.unicode ? "…" : "...", kDim));
      break;
    }
    row.push_back(span(area, column, text));
    column += columns_of(text) + kGap;
  }
  return row;
}

}  // namespace

std::vector<Row> head_rows(const Area& area, const ScreenModel& model) {
  std::vector<Row> rows = {banner_row(area, model.card), card_row(area, model), trial_row(area, model),
                           progress_row(area, model)};
  if (area.rows >= kFewRows) rows.push_back(rule_row(area));
  return rows;
}

Row rule_row(const Area& area, const std::string& title) {
  std::string text = title.empty() ? "" : (area.unicode ? "── " : "-- ") + title + " ";
  for (int column = columns_of(text); column < area.columns; ++column) text += area.unicode ? "─" : "-";
  return {span(area, 0, text, kDim)};
}

namespace {

std::string counts_text(const AnswerCounts& counts) {
  std::string text = tr("voids {}", counts.voids);
  if (counts.no_contact > 0) text += fmt::format("   {}", tr("no contact {} in a row", counts.no_contact));
  return text;
}

Row answer_row(const Area& area, const ScreenModel& model) {
  const std::string counts = counts_text(model.counts);
  constexpr int kStreak = 2;  // attempts without contact, from which the operator is to look
  const Style style = model.counts.no_contact >= kStreak ? style_of(Tone::warning) : kDim;
  const Span right = span(area, area.columns - columns_of(counts) - 1, counts, style);
  if (model.answer.empty()) return {span(area, 1, tr("No answer to show"), kDim), right};
  const std::string saved = tr("Saved: {},", model.answered);
  const int from = 2 + columns_of(saved);
  Row row = {span(area, 1, saved, kDim), span(area, from, model.answer, kBold)};
  const std::string by = tr("entered by the {}", model.by);
  const int after = from + 2 + columns_of(model.answer);
  if (after + columns_of(by) + 2 < right.column) row.push_back(span(area, after, by, kDim));
  row.push_back(right);
  return row;
}

}  // namespace

std::vector<Row> status_rows(const Area& area, const ScreenModel& model) {
  std::vector<Row> rows = {answer_row(area, model)};
  if (area.rows >= kFewRows && !model.before.empty())
    rows.push_back({span(area, 1, tr("Before: {}", fmt::join(model.before, "   ")), kDim)});
  rows.push_back(health_row(area, model.health));
  return rows;
}

Row health_row(const Area& area, const std::optional<DeviceHealth>& health) {
  if (!health) return {span(area, 1, tr("Devices: nothing presented yet"), kDim)};
  Row row;
  int column = 1;
  const auto add = [&](const std::string& text, Style style) {
    row.push_back(span(area, column, text, style));
    column += columns_of(row.back().text) + 2;
  };
  if (!health->fault.empty()) add(tr("FAULT: {}", health->fault), style_of(Tone::warning));
  if (!health->presenting)
    add(tr("Devices at rest"), {});
  else
    add(health->contact ? tr("Devices at work: contact") : tr("Devices at work: no contact"), {});
  if (health->rate_hz > 0)
    add(tr("{}{:.0f} Hz, {}", health->presenting ? "" : tr("last: "), health->rate_hz,
           lateness_text(health->lateness_max_us)),
        kDim);
  return row;
}

// The keys.

namespace {

const std::string& words_of(const KeyHint& hint) {
  return hint.label.empty() ? hint.what : hint.label;
}

int width_of(const KeyHint& hint) {
  return columns_of(hint.key) + 3 + columns_of(words_of(hint));
}

void add_key(const Area& area, int column, const KeyHint& hint, Row& row) {
  const Style key = hint.stop ? style_of(Shade::stop) : hint.works ? kBold : kDim;
  row.push_back(span(area, column, fmt::format("[{}]", hint.key), key));
  row.push_back(span(area, column + columns_of(hint.key) + 3, words_of(hint), hint.works ? Style{} : kDim));
}

std::vector<Row> rows_of_keys(const Area& area, const std::vector<KeyHint>& keys, int gap) {
  if (keys.empty()) return {};
  std::vector<Row> rows(1);
  int column = 1;
  for (const KeyHint& hint : keys) {
    if (column > 1 && column + width_of(hint) > area.columns) {
      rows.emplace_back();
      column = 1;
    }
    add_key(area, column, hint, rows.back());
    column += width_of(hint) + gap;
  }
  return rows;
}

// In as few rows as they can be, and then as far apart as they can be.
std::vector<Row> packed(const Area& area, const std::vector<KeyHint>& keys) {
  constexpr int kWidest = 3;
  const std::size_t fewest = rows_of_keys(area, keys, 1).size();
  for (int gap = kWidest; gap > 1; --gap)
    if (auto rows = rows_of_keys(area, keys, gap); rows.size() == fewest) return rows;
  return rows_of_keys(area, keys, 1);
}

// What the scene asks for first; the operator's own keys below, in their places.
std::vector<Row> rows_in_places(const Area& area, const std::vector<KeyHint>& keys) {
  std::vector<KeyHint> main = keys, own;
  std::copy_if(keys.begin(), keys.end(), std::back_inserter(own), [](const KeyHint& hint) { return hint.place; });
  std::erase_if(main, [](const KeyHint& hint) { return hint.place; });
  std::vector<Row> rows = packed(area, main);
  for (Row& row : packed(area, own)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace

std::vector<Row> key_rows(const Area& area, const std::vector<KeyHint>& keys, int most) {
  std::vector<KeyHint> shown = keys;
  std::vector<Row> rows = rows_in_places(area, shown);
  const auto too_many = [&] { return static_cast<int>(rows.size()) > std::max(most, 1); };
  const auto without = [&](auto&& these) {
    std::erase_if(shown, these);
    rows = rows_in_places(area, shown);
  };
  if (too_many()) without([](const KeyHint& hint) { return !hint.works; });
  if (too_many()) without([](const KeyHint& hint) { return !hint.brief; });
  // The last one that is not the stop goes first.
  while (too_many() && shown.size() > 1) {
    const auto last = std::find_if(shown.rbegin(), shown.rend(), [](const KeyHint& hint) { return !hint.stop; });
    if (last == shown.rend()) break;
    shown.erase(std::next(last).base());
    rows = rows_in_places(area, shown);
  }
  rows.resize(std::min(rows.size(), static_cast<std::size_t>(std::max(most, 1))));
  return rows;
}

// What has happened, each line with the time of day.

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
  const std::string title = below == 0 ? tr("Log   Page Up: earlier") : tr("Log   {} later: Page Down", below);
  rows.insert(rows.begin(), rule_row(area, title));
  return rows;
}

}  // namespace jnd
