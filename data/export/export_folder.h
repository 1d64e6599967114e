// A folder of files that appears as a whole or not at all, and takes the place only of one that holds nothing but what
// was written into it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "data/files/draft.h"

namespace jnd {

class ExportFolder {
 public:
  // Throws StorageError where `folder` exists and replace is false, or where it holds anything but unchanged files of
  // an earlier one (nothing of it is touched then), or cannot be written. An empty folder may be replaced.
  ExportFolder(const std::filesystem::path& folder, bool replace);

  // Throws StorageError, also where the name leads out of the folder or was written before, and Stopped.
  void write(const std::string& relative, const std::string& bytes);
  // Adds SHA256SUMS, by which such a folder is known again: after it nothing more is written, and nothing of the disk
  // is needed for its place. Throws StorageError.
  void finish();
  // Puts the folder, finished first where it is not, into its place. Returns the files but SHA256SUMS, relative, in
  // alphabetical order. Throws StorageError.
  std::vector<std::string> publish();

 private:
  std::filesystem::path folder_;
  bool replace_;
  std::unique_ptr<Draft> draft_;
  std::map<std::string, std::string> sums_;  // by file, relative
  bool finished_ = false;
};

}  // namespace jnd
