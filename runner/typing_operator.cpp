#include "runner/typing_operator.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "protocols/input_error.h"
#include "runner/terminal.h"

namespace jnd {

void TypingOperator::ask(const std::string& question) {
  fmt::print(stderr, "{}: ", printable(question));
  std::fflush(stderr);
}

void TypingOperator::say(const std::string& text) {
  fmt::print(stderr, "  {}\n", printable(text));
}

std::optional<std::string> TypingOperator::answer() {
  pollfd ready{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (poll(&ready, 1, 0) > 0) {
    char character = 0;
    const ssize_t got = ::read(STDIN_FILENO, &character, 1);
    if (got != 1) throw InputError("calibration: the input ended before the last point; nothing was changed");
    if (character == '\n') {
      std::string line;
      line.swap(typed_);
      return line;
    }
    typed_ += character;
  }
  return std::nullopt;
}

}  // namespace jnd
