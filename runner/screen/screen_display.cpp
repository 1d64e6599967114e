#include "runner/screen/screen_display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <utility>

#include <fmt/format.h>

#include "devices/clock.h"
#include "runner/console/console_lines.h"
#include "runner/screen/screen_layout.h"
#include "runner/screen/screen_painter.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr std::size_t kLogKept = 5000;
constexpr std::size_t kBeforeKept = 6;                 // attempts before the last answer
constexpr int kMostScrolled = 8;                       // lines, by one key
constexpr std::int64_t kHealthEvery_ns = 200'000'000;  // so that the figures can be read

std::string time_of_day(std::int64_t utc_ns, const char* format) {
  const std::time_t seconds = utc_ns / 1'000'000'000;
  std::tm parts{};
  localtime_r(&seconds, &parts);
  std::array<char, 16> text{};
  return {text.data(), std::strftime(text.data(), text.size(), format, &parts)};
}

class ScreenDisplay final : public Display {
 public:
  ScreenDisplay(std::function<std::unique_ptr<Painter>()> painter, std::unique_ptr<Clock> clock)
      : make_painter_(std::move(painter)), clock_(std::move(clock)) {}

  void begin(const SessionCard& card) override {
    model_.card = card;
    model_.first = true;
    painter_ = make_painter_();
    if (!painter_) return lines_.begin(card);
    log(card.resumed ? tr("the session goes on") : tr("the session begins"));
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
    model_.help = false;
    read_ = false;
    turn();
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
  void say(CuePlace place, const std::string& words, bool aloud, bool beep) override {
    if (!painter_) return lines_.say(place, words, aloud, beep);
    if (place == CuePlace::first) model_.log_of_now = model_.log.size();  // what was told before is over
    model_.say = words;
    model_.aloud = aloud;
    model_.help = false;
    draw();
    if (beep) painter_->beep();
  }
  void feedback(const std::string& words) override {
    if (!painter_) return lines_.feedback(words);
    model_.say = words;
    model_.aloud = true;
    feedback_ = true;
    log(tr("to say: {}", words));
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
    if (!model_.answer.empty()) keep_before(model_.answer);
    model_.answered = trial;
    model_.answer = words;
    model_.by = by;
    model_.say.clear();
    feedback_ = false;
    log(tr("{} answered: {}; saved", trial, words));
    draw();
  }
  void answer_taken_back() override { model_.answer.clear(); }
  void outline(const TrialOutline& outline) override { model_.outline = outline; }
  void phase(const Phase& phase) override {
    const bool same = model_.phase.word == phase.word && model_.phase.more == phase.more &&
                      seconds_of(model_.phase) == seconds_of(phase);
    spend_time_left();
    model_.phase = phase;
    // What holds the session, or is to be said, is drawn with its scene or its words, when it can be answered.
    if (!same && !phase.holds && phase.left_s) draw();
  }
  void queued(const std::vector<std::string>& what) override {
    if (!painter_) return lines_.queued(what);
    for (const std::string& one : what)
      if (std::find(model_.queued.begin(), model_.queued.end(), one) == model_.queued.end()) log(tr("queued: {}", one));
    const bool changed = model_.queued != what;
    model_.queued = what;
    if (changed) draw();
  }
  void log(const std::string& text) override { keep({now_text(), text, Tone::quiet, false}); }
  void counts(const AnswerCounts& counts) override {
    if (counts.voids > model_.counts.voids) keep_before(tr("void"));
    model_.counts = counts;
  }
  void stopped(const std::optional<StopShown>& stop) override {
    if (!painter_ || stop.has_value() == model_.stop.has_value()) return;
    spend_time_left();
    model_.stop = stop;
    model_.hint = {};
    model_.help = false;
    log(stop ? tr("STOPPED ({})", stop->by) : tr("the stop is cleared"));
    draw();
  }
  void time_left(double left_s) override {
    left_s_ = left_s;
    left_as_of_ns_ = clock_->utc_ns();
  }
  void alert() override {
    if (painter_) painter_->beep();
  }
  void progress(const std::vector<ConditionProgress>& progress) override {
    model_.progress = progress;
    draw();
  }
  void health(const DeviceHealth& health) override {
    const std::int64_t now = clock_->now_ns();
    // What a presentation ends with stays on view until the next one.
    const bool soon = now - health_shown_ns_ < kHealthEvery_ns && health.fault.empty() && health.presenting;
    if (!health.fault.empty() && (!model_.health || model_.health->fault != health.fault))
      happened(Tone::warning, tr("FAULT: {}", health.fault));
    model_.health = health;
    if (soon) return;  // it is drawn with what comes next
    health_shown_ns_ = now;
    draw();
  }
  void forces(const ForceTrace& trace) override {
    model_.forces = &trace;
    draw();
  }
  void countdown(const std::string& what, double left_s, double total_s) override {
    if (!painter_) return lines_.countdown(what, left_s, total_s);
    Phase phase = model_.phase;
    if (phase.word.empty()) phase.word = what;
    phase.left_s = left_s;
    phase.total_s = total_s;
    this->phase(phase);
  }
  void countdown_over() override {
    model_.phase.left_s.reset();
    lines_.countdown_over();
  }

  void field(const std::string& label, const LineEditor& editor) override {
    if (!painter_) return lines_.field(label, editor);
    model_.field = {label, editor.text(), editor.before_cursor()};
    model_.help = false;
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
    model_.help = false;
    draw();
  }
  void asked() override {
    model_.dialog.reset();
    model_.hint = {};
    draw();
  }
  void page(const QuestionnairePage& page) override {
    if (!painter_) return lines_.page(page);
    if (model_.page == nullptr || page.at() != question_) {
      turn();
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
  bool help(bool on) override {
    if (!painter_ || on == model_.help) return false;
    model_.help = on;
    draw();
    return true;
  }
  void enlarge() override {
    model_.large = !model_.large;
    model_.scrolled = 0;
    read_ = false;
    draw();
  }
  void refresh() override {
    if (!painter_) return;
    // Once a second the clock and what counts up have changed.
    if (painter_->changed() || clock_->now_ns() / kSecond_ns != drawn_ns_ / kSecond_ns) draw();
  }
  bool scroll(KeyName key) override {
    // The last line of a window may be covered by the words that say that there is more.
    const int window = std::clamp(window_lines_ - 1, 1, kMostScrolled);
    const int by = key == KeyName::down        ? 1
                   : key == KeyName::up        ? -1
                   : key == KeyName::page_down ? window
                   : key == KeyName::page_up   ? -window
                                               : 0;
    if (by == 0) return false;
    if (model_.scene.text.empty() && model_.page == nullptr) return scroll_log(key);
    if (hidden_lines_ == 0 && model_.scrolled == 0 && model_.page == nullptr && scroll_log(key)) return true;
    model_.scrolled = std::max(0, model_.scrolled + std::min(by, hidden_lines_));
    draw();
    return true;
  }
  std::string unread() override {
    if (!painter_) return {};
    draw();  // as large as the window is now
    if (unseen_ == Unseen::too_small) return tr("the window is too small to read this: make it larger");
    if (model_.dialog || read_) return {};
    return model_.page != nullptr ? tr("there is more to read first: Page Down")
                                  : tr("there is more to read first: arrow down");
  }
  bool by_lines() const noexcept override { return !painter_; }

 private:
  static constexpr std::int64_t kSecond_ns = 1'000'000'000;

  // As they are shown.
  static std::optional<int> seconds_of(const Phase& phase) {
    if (!phase.left_s) return std::nullopt;
    return static_cast<int>(std::ceil(*phase.left_s));
  }
  std::string now_text() const { return time_of_day(clock_->utc_ns(), "%H:%M:%S"); }

  // Another page of the session: only the first one is the first.
  void turn() { model_.first = model_.first && !std::exchange(shown_, true); }

  void keep(const LogLine& line) {
    model_.log.push_back(line);
    if (model_.log_back > 0) ++model_.log_back;  // what is being read stays where it is
    if (model_.log.size() <= kLogKept) return;
    model_.log.pop_front();
    model_.log_back = std::min(model_.log_back, std::max(0, static_cast<int>(kLogKept) - log_lines_));
    model_.log_of_now -= model_.log_of_now > 0 ? 1 : 0;
  }
  void keep_before(const std::string& what) {
    model_.before.push_front(what);
    if (model_.before.size() > kBeforeKept) model_.before.pop_back();
  }
  void happened(Tone tone, const std::string& text) {
    keep({now_text(), text, tone, true});
    draw();
  }
  bool scroll_log(KeyName key) {
    if (log_lines_ == 0) return false;
    const int by = std::max(1, log_lines_ - 1);
    const int most = std::max(0, static_cast<int>(model_.log.size()) - log_lines_);
    model_.log_back += key == KeyName::page_up ? by : key == KeyName::page_down ? -by : key == KeyName::up ? 1 : -1;
    model_.log_back = std::clamp(model_.log_back, 0, most);
    draw();
    return true;
  }
  // The time left goes by while the session does: not where it waits for a person, nor while it is stopped.
  void spend_time_left() {
    const std::int64_t now_ns = clock_->utc_ns();
    const std::int64_t gone_ns = now_ns - std::exchange(left_as_of_ns_, now_ns);
    if (left_s_ && !model_.phase.holds && !model_.stop)
      left_s_ = std::max(0.0, *left_s_ - static_cast<double>(gone_ns) * 1e-9);
  }
  // The times on the screen, as they are now.
  void look_at_clock() {
    drawn_ns_ = model_.now_ns = clock_->now_ns();
    const std::int64_t utc_ns = clock_->utc_ns();
    model_.clock = time_of_day(utc_ns, "%H:%M");
    spend_time_left();
    if (!left_s_) return;
    model_.left = duration_text(*left_s_);
    model_.ends = time_of_day(utc_ns + static_cast<std::int64_t>(*left_s_ * 1e9), "%H:%M");
  }
  void draw() {
    if (!painter_) return;
    painter_->changed();
    look_at_clock();
    const Frame frame = lay_out(model_, painter_->rows(), painter_->columns(), painter_->unicode());
    hidden_lines_ = frame.hidden_lines;
    window_lines_ = frame.window_lines;
    log_lines_ = frame.log_lines;
    unseen_ = frame.unseen;
    if (!model_.dialog && !model_.field && !model_.help) read_ = read_ || unseen_ == Unseen::nothing;
    painter_->paint(frame);
  }

  ScreenModel model_;
  std::function<std::unique_ptr<Painter>()> make_painter_;
  std::unique_ptr<Painter> painter_;
  LineDisplay lines_{true};
  std::unique_ptr<Clock> clock_;  // steady: not the session's, which may run ahead
  std::int64_t health_shown_ns_ = 0, drawn_ns_ = 0;
  std::optional<double> left_s_;    // of the session
  std::int64_t left_as_of_ns_ = 0;  // UTC
  int hidden_lines_ = 0, window_lines_ = 0, log_lines_ = 0;
  std::size_t question_ = 0;  // of the page, that is shown
  Unseen unseen_ = Unseen::nothing;
  bool read_ = false;  // all of the scene's text, or of the page's question, was on view
  bool feedback_ = false;
  bool shown_ = false;  // a first page was
};

}  // namespace

std::unique_ptr<Display> make_screen_display(std::function<std::unique_ptr<Painter>()> painter,
                                             std::unique_ptr<Clock> clock) {
  return std::make_unique<ScreenDisplay>(std::move(painter), std::move(clock));
}

std::unique_ptr<Display> make_screen_display() {
  if (!ScreenPainter::possible()) return nullptr;
  const auto on_terminal = []() -> std::unique_ptr<Painter> {
    auto painter = std::make_unique<ScreenPainter>();
    return painter->works() ? std::move(painter) : nullptr;
  };
  return make_screen_display(on_terminal, std::make_unique<SteadyClock>());
}

}  // namespace jnd
