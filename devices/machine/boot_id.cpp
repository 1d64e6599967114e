#include "devices/machine/boot_id.h"

#include <algorithm>
#include <ctime>
#include <fstream>

namespace jnd {

std::string boot_id(const std::filesystem::path& root) {
  constexpr std::size_t kLength = 36;  // a UUID, as RFC 9562 writes it
  std::ifstream file(root / "proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  const bool sound = id.size() == kLength && std::all_of(id.begin(), id.end(), [](char c) {
                       return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || c == '-';
                     });
  return sound ? id : "";
}

std::int64_t since_boot_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace jnd
