// Keys and lines from standard input. On a terminal, keys come one by one without Enter; the terminal is put back at
// the end, also after an exception.
//
// On a terminal a thread of its own reads the keys: it stamps each with the monotonic clock, trips the emergency stop
// when the stop key comes, whatever the rest of the program is doing, and does nothing else.
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

namespace jnd {

inline constexpr char kStopKey = 'x';

struct KeyPress {
  char key = 0;
  std::int64_t time_ns = 0;  // of the steady clock
};

// Thread rule: members are for one thread; the input thread is inside.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  // The next key, or none after timeout_s. Line ends count as '\n' on a terminal and are skipped elsewhere.
  std::optional<KeyPress> press(double timeout_s);
  std::optional<char> key(double timeout_s);
  // A line, without its end; none at the end of input. Shows what is typed.
  std::optional<std::string> line();
  // Forgets keys that were pressed before now: call it before the prompt is shown, so that whoever answers the prompt
  // is heard. On a terminal only, since a pipe's writer cannot wait.
  void forget_early_keys() noexcept;
  bool at_end() const noexcept { return at_end_; }

  // From now on kStopKey latches `stop`, on a terminal; null: no more. `stop` must live until then.
  void stop_with(EmergencyStop* stop);

 private:
  void raw(bool on) noexcept;
  void pause(bool on);
  void wake() const noexcept;
  void read_keys();  // the input thread

  bool terminal_;
  std::atomic<bool> at_end_{false};
  termios saved_{};

  std::mutex mutex_;  // guards what follows
  EmergencyStop* stop_ = nullptr;
  std::condition_variable changed_;
  std::deque<KeyPress> keys_;
  std::int64_t early_before_ns_ = 0;  // keys of an earlier time are forgotten, also one that is just being read
  bool pausing_ = false, paused_ = false, ending_ = false;
  int wake_ = -1;  // an eventfd
  std::thread thread_;
};

// While it lives, kStopKey latches `stop`. keyboard may be null.
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

}  // namespace jnd
