#include "runner/console/screen_display.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/clock.h"
#include "protocols/input/utf8.h"
#include "runner/console/console_lines.h"
#include "runner/console/screen_layout.h"
#include "runner/console/screen_painter.h"
#include "runner/console/screen_parts.h"
#include "runner/console/screen_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {

constexpr std::size_t kPastKept = 50;
constexpr int kMostScrolled = 8;                       // lines, by one key
constexpr std::int64_t kHealthEvery_ns = 200'000'000;  // so that the figures can be read

class ScreenDisplay final : public Display {
 public:
  void begin(const SessionCard& card) override {
    model_.card = card;
    painter_ = std::make_unique<ScreenPainter>();
    if (!painter_->works()) painter_.reset();
    if (!painter_) return lines_.begin(card);
    draw();
  }
  void end(const std::string& last_words) override {
    painter_.reset();
    lines_.end(last_words);
  }
  void announce(const std::string& text, bool warning) override {
    if (!painter_) return lines_.announce(text, warning);
    happened(warning ? Tone::warning : Tone::plain, text);
  }

  void scene(const Scene& scene) override {
    if (!painter_) return lines_.scene(scene);
    model_.hint = {};
    model_.scrolled = 0;
    read_ = false;
    if (scene.heading.empty())
      model_.scene.keys = scene.keys;  // a question: what was said stays
    else
      model_.scene = scene;
    // Feedback is still to be said when the next trial is announced.
    if (!scene.heading.empty() && !feedback_) model_.say.clear();
    feedback_ = false;
    draw();
  }
  void keys_again() override {
    if (!painter_) return lines_.keys_again();
    model_.hint = {};
    draw();
  }
  void working_keys(const std::vector<KeyHint>& keys) override {
    model_.scene = {};
    model_.scene.keys = keys;
    model_.hint = {};
  }
  void say(CuePlace, const std::string& words, bool aloud, bool beep) override {
    if (!painter_) return lines_.say(CuePlace::first, words, aloud, beep);
    model_.say = words;
    model_.aloud = aloud;
    draw();
    if (beep) painter_->beep();
  }
  void feedback(const std::string& words) override {
    if (!painter_) return lines_.feedback(words);
    model_.say = words;
    model_.aloud = true;
    feedback_ = true;
    draw();
  }
  void tell(Tone tone, const std::string& text) override {
    if (!painter_) return lines_.tell(tone, text);
    happened(tone, text);
  }
  void explain(Tone tone, const std::string& text) override {
    if (!painter_) return lines_.explain(tone, text);
    model_.hint = {tone, text};
    draw();
  }
  void answer(const std::string& trial, const std::string& words, const std::string& by) override {
    if (!painter_) return lines_.answer(trial, words, by);
    model_.past.erase(model_.past.begin(), model_.past.begin() + static_cast<std::ptrdiff_t>(before_trial_));
    before_trial_ = 0;
    model_.answered = trial;
    model_.answer = words;
    model_.by = by;
    model_.say.clear();
    feedback_ = false;
    draw();
  }
  void answer_taken_back() override { model_.answer.clear(); }
  void outline(const TrialOutline& outline) override {
    model_.outline = outline;
    before_trial_ = model_.past.size();
  }
  void progress(const std::vector<ConditionProgress>& progress) override {
    model_.progress = progress;
    draw();
  }
  void health(const DeviceHealth& health) override {
    const std::int64_t now = clock_.now_ns();
    // What a presentation ends with stays on view until the next one.
    const bool soon = now - health_shown_ns_ < kHealthEvery_ns && health.fault.empty() && health.presenting;
    model_.health = health;
    if (soon) return;  // it is drawn with what comes next
    health_shown_ns_ = now;
    draw();
  }
  void countdown(const std::string& what, double left_s, double total_s) override {
    if (!painter_) return lines_.countdown(what, left_s, total_s);
    const bool same = model_.countdown && std::ceil(model_.countdown->left_s) == std::ceil(left_s);
    model_.countdown = {what, left_s, total_s};
    if (!same) draw();
  }
  void countdown_over() override {
    model_.countdown.reset();
    lines_.countdown_over();
  }

  void field(const std::string& label, const LineEditor& editor) override {
    if (!painter_) return lines_.field(label, editor);
    model_.field = {label, editor.text(), editor.before_cursor()};
    draw();
  }
  void field_done() override {
    if (!painter_) return lines_.field_done();
    model_.field.reset();
    draw();
  }
  void ask(const std::string& question, const std::vector<KeyHint>& keys) override {
    if (!painter_) return lines_.ask(question, keys);
    model_.hint = {};
    model_.dialog = {question, keys};
    draw();
  }
  void asked() override {
    model_.dialog.reset();
    draw();
  }
  void page(const QuestionnairePage& page) override {
    if (!painter_) return lines_.page(page);
    if (model_.page == nullptr || page.at() != question_) {
      model_.scrolled = 0;
      read_ = false;
    }
    model_.page = &page;
    question_ = page.at();
    model_.hint = {};
    draw();
  }
  void page_done() override {
    model_.page = nullptr;
    model_.scene = {};
    draw();
  }
  void refresh() override {
    if (painter_ && painter_->changed()) draw();
  }
  bool scroll(KeyName key) override {
    // The last line of a window may be covered by the words that say that there is more.
    const int window = std::clamp(window_lines_ - 1, 1, kMostScrolled);
    const int by = key == KeyName::down        ? 1
                   : key == KeyName::up        ? -1
                   : key == KeyName::page_down ? window
                   : key == KeyName::page_up   ? -window
                                               : 0;
    if (by == 0 || (model_.scene.text.empty() && model_.page == nullptr)) return false;
    model_.scrolled = std::max(0, model_.scrolled + std::min(by, hidden_lines_));
    draw();
    return true;
  }
  std::string unread() override {
    if (!painter_) return {};
    draw();  // as large as the window is now
    if (unseen_ == Unseen::too_small) return "the window is too small to read this: make it larger";
    if (model_.dialog || read_) return {};
    return model_.page != nullptr ? "there is more to read first: Page Down"
                                  : "there is more to read first: arrow down";
  }
  bool by_lines() const noexcept override { return !painter_; }

 private:
  void happened(Tone tone, const std::string& text) {
    model_.past.push_back({tone, text});
    if (model_.past.size() > kPastKept) {
      model_.past.pop_front();
      before_trial_ -= before_trial_ > 0 ? 1 : 0;
    }
    draw();
  }
  void draw() {
    if (!painter_) return;
    painter_->changed();
    const Frame frame = lay_out(model_, painter_->rows(), painter_->columns(), painter_->unicode());
    hidden_lines_ = frame.hidden_lines;
    window_lines_ = frame.window_lines;
    unseen_ = frame.unseen;
    if (!model_.dialog && !model_.field) read_ = read_ || unseen_ == Unseen::nothing;
    painter_->paint(frame);
  }

  ScreenModel model_;
  std::unique_ptr<ScreenPainter> painter_;
  LineDisplay lines_{true};
  SteadyClock clock_;
  std::int64_t health_shown_ns_ = 0;
  int hidden_lines_ = 0, window_lines_ = 0;
  std::size_t question_ = 0;  // of the page, that is shown
  Unseen unseen_ = Unseen::nothing;
  bool read_ = false;             // all of the scene's text, or of the page's question, was on view
  std::size_t before_trial_ = 0;  // of what has happened: told before this trial
  bool feedback_ = false;
};

}  // namespace

std::unique_ptr<Display> make_screen_display() {
  if (!ScreenPainter::possible()) return nullptr;
  return std::make_unique<ScreenDisplay>();
}

// The middle of the screen: what to do and to say now, a dialog, a text, a page of questions.

namespace {

// The words to say, large and in reverse: to be read at a glance.
void add_say(const Area& area, const std::string& say, bool aloud, std::vector<Row>& rows) {
  if (!aloud) {
    rows.push_back({span(area, 1, say, kBold)});
    return;
  }
  static constexpr Style kLoud{.bold = true, .reverse = true, .colour = Style::Colour::cyan};
  for (const std::string& line : wrapped(showable(say, area.unicode), area.columns - 8))
    rows.push_back({span(area, 1, "SAY", kBold), span(area, 5, "  " + line + "  ", kLoud)});
}

void add_text(const Area& area, const std::string& text, Style style, std::vector<Row>& rows) {
  // Line by line, since what is showable has no line ends.
  for (const std::string& line : wrapped(text, area.columns - 2)) rows.push_back({span(area, 1, line, style)});
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

std::string seconds_left(double left_s) {
  return fmt::format("{} left", duration_text(left_s));
}

}  // namespace

MainPart main_part(const Area& area, const ScreenModel& model) {
  MainPart part;
  if (model.page != nullptr && !model.dialog && !model.field) {
    part = page_part(area, *model.page);
    if (!model.hint.text.empty()) {
      const Row hint = {span(area, 1, model.hint.text, style_of(model.hint.tone))};
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
    heading.push_back(span(area, 1, scene.task, kBold));
  else if (!scene.heading.empty())
    heading.push_back(span(area, 1, scene.heading, style_of(scene.tone)));
  if (!scene.beside.empty() && scene.task.empty())
    heading.push_back(span(area, heading.empty() ? 1 : 4 + columns_of(heading.front().text), scene.beside, kDim));
  if (!heading.empty()) part.rows.push_back(heading);
  if (!model.say.empty()) {
    if (area.rows > 18 && !part.rows.empty()) part.rows.emplace_back();
    add_say(area, model.say, model.aloud, part.rows);
    if (area.rows > 18) part.rows.emplace_back();
  }
  if (model.countdown) {
    const double share = model.countdown->total_s > 0 ? model.countdown->left_s / model.countdown->total_s : 0;
    part.rows.push_back({span(area, 1, bar(share, area.columns / 3, area.unicode)),
                         span(area, 3 + area.columns / 3, seconds_left(model.countdown->left_s), kBold)});
  }
  if (model.dialog) add_text(area, model.dialog->question, style_of(Tone::warning), part.rows);
  if (model.field) add_field(area, *model.field, part);
  if (!model.hint.text.empty())
    for (const std::string& line : wrapped(model.hint.text, area.columns - 2))
      part.rows.push_back({span(area, 1, line, style_of(model.hint.tone))});
  part.least = part.rows.size();
  if (!scene.text.empty() && !model.dialog && !model.field) {
    if (!part.rows.empty()) part.rows.emplace_back();
    add_text(area, scene.text, {}, part.rows);
  }
  return part;
}

namespace {

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

void add_question(const Area& area, const QuestionnairePage& page, MainPart& part) {
  const QuestionnairePage::Item& item = page.items()[page.at()];
  const Question& question = *item.question;
  std::string place;
  if (page.items().size() > 1) place = fmt::format("Question {} of {}   ", page.at() + 1, page.items().size());
  if (!item.about.empty()) place += fmt::format("about condition: {}   ", item.about);
  if (!question.required) place += "may be left empty";
  if (!place.empty()) part.rows.push_back({span(area, 1, place, kDim)});
  part.least = part.rows.size();
  add_text(area, question.text, kBold, part.rows);
  if (question.kind == Question::Kind::rating) add_scale(area, question, part.rows);
  if (question.kind == Question::Kind::number)
    part.rows.push_back({span(area, 1, fmt::format("a number from {:g} to {:g}", question.min, question.max), kDim)});
  for (std::size_t i = 0; i < question.options.size(); ++i) {
    const std::size_t first = part.rows.size();
    const std::string& option = i < question.shown.size() ? question.shown[i] : question.options[i];
    for (const std::string& line : wrapped(option, area.columns - 5)) part.rows.push_back({span(area, 4, line)});
    part.rows[first].insert(part.rows[first].begin(), span(area, 1, fmt::format("{}", i + 1), kBold));
  }
  const std::string label = question.kind == Question::Kind::confirm  ? "y once it is so"
                            : question.kind == Question::Kind::choice ? "Number"
                                                                      : "Answer";
  const std::size_t before = part.rows.size();
  add_field(area, {label, page.editor().text(), page.editor().before_cursor()}, part);
  part.foot = part.rows.size() - before;
}

void add_review(const Area& area, const QuestionnairePage& page, MainPart& part) {
  part.rows.push_back({span(area, 1, "Please look through the answers", kBold)});
  add_field(area, {"Enter saves them, a number changes that one", page.editor().text(), page.editor().before_cursor()},
            part);
}

}  // namespace

MainPart page_part(const Area& area, const QuestionnairePage& page) {
  MainPart part;
  if (page.reviewing())
    add_review(area, page, part);
  else
    add_question(area, page, part);
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

}  // namespace jnd
