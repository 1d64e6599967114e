// One writer a study: a lock that the kernel drops when its process ends, however it ends.
#pragma once

#include <filesystem>

namespace jnd {

// Holds flock(2) on "<study>.lock". Not on the study itself: closing any descriptor of that file would drop SQLite's
// own POSIX locks of the same process.
class StudyLock {
 public:
  // Throws StorageError where another StudyLock holds it (naming the process) or the folder cannot be written.
  explicit StudyLock(const std::filesystem::path& study);
  ~StudyLock();  // removes the lock file
  StudyLock(const StudyLock&) = delete;
  StudyLock& operator=(const StudyLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace jnd
