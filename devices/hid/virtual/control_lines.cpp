#include "devices/hid/virtual/control_lines.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "devices/device_error.h"

namespace jnd {

namespace {
// A line longer than this is none of ours; it is thrown away.
constexpr std::size_t kLongestLine = 4096;
}  // namespace

ControlLines::ControlLines(const std::filesystem::path& path) {
  if (path.empty()) {
    fd_ = STDIN_FILENO;
    return;
  }
  own_ = true;
  const bool made = ::mkfifo(path.c_str(), 0600) == 0;
  // For reading and writing: a named pipe then never comes to its end when a writer leaves.
  fd_ = made || errno == EEXIST ? ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
  if (fd_ < 0)
    throw DeviceError(
        fmt::format("cannot open the control file {}: {}; give --control a path in a folder that you may "
                    "write to, or leave it out to use the standard input",
                    path.string(), std::strerror(errno)));
}

ControlLines::~ControlLines() {
  if (own_ && fd_ >= 0) ::close(fd_);
}

void ControlLines::serve(const std::function<void(std::string_view)>& line) {
  std::array<char, 1024> bytes{};
  const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) {
    if (own_) ::close(fd_);
    fd_ = -1;
    if (rest_.find_first_not_of(" \t\r") != std::string::npos) line(rest_);
    return;
  }
  rest_.append(bytes.data(), static_cast<std::size_t>(count));
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view whole = std::string_view(rest_).substr(begin, end - begin);
    if (whole.find_first_not_of(" \t\r") != std::string_view::npos) line(whole);
  }
  rest_.erase(0, begin);
  if (rest_.size() > kLongestLine) rest_.clear();
}

}  // namespace jnd
