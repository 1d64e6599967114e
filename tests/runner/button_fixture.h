// A session's console whose operator is scripted, and whose participant has a made-up button box.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pty.h>
#include <unistd.h>

#include "devices/hid/buttons/button_box.h"
#include "runner/console/session_console.h"
#include "runner/keys/keyboard.h"
#include "runner/session/fast_clock.h"
#include "tests/catch.h"
#include "tests/devices/hid/buttons/made_up_box.h"
#include "tests/wait_until.h"

namespace jnd::test {

// Standard input is a pseudo-terminal for as long as it lives.
class TerminalKeys {
 public:
  TerminalKeys() {
    int terminal = -1;
    REQUIRE(openpty(&keys_, &terminal, nullptr, nullptr, nullptr) == 0);
    dup2(terminal, STDIN_FILENO);
    close(terminal);
  }
  ~TerminalKeys() {
    dup2(before_, STDIN_FILENO);
    close(before_);
    close(keys_);
  }
  TerminalKeys(const TerminalKeys&) = delete;
  TerminalKeys& operator=(const TerminalKeys&) = delete;
  void press(const std::string& keys) const {
    REQUIRE(write(keys_, keys.data(), keys.size()) == static_cast<ssize_t>(keys.size()));
  }

 private:
  int before_ = dup(STDIN_FILENO), keys_ = -1;
};

// Keeps what the operator is told, and calls back where keys or buttons are awaited.
class WatchedDisplay final : public Display {
 public:
  void begin(const SessionCard&) override {}
  void end(const std::string&) override {}
  void announce(const std::string&, bool) override {}
  void scene(const Scene& scene) override {
    if (scene.heading.empty() && question)
      question();
    else if (!scene.heading.empty() && prompt)
      prompt(scene.heading);
  }
  void keys_again() override {}
  void say(CuePlace place, const std::string&, bool, bool) override {
    if (place == CuePlace::question && before_question) before_question();
  }
  void feedback(const std::string&) override {}
  void tell(Tone, const std::string& text) override { keep(text); }
  void explain(Tone, const std::string& text) override { keep(text); }
  void answer(const std::string&, const std::string& words, const std::string& by) override {
    answers.push_back(words + " by " + by);
  }
  void countdown(const std::string&, double, double) override {}
  void countdown_over() override {}
  void field(const std::string&, const LineEditor&) override {
    if (typing) typing();
  }
  void field_done() override {}
  void ask(const std::string&, const std::vector<KeyHint>&) override {}
  void page(const QuestionnairePage&) override {}
  bool by_lines() const noexcept override { return false; }

  std::function<void()> before_question, question, typing;
  std::function<void(const std::string& heading)> prompt;
  std::function<void(const std::string& text)> on_told;
  std::vector<std::string> told, answers;

 private:
  void keep(const std::string& text) {
    told.push_back(text);
    if (on_told) on_told(text);
  }
};

inline ButtonMapping pedal_mapping() {
  const HidInfo info = pedal_info();
  ButtonMapping mapping;
  mapping.vendor = info.vendor;
  mapping.product = info.product;
  mapping.usage_page = info.usage_page;
  mapping.usage = info.usage;
  mapping.name = info.product_name;
  mapping.report_bytes = 1;
  mapping.buttons = {{ButtonMeaning::same, ButtonBits{0, 1, 1}},
                     {ButtonMeaning::different, ButtonBits{0, 2, 2}},
                     {ButtonMeaning::stop, ButtonBits{0, 4, 4}}};
  return mapping;
}

// Of the pedal's one byte.
inline constexpr std::uint8_t kNone = 0, kSame = 1, kDifferent = 2, kBoth = 3, kStopPedal = 4;

struct ButtonBench {
  ButtonBench() {
    bus.plug(pedal_info());
    box.wait_until_there();
    // What is down right after opening is no press.
    clock_of_machine.sleep_until_ns(clock_of_machine.now_ns() + ButtonDecoder::kOpening_ns + 50'000'000);
  }
  // Returns once the box has heard it.
  void pedals(std::uint8_t down) {
    bus.send({down});
    bus.heard();
  }
  // At least so long: a busy machine makes it longer, and nothing rests on that.
  void wait_ms(int milliseconds) {
    clock_of_machine.sleep_until_ns(clock_of_machine.now_ns() + milliseconds * std::int64_t{1'000'000});
  }
  bool was_told(const std::string& part) const {
    return std::any_of(display.told.begin(), display.told.end(),
                       [&](const std::string& text) { return text.find(part) != std::string::npos; });
  }
  std::optional<Answer> ask(double time_out_s) {
    console.cue(CuePlace::question, CueSignal());
    const Trial trial;
    const std::array<Presentation, 2> presentations;
    return console.responder().judge({trial, 1, presentations, time_out_s});
  }

  SteadyClock clock_of_machine;
  MadeUpBus bus;
  ButtonBox box{bus, pedal_mapping()};
  TerminalKeys keys;
  Keyboard keyboard;
  Protocol protocol;
  FastClock clock;
  Interrupts interrupted;
  WatchedDisplay* made = new WatchedDisplay;
  WatchedDisplay& display = *made;
  SessionConsole console{ConsoleOptions{.buttons = &box}, protocol, &keyboard, clock, interrupted,
                         std::unique_ptr<Display>(made)};
};

}  // namespace jnd::test
