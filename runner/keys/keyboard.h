// Keys and lines from standard input. On a terminal, keys come one by one without Enter; the terminal is put back at
// the end, also after an exception or a crash.
//
// On a terminal a thread of its own reads the keys: it stamps each with the monotonic clock at once, trips the
// emergency stop when the stop key comes, whatever the rest of the program is doing, and does nothing else.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <termios.h>

#include "devices/emergency_stop.h"
#include "runner/keys/interrupt.h"
#include "runner/keys/key_parser.h"

namespace jnd {

inline constexpr char kStopKey = 'x';  // as a capital too

// Thread rule: members are for one thread; the input thread is inside.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_terminal() const noexcept { return terminal_; }
  // The next key, or none after timeout_s, which is real time. Line ends are skipped where there is no terminal.
  std::optional<Key> press(double timeout_s);
  // A line of a pipe, without its end. None at the end of input, and where one of the interrupts is set meanwhile: what
  // had come of the line then counts as nothing, as does the rest of it.
  std::optional<std::string> line(const Interrupts& interrupts);
  // Returns once every key that had come before the call is there for press(): whatever comes later was pressed later.
  // A pipe's writer cannot wait, so there it does nothing.
  void catch_up();
  bool at_end() const noexcept { return at_end_; }

  // From now on the stop key latches `stop`: on a terminal when it is pressed, in a pipe when its turn comes. Null: no
  // more. `stop` must live until then.
  void stop_with(EmergencyStop* stop);
  // While text is typed the stop key is a letter. Returns how it was before.
  bool typing(bool on) noexcept { return typing_.exchange(on); }

 private:
  void raw(bool on) noexcept;
  void wake() const noexcept;
  void read_keys();  // the input thread
  enum class Input { none, some, gap };
  Input wait_for_input(bool reading) const noexcept;
  void take_input(bool some);
  void keep(const Key& key);
  // The stop key latches, and every byte is decoded. With the mutex.
  std::optional<Key> hear(unsigned char byte, std::int64_t now_ns);
  std::optional<Key> press_from_pipe(double timeout_s);

  bool terminal_;
  int losses_ = 0;
  std::atomic<bool> at_end_{false};
  std::atomic<bool> typing_{false};
  bool broken_line_ = false;  // the rest of a line is still to come
  termios saved_{};

  std::mutex mutex_;  // guards what follows
  EmergencyStop* stop_ = nullptr;
  std::condition_variable changed_;
  std::deque<Key> keys_;
  KeyParser parser_;
  std::uint64_t asked_to_catch_up_ = 0, caught_up_ = 0;
  bool ending_ = false;
  int wake_ = -1;  // an eventfd
  std::thread thread_;
};

// While it lives, the stop key latches `stop`. keyboard may be null.
class StopOnKey {
 public:
  StopOnKey(Keyboard* keyboard, EmergencyStop& stop) : keyboard_(keyboard) {
    if (keyboard_ != nullptr) keyboard_->stop_with(&stop);
  }
  ~StopOnKey() {
    if (keyboard_ != nullptr) keyboard_->stop_with(nullptr);
  }
  StopOnKey(const StopOnKey&) = delete;
  StopOnKey& operator=(const StopOnKey&) = delete;

 private:
  Keyboard* keyboard_;
};

// While it lives, keys are text; or are not, as in a dialog that a page of text has.
class TypingText {
 public:
  explicit TypingText(Keyboard& keyboard, bool text = true) noexcept
      : keyboard_(keyboard), before_(keyboard.typing(text)) {}
  ~TypingText() { keyboard_.typing(before_); }
  TypingText(const TypingText&) = delete;
  TypingText& operator=(const TypingText&) = delete;

 private:
  Keyboard& keyboard_;
  bool before_;
};

}  // namespace jnd
