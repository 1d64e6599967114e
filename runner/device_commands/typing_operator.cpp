#include "runner/device_commands/typing_operator.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "protocols/input/input_error.h"
#include "runner/terminal/standard_streams.h"
#include "runner/terminal/terminal.h"

namespace jnd {

void TypingOperator::ask(const std::string& question) {
  print_message("{}: ", printable(question));
}

void TypingOperator::say(const std::string& text) {
  print_message("  {}\n", printable(text));
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
