// Keys for a prompt: only those that were pressed after it was shown and are not held down since before.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runner/console/console_display.h"
#include "runner/keys/held_keys.h"
#include "runner/keys/interrupt.h"
#include "runner/keys/keyboard.h"

namespace jnd {

// Thread rule: the session's thread only.
class PromptKeys {
 public:
  // keyboard may be null: then no key ever comes. stop may be null. All must outlive it.
  PromptKeys(Keyboard* keyboard, const Interrupts& interrupts, Display& display, const EmergencyStop* stop) noexcept
      : keyboard_(keyboard), interrupts_(interrupts), display_(display), stop_(stop) {}

  bool has_keyboard() const noexcept { return keyboard_ != nullptr; }
  // The session is to end: a signal, or there will be no more keys.
  bool ended() const noexcept { return interrupts_.end || (keyboard_ != nullptr && keyboard_->at_end()); }
  bool pause_asked() const noexcept { return interrupts_.pause; }
  // A person has stopped the rig, which is to be seen to before anything else; not while it is.
  bool stopped() const noexcept;
  // Returns what it was before.
  bool see_to_stop(bool seeing) noexcept { return std::exchange(seeing_to_stop_, seeing); }

  // A prompt is about to be shown. Returns the keys pressed before it, which do not answer it.
  std::vector<Key> prompt();
  // The keys that have come so far, without a prompt; not those that only change what is on view.
  std::vector<Key> heard();
  // Shows a stop as soon as it is latched: call wherever the session's thread comes by.
  void look_at_stop();
  // One that the console is told of in another way, or that is cleared.
  void show_stop(const std::string& by);
  void stop_cleared();
  // The next key that counts; none after about 20 ms, so that the caller looks at its other reasons to go on. Tells the
  // operator to let go of a key that is held down. text: keys are characters of a text, where one may be typed twice.
  std::optional<Key> next(bool text = false);
  // A line of text; none where it was cancelled, the rig was stopped or the session is to end.
  std::optional<std::string> line(const std::string& label, const std::string& initial = "");

 private:
  std::vector<Key> drain();
  // Help and large text.
  bool changes_view(const Key& key);
  std::optional<std::string> edited_line(const std::string& label, const std::string& initial);

  Keyboard* keyboard_;
  const Interrupts& interrupts_;
  Display& display_;
  const EmergencyStop* stop_;
  bool seeing_to_stop_ = false;
  HeldKeys held_;
  bool told_to_let_go_ = false;
  bool stop_shown_ = false;
};

}  // namespace jnd
