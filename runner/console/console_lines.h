// The console a line at a time: for pipes, for screen readers, and where --plain asks for it. The cursor never moves
// back, but for what Backspace takes away.
#pragma once

#include <string>

#include "runner/console/console_display.h"

namespace jnd {

class LineDisplay final : public Display {
 public:
  // echo: typed text is shown here; otherwise it is not, as of a pipe.
  explicit LineDisplay(bool echo) noexcept : echo_(echo) {}

  void begin(const SessionCard& card) override;
  void end(const std::string& last_words) override;
  void announce(const std::string& text, bool warning) override;
  void scene(const Scene& scene) override;
  void keys_again() override;
  void say(CuePlace place, const std::string& words, bool aloud, bool beep) override;
  void feedback(const std::string& words) override;
  void tell(Tone tone, const std::string& text) override;
  void alert() override;
  void queued(const std::vector<std::string>& what) override;
  void answer(const std::string& trial, const std::string& words, const std::string& by) override;
  void countdown(const std::string& what, double left_s, double total_s) override;
  void countdown_over() override;
  void field(const std::string& label, const LineEditor& editor) override;
  void field_done() override;
  void ask(const std::string& question, const std::vector<KeyHint>& keys) override;
  void page(const QuestionnairePage& page) override;
  bool by_lines() const noexcept override { return true; }

 private:
  void print_keys(const std::vector<KeyHint>& keys, bool all) const;

  bool echo_;
  std::vector<KeyHint> keys_;
  std::string typed_;  // of the field, as it stands on the line
  bool typing_ = false;
  std::vector<std::string> queued_;  // told already
  int said_left_s_ = -1;             // of a countdown
};

// "REHEARSAL (kind pilot: never counted as real data)"
std::string kind_banner(SessionKind kind);
// "participant P01, 3 of 16 trials done; going on with the session"
std::string card_line(const SessionCard& card);

}  // namespace jnd
