// Why a file cannot be opened, made, read or written, in words for whoever has to see to it.
#pragma once

#include <filesystem>
#include <string>

namespace jnd {

enum class FileUse { read, write };

struct FileTrouble {
  std::string why;         // "the disk is full"; names a folder or file where another one than `path` is in the way
  std::string what_to_do;  // "free some space on it and try again"

  // "the disk is full; free some space on it and try again"
  std::string text() const;
};

// error: errno of the call that failed. Looks at `path` and the folders above it to say which of them is meant.
FileTrouble file_trouble(const std::filesystem::path& path, int error, FileUse use);

// errno that an existing file can be told not to be writable by: of the file, of its folder (a study needs files beside
// it), or of a disk that is full. 0 where nothing is in the way.
int write_obstacle(const std::filesystem::path& path) noexcept;

}  // namespace jnd
