#include "runner/keyboard.h"

#include <cerrno>

#include <poll.h>
#include <unistd.h>

#include "runner/terminal.h"

namespace jnd {

Keyboard::Keyboard() : terminal_(is_terminal(STDIN_FILENO)) {
  if (terminal_ && tcgetattr(STDIN_FILENO, &saved_) != 0) terminal_ = false;
  raw(true);
}

Keyboard::~Keyboard() {
  raw(false);
}

void Keyboard::raw(bool on) noexcept {
  if (!terminal_) return;
  termios settings = saved_;
  // Signals stay on: Ctrl-C must work whatever the session does.
  if (on) settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

std::optional<char> Keyboard::key(double timeout_s) {
  pollfd descriptor{STDIN_FILENO, POLLIN, 0};
  const int ready = poll(&descriptor, 1, static_cast<int>(timeout_s * 1000));
  if (ready <= 0) return std::nullopt;  // time-out, or a signal: the caller looks at its latch
  char character = 0;
  const ssize_t got = read(STDIN_FILENO, &character, 1);
  if (got == 0 || (got < 0 && errno != EINTR)) at_end_ = true;
  if (got != 1 || (!terminal_ && (character == '\n' || character == '\r'))) return std::nullopt;
  return character;
}

std::optional<std::string> Keyboard::line() {
  raw(false);
  std::string text;
  char character = 0;
  ssize_t got = 0;
  while ((got = read(STDIN_FILENO, &character, 1)) == 1 && character != '\n') text += character;
  raw(true);
  if (got == 0) at_end_ = true;
  if (got != 1 && text.empty()) return std::nullopt;  // end of input, or a signal
  return text;
}

void Keyboard::forget_early_keys() const noexcept {
  if (terminal_) tcflush(STDIN_FILENO, TCIFLUSH);
}

}  // namespace jnd
