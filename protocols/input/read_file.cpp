#include "protocols/input/read_file.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "protocols/input/file_trouble.h"
#include "protocols/input/input_error.h"

namespace jnd {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& message, const std::string& suggestion) {
  throw InputError(std::vector<Diagnostic>{{path.string(), 0, 0, "", message, suggestion}});
}

// From errno.
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what, int error) {
  const FileTrouble trouble = file_trouble(path, error, FileUse::read);
  fail(path, fmt::format("{}: {}", what, trouble.why), trouble.what_to_do);
}

class Descriptor {
 public:
  // Without waiting: the opening of a named pipe would wait until a program writes to it.
  explicit Descriptor(const std::filesystem::path& path)
      : value_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
  ~Descriptor() {
    if (value_ >= 0) close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const noexcept { return value_; }

 private:
  int value_;
};

// A shell's <(command), or standard input by its name: its other end is there from the beginning.
bool is_nameless_pipe(int descriptor) noexcept {
  struct statfs status {};
  return fstatfs(descriptor, &status) == 0 && status.f_type == PIPEFS_MAGIC;
}

void refuse_what_is_no_file(const std::filesystem::path& path, int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(path, "cannot be read", errno);
  if (S_ISREG(status.st_mode)) return;
  if (S_ISDIR(status.st_mode)) fail(path, "is a folder", "name a file in it");
  if (!S_ISFIFO(status.st_mode)) fail(path, "is a device, not a file", "name a file");
  if (!is_nameless_pipe(descriptor))
    fail(path, "is a named pipe, which may wait for ever", "write what it gives into a file, and name that");
  fcntl(descriptor, F_SETFL, O_RDONLY);  // from here on it may wait, for the program at its other end
}

std::string size_text(std::size_t bytes) {
  return bytes >= 1U << 20U ? fmt::format("{} MiB", bytes >> 20U) : fmt::format("{} bytes", bytes);
}

std::string read_to_end(const std::filesystem::path& path, int descriptor, std::size_t limit) {
  std::string bytes;
  std::array<char, 65536> piece{};
  for (;;) {
    const ssize_t got = read(descriptor, piece.data(), piece.size());
    if (got == 0) return bytes;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot be read to its end", errno);
    if (static_cast<std::size_t>(got) > limit - bytes.size())
      fail(path, fmt::format("is larger than {}", size_text(limit)), "is it the right file?");
    bytes.append(piece.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

std::string read_input_file(const std::filesystem::path& path, std::size_t limit) {
  const Descriptor file(path);
  if (file.value() < 0 && errno == ENXIO) fail(path, "is a socket, or a device that is not there", "name a file");
  if (file.value() < 0) fail(path, "cannot be opened", errno);
  refuse_what_is_no_file(path, file.value());
  return read_to_end(path, file.value(), limit);
}

std::string read_standard_input(std::size_t limit) {
  return read_to_end("standard input", STDIN_FILENO, limit);
}

}  // namespace jnd
