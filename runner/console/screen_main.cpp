// The middle of the screen: what to do and to say now, a dialog, a text, a page of questions.
#include <algorithm>

#include <fmt/format.h>

#include "runner/console/screen_parts.h"
#include "runner/console/screen_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr Style kBold{.bold = true}, kDim{.dim = true};

// The words to say, large and in reverse: to be read at a glance.
void add_say(const Paper& paper, const std::string& say, bool aloud, std::vector<Row>& rows) {
  if (!aloud) {
    rows.push_back({span(paper, 1, say, kBold)});
    return;
  }
  static constexpr Style kLoud{.bold = true, .reverse = true, .colour = Style::Colour::cyan};
  for (const std::string& line : wrapped(showable(say, paper.unicode), paper.columns - 8))
    rows.push_back({span(paper, 1, "SAY", kBold), span(paper, 5, "  " + line + "  ", kLoud)});
}

void add_text(const Paper& paper, const std::string& text, Style style, std::vector<Row>& rows) {
  // Line by line, since what is showable has no line ends.
  for (const std::string& line : wrapped(text, paper.columns - 2)) rows.push_back({span(paper, 1, line, style)});
}

void add_field(const Paper& paper, const ScreenModel::Field& field, MainPart& part) {
  std::string label = field.label.empty() ? "> " : field.label + ": ";
  part.rows.emplace_back();
  if (columns_of(label) > paper.columns / 2) {  // a long label has a line of its own
    part.rows.back().push_back(span(paper, 1, label, kBold));
    part.rows.emplace_back();
    label = "> ";
  }
  const int from = 1 + columns_of(label);
  part.rows.back().push_back(span(paper, 1, label, kBold));
  // The end of a long line is what is being typed.
  const int room = paper.columns - from - 1;
  std::string text = showable(field.text, paper.unicode);
  int cursor = columns_of(showable(field.before_cursor, paper.unicode));
  std::u32string whole = code_points(text);
  while (cursor >= room && !whole.empty()) {
    cursor -= columns_of(to_utf8(whole.substr(0, 1)));
    whole.erase(0, 1);
  }
  part.rows.back().push_back(span(paper, from, to_utf8(whole), {.underline = true}));
  part.cursor = {static_cast<int>(part.rows.size()) - 1, from + cursor};
}

std::string seconds_left(double left_s) {
  return fmt::format("{} left", duration_text(left_s));
}

}  // namespace

MainPart main_part(const Paper& paper, const ScreenModel& model) {
  MainPart part;
  if (model.page != nullptr && !model.dialog && !model.field) {
    part = page_part(paper, *model.page);
    if (!model.hint.text.empty()) {
      const Row hint = {span(paper, 1, model.hint.text, style_of(model.hint.tone))};
      if (part.foot > 0) {
        part.rows.push_back(hint);
        ++part.foot;
      } else {
        part.rows.insert(part.rows.begin() + static_cast<std::ptrdiff_t>(part.least++), hint);
      }
    }
    return part;
  }
  const Scene& scene = model.scene;
  Row heading;
  if (!scene.task.empty())
    heading.push_back(span(paper, 1, scene.task, kBold));
  else if (!scene.heading.empty())
    heading.push_back(span(paper, 1, scene.heading, style_of(scene.tone)));
  if (!scene.beside.empty() && scene.task.empty())
    heading.push_back(span(paper, heading.empty() ? 1 : 4 + columns_of(heading.front().text), scene.beside, kDim));
  if (!heading.empty()) part.rows.push_back(heading);
  if (!model.say.empty()) {
    if (paper.rows > 18 && !part.rows.empty()) part.rows.emplace_back();
    add_say(paper, model.say, model.aloud, part.rows);
    if (paper.rows > 18) part.rows.emplace_back();
  }
  if (model.countdown) {
    const double share = model.countdown->total_s > 0 ? model.countdown->left_s / model.countdown->total_s : 0;
    part.rows.push_back({span(paper, 1, bar(share, paper.columns / 3, paper.unicode)),
                         span(paper, 3 + paper.columns / 3, seconds_left(model.countdown->left_s), kBold)});
  }
  if (model.dialog) add_text(paper, model.dialog->question, style_of(Tone::warning), part.rows);
  if (model.field) add_field(paper, *model.field, part);
  if (!model.hint.text.empty())
    for (const std::string& line : wrapped(model.hint.text, paper.columns - 2))
      part.rows.push_back({span(paper, 1, line, style_of(model.hint.tone))});
  part.least = part.rows.size();
  if (!scene.text.empty() && !model.dialog && !model.field) {
    if (!part.rows.empty()) part.rows.emplace_back();
    add_text(paper, scene.text, {}, part.rows);
  }
  return part;
}

namespace {

// Both ends labelled, with the whole scale between them where it has few steps.
void add_scale(const Paper& paper, const Question& question, std::vector<Row>& rows) {
  std::string scale = fmt::format("{:g} ... {:g}", question.min, question.max);
  if (question.max - question.min <= 10) {
    scale.clear();
    for (int step = static_cast<int>(question.min); step <= static_cast<int>(question.max); ++step)
      scale += fmt::format("{}{}", scale.empty() ? "" : "  ", step);
  }
  const int labels = columns_of(question.low_label) + columns_of(question.high_label);
  if (labels + columns_of(scale) + 8 <= paper.columns) {
    const int middle = 1 + columns_of(question.low_label) + 3;
    rows.push_back({span(paper, 1, question.low_label, kDim), span(paper, middle, scale, kBold),
                    span(paper, middle + columns_of(scale) + 3, question.high_label, kDim)});
    return;
  }
  rows.push_back({span(paper, 1, scale, kBold)});
  add_text(paper, fmt::format("{:g} = {}", question.min, question.low_label), {}, rows);
  add_text(paper, fmt::format("{:g} = {}", question.max, question.high_label), {}, rows);
}

void add_question(const Paper& paper, const QuestionnairePage& page, MainPart& part) {
  const QuestionnairePage::Item& item = page.items()[page.at()];
  const Question& question = *item.question;
  std::string place;
  if (page.items().size() > 1) place = fmt::format("Question {} of {}   ", page.at() + 1, page.items().size());
  if (!item.about.empty()) place += fmt::format("about condition: {}   ", item.about);
  if (!question.required) place += "may be left empty";
  if (!place.empty()) part.rows.push_back({span(paper, 1, place, kDim)});
  part.least = part.rows.size();
  add_text(paper, question.text, kBold, part.rows);
  if (question.kind == Question::Kind::rating) add_scale(paper, question, part.rows);
  if (question.kind == Question::Kind::number)
    part.rows.push_back({span(paper, 1, fmt::format("a number from {:g} to {:g}", question.min, question.max), kDim)});
  for (std::size_t i = 0; i < question.options.size(); ++i) {
    const std::size_t first = part.rows.size();
    const std::string& option = i < question.shown.size() ? question.shown[i] : question.options[i];
    for (const std::string& line : wrapped(option, paper.columns - 5)) part.rows.push_back({span(paper, 4, line)});
    part.rows[first].insert(part.rows[first].begin(), span(paper, 1, fmt::format("{}", i + 1), kBold));
  }
  const std::string label = question.kind == Question::Kind::confirm  ? "y once it is so"
                            : question.kind == Question::Kind::choice ? "Number"
                                                                      : "Answer";
  const std::size_t before = part.rows.size();
  add_field(paper, {label, page.editor().text(), page.editor().before_cursor()}, part);
  part.foot = part.rows.size() - before;
}

void add_review(const Paper& paper, const QuestionnairePage& page, MainPart& part) {
  part.rows.push_back({span(paper, 1, "Please look through the answers", kBold)});
  add_field(paper, {"Enter saves them, a number changes that one", page.editor().text(), page.editor().before_cursor()},
            part);
}

}  // namespace

MainPart page_part(const Paper& paper, const QuestionnairePage& page) {
  MainPart part;
  if (page.reviewing())
    add_review(paper, page, part);
  else
    add_question(paper, page, part);
  if (!page.mistake().empty()) part.rows.push_back({span(paper, 1, page.mistake(), style_of(Tone::warning))});
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
    const std::string reply = showable(page.shown_reply(i), paper.unicode);
    const int room = std::clamp(columns_of(reply) + 2, 6, paper.columns / 2);
    part.rows.push_back({span(paper, 1, number), span(paper, paper.columns - room, reply, kBold)});
    part.rows.back().push_back(
        {5, clipped(showable(question, paper.unicode), paper.columns - room - 6, paper.unicode), {}});
  }
  return part;
}

}  // namespace jnd
