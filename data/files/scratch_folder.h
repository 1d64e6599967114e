// A folder that goes with its owner.
#pragma once

#include <filesystem>
#include <string_view>

namespace jnd {

class ScratchFolder {
 public:
  // purpose: part of its name, "sound". Throws StorageError where none can be made.
  explicit ScratchFolder(std::string_view purpose);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace jnd
