#include "runner/console/screen_display.h"

#include <algorithm>
#include <cmath>

#include "devices/clock.h"
#include "runner/console/console_lines.h"
#include "runner/console/screen_layout.h"
#include "runner/console/screen_painter.h"
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

}  // namespace jnd
