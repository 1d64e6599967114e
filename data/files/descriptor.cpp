#include "data/files/descriptor.h"

#include <cerrno>

#include <unistd.h>

namespace jnd {

bool same_file(const struct stat& one, const struct stat& other) noexcept {
  return one.st_ino == other.st_ino && one.st_dev == other.st_dev;
}

bool is_at(const std::filesystem::path& path, int descriptor, Links links) noexcept {
  struct stat open {
  }, named{};
  const auto look = links == Links::followed ? ::stat : ::lstat;
  return ::fstat(descriptor, &open) == 0 && look(path.c_str(), &named) == 0 && same_file(open, named);
}

int write_all(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace jnd
