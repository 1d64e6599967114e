#include "data/files/left_beside.h"

#include <system_error>

#include <fmt/format.h>

#include "data/log/storage_error.h"

namespace jnd {

std::optional<std::filesystem::path> left_beside(const std::filesystem::path& name) {
  for (const char* suffix : kBesideDatabase) {
    std::filesystem::path beside = name.string() + suffix;
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(beside, ignored))) return beside;
  }
  return std::nullopt;
}

void refuse_left_beside(const std::filesystem::path& name) {
  if (const auto beside = left_beside(name))
    throw StorageError(
        fmt::format("{}: {} lies beside this name and would be taken for the new file's own; nothing was changed. It "
                    "belongs to the study that has, or had, this name, and may hold answers: close the program that "
                    "has that study open, or put the study back here and run jnd verify on it; or choose another name",
                    name.string(), beside->string()));
}

}  // namespace jnd
