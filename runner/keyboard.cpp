#include "runner/keyboard.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "devices/clock.h"
#include "runner/terminal.h"

namespace jnd {

Keyboard::Keyboard() : terminal_(is_terminal(STDIN_FILENO)) {
  if (terminal_ && tcgetattr(STDIN_FILENO, &saved_) != 0) terminal_ = false;
  if (terminal_) wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (terminal_ && wake_ < 0) terminal_ = false;
  raw(true);
  if (terminal_) thread_ = std::thread([this] { read_keys(); });
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
  if (wake_ >= 0) close(wake_);
}

void Keyboard::raw(bool on) noexcept {
  if (!terminal_) return;
  termios settings = saved_;
  // Signals stay on: Ctrl-C must work whatever the session does.
  if (on) settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

void Keyboard::wake() const noexcept {
  const std::uint64_t one = 1;
  // A full counter would be awake already.
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof one);
}

// While paused, the input thread leaves standard input alone.
void Keyboard::pause(bool on) {
  if (!terminal_) return;
  std::unique_lock lock(mutex_);
  pausing_ = on;
  wake();
  changed_.wait(lock, [&] { return paused_ == on; });
}

void Keyboard::read_keys() {
  // Signals are for the session's thread, which waits for them.
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  const SteadyClock clock;
  for (;;) {
    {
      const std::scoped_lock lock(mutex_);
      if (ending_) return;
      if (paused_ != pausing_) {
        paused_ = pausing_;
        changed_.notify_all();
      }
    }
    std::array<pollfd, 2> waits = {pollfd{wake_, POLLIN, 0}, pollfd{paused_ || at_end_ ? -1 : STDIN_FILENO, POLLIN, 0}};
    if (poll(waits.data(), waits.size(), -1) <= 0) continue;
    if (waits[0].revents != 0) {
      std::uint64_t count = 0;
      [[maybe_unused]] const ssize_t got = ::read(wake_, &count, sizeof count);
      continue;  // what was asked of us comes before the keys
    }
    char character = 0;
    const ssize_t got = ::read(STDIN_FILENO, &character, 1);
    const std::int64_t now_ns = clock.now_ns();
    if (got == 0 || (got < 0 && errno != EINTR)) at_end_ = true;
    const std::scoped_lock lock(mutex_);
    if (got == 1 && character == kStopKey && stop_ != nullptr) stop_->latch(StopSource::key);
    if (got == 1 && now_ns >= early_before_ns_) keys_.push_back({character, now_ns});
    changed_.notify_all();
  }
}

void Keyboard::stop_with(EmergencyStop* stop) {
  const std::scoped_lock lock(mutex_);
  stop_ = stop;
}

std::optional<KeyPress> Keyboard::press(double timeout_s) {
  if (terminal_) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] { return !keys_.empty() || at_end_; });
    if (keys_.empty()) return std::nullopt;
    const KeyPress first = keys_.front();
    keys_.pop_front();
    return first;
  }
  pollfd descriptor{STDIN_FILENO, POLLIN, 0};
  const int ready = poll(&descriptor, 1, static_cast<int>(timeout_s * 1000));
  if (ready <= 0) return std::nullopt;  // time-out, or a signal: the caller looks at its latch
  char character = 0;
  const ssize_t got = ::read(STDIN_FILENO, &character, 1);
  if (got == 0 || (got < 0 && errno != EINTR)) at_end_ = true;
  if (got != 1 || character == '\n' || character == '\r') return std::nullopt;
  return KeyPress{character, SteadyClock().now_ns()};
}

std::optional<char> Keyboard::key(double timeout_s) {
  const std::optional<KeyPress> pressed = press(timeout_s);
  return pressed ? std::optional(pressed->key) : std::nullopt;
}

std::optional<std::string> Keyboard::line() {
  pause(true);
  raw(false);
  std::string text;
  char character = 0;
  ssize_t got = 0;
  while ((got = ::read(STDIN_FILENO, &character, 1)) == 1 && character != '\n') text += character;
  raw(true);
  if (got == 0) at_end_ = true;
  pause(false);
  if (got != 1 && text.empty()) return std::nullopt;  // end of input, or a signal
  return text;
}

void Keyboard::forget_early_keys() noexcept {
  if (!terminal_) return;
  tcflush(STDIN_FILENO, TCIFLUSH);
  const std::scoped_lock lock(mutex_);
  early_before_ns_ = SteadyClock().now_ns();
  keys_.clear();
}

}  // namespace jnd
