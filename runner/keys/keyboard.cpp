#include "runner/keys/keyboard.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "devices/clock.h"
#include "runner/keys/screen_restore.h"
#include "runner/terminal/terminal.h"

namespace jnd {

namespace {
constexpr std::size_t kMostKeys = 4096;  // that wait for a prompt; what comes then is not kept
constexpr int kQuietGap_ms = static_cast<int>(KeyParser::kQuietGap_ns / 1'000'000);
}  // namespace

Keyboard::Keyboard() : terminal_(jnd::is_terminal(STDIN_FILENO)) {
  if (terminal_ && tcgetattr(STDIN_FILENO, &saved_) != 0) terminal_ = false;
  if (terminal_) wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (terminal_ && wake_ < 0) terminal_ = false;
  if (!terminal_) return;
  guard_terminal(saved_);
  raw(true);
  thread_ = std::thread([this] { read_keys(); });
}

Keyboard::~Keyboard() {
  if (thread_.joinable()) {
    {
      const std::scoped_lock lock(mutex_);
      ending_ = true;
    }
    wake();
    thread_.join();
  }
  raw(false);
  if (terminal_) forget_terminal();
  if (wake_ >= 0) close(wake_);
}

void Keyboard::raw(bool on) noexcept {
  if (!terminal_) return;
  termios settings = saved_;
  if (on) {
    // Signals stay on: Ctrl-C must work whatever the session does. Ctrl-S must not stop the screen, and with it the
    // session; Ctrl-Z must not freeze it.
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | IEXTEN);
    settings.c_iflag &= ~static_cast<tcflag_t>(IXON);
    settings.c_cc[VSUSP] = _POSIX_VDISABLE;
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
  }
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

void Keyboard::wake() const noexcept {
  const std::uint64_t one = 1;
  // A full counter would be awake already.
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof one);
}

void Keyboard::read_keys() {
  // Signals are for the session's thread, which waits for them; but a fault of this thread comes to this thread, and
  // one that is blocked would end the program without a handler.
  sigset_t others;
  sigfillset(&others);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT}) sigdelset(&others, fault);
  pthread_sigmask(SIG_BLOCK, &others, nullptr);
  // Where that is allowed, no work of other threads delays a stop or a stamp; the control loop still goes first.
  const sched_param lowest_of_realtime{.sched_priority = 1};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest_of_realtime);
  std::uint64_t asked = 0;
  for (;;) {
    bool reading = false;
    {
      const std::scoped_lock lock(mutex_);
      if (ending_) return;
      reading = !at_end_;
      asked = asked_to_catch_up_;
    }
    // A wait for all keys so far lasts until there is nothing left to read.
    const bool hurried = asked != caught_up_;
    if (hurried) {
      pollfd input{STDIN_FILENO, POLLIN, 0};
      while (reading && !at_end_ && poll(&input, 1, 0) > 0) take_input(true);
      const std::scoped_lock lock(mutex_);
      caught_up_ = asked;
      changed_.notify_all();
      continue;
    }
    switch (wait_for_input(reading)) {
      case Input::some:
        take_input(true);
        break;
      case Input::gap:
        take_input(false);
        break;
      case Input::none:
        break;
    }
  }
}

// Until there is input, something is asked of the thread, or the gap after an Escape byte is over. A terminal that has
// gone is ready to be read.
Keyboard::Input Keyboard::wait_for_input(bool reading) const noexcept {
  std::array<pollfd, 2> waits = {pollfd{wake_, POLLIN, 0}, pollfd{reading ? STDIN_FILENO : -1, POLLIN, 0}};
  const int ready = poll(waits.data(), waits.size(), parser_.waiting() ? kQuietGap_ms : -1);
  if (ready < 0) return Input::none;
  if (ready == 0) return Input::gap;
  if (waits[0].revents != 0) {
    std::uint64_t count = 0;
    [[maybe_unused]] const ssize_t got = ::read(wake_, &count, sizeof count);
    return Input::none;  // what was asked of us comes before the keys
  }
  return waits[1].revents != 0 ? Input::some : Input::none;
}

void Keyboard::take_input(bool some) {
  std::array<unsigned char, 64> bytes{};
  const ssize_t got = some ? ::read(STDIN_FILENO, bytes.data(), bytes.size()) : -1;
  const std::int64_t now_ns = SteadyClock().now_ns();
  const bool gone = some && (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN));
  if (gone) at_end_ = true;
  const std::scoped_lock lock(mutex_);
  if (const std::optional<Key> key = parser_.quiet(now_ns)) keep(*key);
  for (ssize_t i = 0; i < got; ++i) {
    if (const std::optional<Key> key = hear(bytes[static_cast<std::size_t>(i)], now_ns)) keep(*key);
  }
  changed_.notify_all();
}

std::optional<Key> Keyboard::hear(unsigned char byte, std::int64_t now_ns) {
  const bool stops = byte == kStopKey || byte == kStopKey - 'a' + 'A';
  if (stops && stop_ != nullptr && !typing_ && !parser_.within_sequence()) stop_->latch(StopSource::key);
  return parser_.feed(byte, now_ns);
}

void Keyboard::keep(const Key& key) {
  if (keys_.size() < kMostKeys) keys_.push_back(key);
}

void Keyboard::stop_with(EmergencyStop* stop) {
  const std::scoped_lock lock(mutex_);
  stop_ = stop;
}

std::optional<Key> Keyboard::press(double timeout_s) {
  if (!terminal_) return press_from_pipe(timeout_s);
  if (const int now = terminal_losses(); now != losses_) {
    losses_ = now;
    raw(true);  // the shell may have had the terminal in between
  }
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] { return !keys_.empty() || at_end_; });
  if (keys_.empty()) return std::nullopt;
  const Key first = keys_.front();
  keys_.pop_front();
  return first;
}

std::optional<Key> Keyboard::press_from_pipe(double timeout_s) {
  pollfd descriptor{STDIN_FILENO, POLLIN, 0};
  const int ready = poll(&descriptor, 1, static_cast<int>(timeout_s * 1000));
  const std::scoped_lock lock(mutex_);
  if (ready <= 0) return parser_.quiet(SteadyClock().now_ns());  // also after a signal: the caller looks at its latch
  unsigned char byte = 0;
  const ssize_t got = ::read(STDIN_FILENO, &byte, 1);
  if (got == 0 || (got < 0 && errno != EINTR)) at_end_ = true;
  if (got != 1) return std::nullopt;
  if (broken_line_) {
    broken_line_ = byte != '\n';
    return std::nullopt;
  }
  if (byte == '\n' || byte == '\r') return std::nullopt;
  return hear(byte, SteadyClock().now_ns());
}

std::optional<std::string> Keyboard::line(const Interrupts& interrupts) {
  const bool pausing = interrupts.pause;  // already: a note during the pause
  std::string text;
  for (char character = 0;;) {
    const ssize_t got = ::read(STDIN_FILENO, &character, 1);
    if (got < 0 && errno == EINTR) {
      if (!interrupts.end && interrupts.pause == pausing) continue;  // another signal
      broken_line_ = broken_line_ || !text.empty();
      return std::nullopt;
    }
    if (got != 1) {
      at_end_ = true;
      if (text.empty() || broken_line_) return std::nullopt;
      return text;
    }
    if (character != '\n') {
      text += character;
    } else if (broken_line_) {
      broken_line_ = false;
      text.clear();
    } else {
      return text;
    }
  }
}

void Keyboard::catch_up() {
  if (!terminal_) return;
  std::unique_lock lock(mutex_);
  const std::uint64_t mine = ++asked_to_catch_up_;
  wake();
  changed_.wait(lock, [&] { return caught_up_ >= mine; });
}

}  // namespace jnd
