#include "runner/terminal/standard_streams.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "runner/terminal/terminal.h"

namespace jnd {

void keep_standard_streams() noexcept {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The other way round, so that its use fails as before. open() takes the lowest number that is free: this one.
    [[maybe_unused]] const int taken = open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

void write_message(std::string_view text) noexcept {
  [[maybe_unused]] const std::size_t written = std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void write_marked_message(std::string_view message) {
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    print_message("jnd: {}\n", printable(message.substr(begin, end - begin)));
    begin = end + 1;
  }
}

std::string output_trouble() noexcept {
  errno = 0;
  const bool failed = std::fflush(stdout) != 0;
  const int reason = errno;
  if (!failed && std::ferror(stdout) == 0) return {};
  return failed && reason != 0 ? std::strerror(reason) : "an earlier write failed";
}

}  // namespace jnd
