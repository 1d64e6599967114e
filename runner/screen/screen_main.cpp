// The middle of the screen: what to do and to say now, a stop, a dialog, a text, a page of questions, the keys.
#include <algorithm>

#include <fmt/format.h>

#include "protocols/input/utf8.h"
#include "runner/keys/line_editor.h"
#include "runner/screen/large_letters.h"
#include "runner/screen/screen_parts.h"
#include "runner/screen/screen_text.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr int kRoomy = 20;  // rows of a window from which lines are kept free
constexpr int kEdge = 1;    // columns beside large letters

// A text for the participant: line by line in large letters, where they were asked for and the line has room for them.
void add_participant_text(const Area& area, const std::string& text, Style style, bool large, std::vector<Row>& rows) {
  if (!large) return add_text(area, text, style, rows);
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, to - from);
    from = to + 1;
    const auto letters = large_text(line, area.columns - 2 * kEdge, LetterSize::half, area.unicode);
    if (!letters) {
      add_text(area, line, kBold, rows);
      continue;
    }
    for (const std::string& row : *letters) rows.push_back({span(area, kEdge, row, style)});
  }
}

void add_field(const Area& area, const ScreenModel::Field& field, MainPart& part) {
  std::string label = field.label.empty() ? "> " : field.label + ": ";
  part.rows.emplace_back();
  if (columns_of(label) > area.columns / 2) {  // a long label has a line of its own
    part.rows.back().push_back(span(area, 1, label, kBold));
    part.rows.emplace_back();
    label = "> ";
  }
  const int from = 1 + columns_of(label);
  part.rows.back().push_back(span(area, 1, label, kBold));
  // The end of a long line is what is being typed.
  const int room = area.columns - from - 1;
  std::string text = showable(field.text, area.unicode);
  int cursor = columns_of(showable(field.before_cursor, area.unicode));
  std::u32string whole = code_points(text);
  while (cursor >= room && !whole.empty()) {
    cursor -= columns_of(to_utf8(whole.substr(0, 1)));
    whole.erase(0, 1);
  }
  part.rows.back().push_back(span(area, from, to_utf8(whole), {.underline = true}));
  part.cursor = {static_cast<int>(part.rows.size()) - 1, from + cursor};
}

// Both ends labelled, with the whole scale between them where it has few steps.
void add_scale(const Area& area, const Question& question, std::vector<Row>& rows) {
  std::string scale = fmt::format("{:g} ... {:g}", question.min, question.max);
  if (question.max - question.min <= 10) {
    scale.clear();
    for (int step = static_cast<int>(question.min); step <= static_cast<int>(question.max); ++step)
      scale += fmt::format("{}{}", scale.empty() ? "" : "  ", step);
  }
  const int labels = columns_of(question.low_label) + columns_of(question.high_label);
  if (labels + columns_of(scale) + 8 <= area.columns) {
    const int middle = 1 + columns_of(question.low_label) + 3;
    rows.push_back({span(area, 1, question.low_label, kDim), span(area, middle, scale, kBold),
                    span(area, middle + columns_of(scale) + 3, question.high_label, kDim)});
    return;
  }
  rows.push_back({span(area, 1, scale, kBold)});
  add_text(area, fmt::format("{:g} = {}", question.min, question.low_label), {}, rows);
  add_text(area, fmt::format("{:g} = {}", question.max, question.high_label), {}, rows);
}

void add_question(const Area& area, const QuestionnairePage& page, bool large, MainPart& part) {
  const QuestionnairePage::Item& item = page.items()[page.at()];
  const Question& question = *item.question;
  std::string place;
  if (page.items().size() > 1) place = tr("Question {} of {}   ", page.at() + 1, page.items().size());
  if (!item.about.empty()) place += tr("about condition: {}   ", item.about);
  if (!question.required) place += tr("may be left empty");
  if (!place.empty()) part.rows.push_back({span(area, 1, place, kDim)});
  part.least = part.rows.size();
  add_participant_text(area, question.text, kBold, large, part.rows);
  if (question.kind == Question::Kind::rating) add_scale(area, question, part.rows);
  if (question.kind == Question::Kind::number)
    part.rows.push_back({span(area, 1, tr("a number from {:g} to {:g}", question.min, question.max), kDim)});
  for (std::size_t i = 0; i < question.options.size(); ++i) {
    const std::size_t first = part.rows.size();
    const std::string& option = i < question.shown.size() ? question.shown[i] : question.options[i];
    if (large) {
      add_participant_text(area, fmt::format("{} {}", i + 1, option), {}, large, part.rows);
      continue;
    }
    for (const std::string& line : wrapped(option, area.columns - 5)) part.rows.push_back({span(area, 4, line)});
    part.rows[first].insert(part.rows[first].begin(), span(area, 1, fmt::format("{}", i + 1), kBold));
  }
  const std::string label = question.kind == Question::Kind::confirm  ? tr("y once it is so, then Enter")
                            : question.kind == Question::Kind::choice ? tr("Number")
                                                                      : tr("Answer");
  const std::size_t before = part.rows.size();
  add_field(area, {label, page.editor().text(), page.editor().before_cursor()}, part);
  part.foot = part.rows.size() - before;
}

void add_review(const Area& area, const QuestionnairePage& page, MainPart& part) {
  part.rows.push_back({span(area, 1, tr("Please look through the answers"), kBold)});
  add_field(area,
            {tr("Enter saves them, a number changes that one"), page.editor().text(), page.editor().before_cursor()},
            part);
}

MainPart page_part(const Area& area, const QuestionnairePage& page, bool large) {
  MainPart part;
  if (page.reviewing())
    add_review(area, page, part);
  else
    add_question(area, page, large, part);
  if (!page.mistake().empty()) part.rows.push_back({span(area, 1, page.mistake(), style_of(Tone::warning))});
  if (!page.reviewing()) {
    part.foot += page.mistake().empty() ? 0 : 1;
    return part;
  }
  part.least = part.rows.size();
  for (std::size_t i = 0; i < page.items().size(); ++i) {
    const QuestionnairePage::Item& item = page.items()[i];
    const std::string question =
        item.about.empty() ? item.question->text : fmt::format("{} ({})", item.question->text, item.about);
    const std::string number = fmt::format("{:>2}. ", i + 1);
    const std::string reply = showable(page.shown_reply(i), area.unicode);
    const int room = std::clamp(columns_of(reply) + 2, 6, area.columns / 2);
    part.rows.push_back({span(area, 1, number), span(area, area.columns - room, reply, kBold)});
    part.rows.back().push_back(
        {5, clipped(showable(question, area.unicode), area.columns - room - 6, area.unicode), {}});
  }
  return part;
}

// What goes on now.

double elapsed_s(std::int64_t since_ns, std::int64_t now_ns) {
  return since_ns == 0 ? 0 : static_cast<double>(now_ns - since_ns) * 1e-9;
}

// "2 s", "1:05".
std::string time_of(const ScreenModel& model) {
  const Phase& phase = model.phase;
  if (phase.left_s) return duration_text(std::ceil(*phase.left_s));
  if (phase.since_ns != 0) return elapsed_text(elapsed_s(phase.since_ns, model.now_ns));
  return "";
}

// The word, why it lasts, its bar and its time.
Row phase_row(const Area& area, const ScreenModel& model) {
  const Phase& phase = model.phase;
  Row row;
  int column = 1;
  const auto add = [&](const std::string& text, Style style) {
    if (text.empty()) return;
    row.push_back(span(area, column, text, style));
    column += columns_of(row.back().text) + 2;
  };
  add(fmt::format(" {} ", phase.word), style_of(phase.shade));
  if (phase.left_s && phase.total_s > 0) {
    add(bar(*phase.left_s / phase.total_s, area.columns / 3, area.unicode), {});
    add(tr("{} left", time_of(model)), kBold);
  } else if (phase.since_ns != 0) {
    add(tr("for {}", time_of(model)), kBold);
  }
  if (phase.left_s && phase.since_ns != 0) add(tr("for {}", elapsed_text(elapsed_s(phase.since_ns, model.now_ns))), {});
  add(phase.more, {});
  return row;
}

void add_large(const Area& area, const std::vector<std::string>& letters, Style style, std::vector<Row>& rows) {
  for (const std::string& row : letters) rows.push_back(filled(area, row, style));
}

// The words to say, as large as there is room: to be read at a glance.
void add_say(const Area& area, const ScreenModel& model, int room, std::vector<Row>& rows) {
  const Style style = style_of(model.phase.shade == Shade::question ? Shade::question : Shade::say);
  const auto letters = largest_text(model.say, area.columns - 2 * kEdge, room, area.unicode);
  if (letters && model.aloud) return add_large(area, *letters, style, rows);
  if (!model.aloud) {
    rows.push_back({span(area, 1, model.say, kBold)});
    return;
  }
  for (const std::string& line : wrapped(showable(model.say, area.unicode), area.columns - 8))
    rows.push_back({span(area, 1, tr("SAY"), kBold), span(area, 5, "  " + line + "  ", style)});
}

void add_scene_heading(const Area& area, const Scene& scene, std::vector<Row>& rows) {
  Row heading;
  if (!scene.task.empty())
    heading.push_back(span(area, 1, scene.task, kBold));
  else if (!scene.heading.empty())
    heading.push_back(span(area, 1, scene.heading, style_of(scene.tone)));
  if (!scene.beside.empty() && scene.task.empty())
    heading.push_back(span(area, heading.empty() ? 1 : 4 + columns_of(heading.front().text), scene.beside, kDim));
  if (!heading.empty()) rows.push_back(std::move(heading));
}

// What is asked just now, and what became of the last keys.
void add_asked(const Area& area, const ScreenModel& model, MainPart& part) {
  if (!model.queued.empty())
    part.rows.push_back({span(area, 1, tr("queued: {}", fmt::join(model.queued, ", ")), kBold)});
  if (model.dialog) add_text(area, model.dialog->question, style_of(Tone::warning), part.rows);
  if (model.field) add_field(area, *model.field, part);
  if (model.hint.text.empty()) return;
  for (const std::string& line : wrapped(model.hint.text, area.columns - 2))
    part.rows.push_back({span(area, 1, line, style_of(model.hint.tone))});
}

int lines_of_text(const Area& area, const std::string& text) {
  return text.empty() ? 0 : static_cast<int>(wrapped(text, area.columns - 2).size()) + 1;
}

// Red from edge to edge, until it is cleared. What to do then gives way to the word where there is little room.
MainPart stop_part(const Area& area, const ScreenModel& model, int room) {
  const Style style = style_of(Shade::stop);
  MainPart part, asked;
  add_asked(area, model, asked);
  const std::string by = model.stop->by.empty() ? "" : fmt::format(" ({})", model.stop->by);
  const std::string words = tr("STOPPED{}  {} ago. The devices are at rest.", by,
                               elapsed_text(elapsed_s(model.stop->since_ns, model.now_ns)));
  int left = room - 1 - static_cast<int>(asked.rows.size());
  if (const auto letters = largest_text(tr("STOP"), area.columns - 2 * kEdge, left, area.unicode))
    add_large(area, *letters, style, part.rows);
  else
    part.rows.push_back(filled(area, tr("STOP"), style));
  part.rows.push_back(filled(area, words, style));
  left -= static_cast<int>(part.rows.size()) - 1;
  const std::vector<std::string> text = wrapped(model.scene.text, area.columns - 2);
  if (!model.dialog && !model.field && !model.scene.text.empty() && static_cast<int>(text.size()) <= left)
    for (const std::string& line : text) part.rows.push_back(filled(area, line, style));
  const auto before = static_cast<int>(part.rows.size());
  if (asked.cursor) part.cursor = {asked.cursor->first + before, asked.cursor->second};
  part.rows.insert(part.rows.end(), asked.rows.begin(), asked.rows.end());
  part.least = part.rows.size();
  return part;
}

MainPart help_part(const Area& area, const ScreenModel& model) {
  MainPart part;
  if (model.stop) part.rows.push_back({span(area, 1, tr("STOPPED: the devices are at rest"), style_of(Shade::stop))});
  constexpr int kGap = 2, kLeastWidth = 8;
  const std::string heading = tr("Keys of this screen");
  part.rows.push_back(
      {span(area, 1, heading, kBold), span(area, 1 + columns_of(heading) + kGap + 1, tr("any key goes back"), kDim)});
  part.least = part.rows.size();
  std::vector<KeyHint> keys = keys_now(model);
  if (std::none_of(keys.begin(), keys.end(), [](const KeyHint& hint) { return hint.key == "Ctrl-C"; }))
    keys.push_back({"Ctrl-C", tr("pauses; twice: ends the session safely"), false});
  int width = kLeastWidth;
  for (const KeyHint& hint : keys) width = std::max(width, columns_of(hint.key) + 2);
  for (const KeyHint& hint : keys) {
    const std::string indent(static_cast<std::size_t>(width - columns_of(hint.key) - 2), ' ');
    part.rows.push_back({span(area, 1, fmt::format("{}[{}]", indent, hint.key), hint.works ? kBold : kDim),
                         span(area, 1 + width + kGap, hint.works ? hint.what : tr("{} (not now)", hint.what),
                              hint.works ? Style{} : kDim)});
  }
  part.rows.push_back({span(area, 1, tr("Keys pressed before a prompt, or held down since, do not count."), kDim)});
  return part;
}

MainPart questions_part(const Area& area, const ScreenModel& model) {
  MainPart part = page_part(area, *model.page, model.large);
  if (model.hint.text.empty()) return part;
  const Row hint = {span(area, 1, model.hint.text, style_of(model.hint.tone))};
  if (part.foot > 0) {
    part.rows.push_back(hint);
    ++part.foot;
  } else {
    part.rows.insert(part.rows.begin() + static_cast<std::ptrdiff_t>(part.least++), hint);
  }
  return part;
}

// The phase in a line, and where there is room for it too in large letters, which do where the line has nothing more.
void add_phase(const Area& area, const ScreenModel& model, int room, std::vector<Row>& rows) {
  constexpr int kTall = 40;  // rows of a window in which the largest letters have room
  const bool line = model.phase.left_s.has_value() || !model.phase.more.empty();
  const std::string time = time_of(model);
  const std::string words = model.phase.word + (time.empty() ? "" : "  " + time);
  const LetterSize most = area.rows >= kTall ? LetterSize::full : LetterSize::half;
  const auto letters =
      largest_text(words, area.columns - 2 * kEdge, std::min(room - (line ? 1 : 0), large_rows(most)), area.unicode);
  if (line || !letters) rows.push_back(phase_row(area, model));
  if (letters) add_large(area, *letters, style_of(model.phase.shade), rows);
}

// What goes on, what is to be said, what is asked.
MainPart scene_part(const Area& area, const ScreenModel& model, int room) {
  MainPart part, asked;
  add_asked(area, model, asked);
  std::vector<Row> heading;
  add_scene_heading(area, model.scene, heading);
  const bool text = !model.scene.text.empty() && !model.dialog && !model.field;
  // A line is kept for what a key has to say, so that the rest does not move.
  const int kept =
      area.rows >= kRoomy ? std::max(1, static_cast<int>(asked.rows.size())) : static_cast<int>(asked.rows.size());
  int left = room - kept - static_cast<int>(heading.size()) - (text ? lines_of_text(area, model.scene.text) : 0);
  const bool phase = !model.phase.word.empty();
  std::vector<Row> said;
  if (!model.say.empty()) add_say(area, model, left - (phase ? 1 : 0), said);
  left -= static_cast<int>(said.size());
  if (phase) add_phase(area, model, model.scene.to_read || model.first ? 0 : left, part.rows);
  part.rows.insert(part.rows.end(), said.begin(), said.end());
  part.rows.insert(part.rows.end(), heading.begin(), heading.end());
  const auto before = static_cast<int>(part.rows.size());
  if (asked.cursor) part.cursor = {asked.cursor->first + before, asked.cursor->second};
  part.rows.insert(part.rows.end(), asked.rows.begin(), asked.rows.end());
  part.least = part.rows.size();
  if (!text) return part;
  if (!part.rows.empty() && area.rows >= kRoomy) part.rows.emplace_back();
  add_participant_text(area, model.scene.text, {}, model.large && model.scene.to_read, part.rows);
  return part;
}

// On the first screen: whether the session counts, as large as there is room.
void add_kind(const Area& area, const ScreenModel& model, int room, MainPart& part) {
  const bool real = model.card.kind == SessionKind::real;
  if (!model.first || model.card.kind == SessionKind::simulated) return;
  const auto letters = largest_text(real ? tr("REAL") : tr("REHEARSAL"), area.columns - 2 * kEdge,
                                    room - static_cast<int>(part.rows.size()), area.unicode);
  if (!letters) return;
  std::vector<Row> rows;
  add_large(area, *letters, style_of(real ? Shade::real : Shade::rehearsal), rows);
  const auto added = static_cast<int>(rows.size());
  part.rows.insert(part.rows.begin(), rows.begin(), rows.end());
  part.least += rows.size();
  if (part.cursor) part.cursor->first += added;
}

}  // namespace

MainPart main_part(const Area& area, const ScreenModel& model, int room) {
  if (model.help) return help_part(area, model);
  if (model.stop) return stop_part(area, model, room);
  MainPart part = model.page != nullptr && !model.dialog && !model.field ? questions_part(area, model)
                                                                         : scene_part(area, model, room);
  add_kind(area, model, room, part);
  return part;
}

}  // namespace jnd
