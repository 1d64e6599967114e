// A folder of files that appears as a whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace jnd {

class ExportFolder {
 public:
  // Throws StorageError where `folder` exists and replace is false, or holds anything that an export does not write
  // (nothing of it is touched then), or cannot be written.
  ExportFolder(const std::filesystem::path& folder, bool replace);
  ~ExportFolder();  // removes what was not published
  ExportFolder(const ExportFolder&) = delete;
  ExportFolder& operator=(const ExportFolder&) = delete;

  // Throws StorageError, also where the name leads out of the folder.
  void write(const std::string& relative, const std::string& bytes);
  // Moves the finished folder to its name. Returns the files, relative, in alphabetical order. Throws StorageError.
  std::vector<std::string> publish();

 private:
  std::filesystem::path folder_, draft_;
  bool replace_;
  std::vector<std::string> files_;
};

}  // namespace jnd
