// One writer a study: a lock that the kernel drops when its process ends, however it ends.
#pragma once

#include <filesystem>
#include <string>

namespace jnd {

// Where a file really is: absolute, every symbolic link on the way resolved, also where the file does not exist yet.
std::filesystem::path real_place(const std::filesystem::path& path);

// "process 12 (sqlite3)": the other programs that have the file of this descriptor open, as far as this user may see
// them; empty where there are none.
std::string open_elsewhere(int descriptor);

// Whether a process writes to this study just now; elsewhere: another one than this. Leaves nothing behind and needs no
// right to write.
bool in_use(const std::filesystem::path& study, bool elsewhere = false);
// Throws StorageError where one does.
void refuse_in_use(const std::filesystem::path& study);

// Holds two locks. flock(2) on "<study>.lock" keeps a name, also of a study that is still to be made, and names the
// process. A lock of the open file (F_OFD_SETLK) on a byte of the study itself, far behind all that SQLite locks, holds
// whatever the study's name is: under another link, moved, or with its .lock file removed.
// The descriptor of the study must outlive this process's SQLite connections to it: closing any descriptor of a file
// drops SQLite's own POSIX locks of the same process.
class StudyLock {
 public:
  // Throws StorageError where another StudyLock holds either (naming the process), where STUDY.lock is no lock file, or
  // where the folder cannot be written. A study that may only be read is locked against writers all the same.
  explicit StudyLock(const std::filesystem::path& study);
  ~StudyLock();  // removes the lock file
  StudyLock(const StudyLock&) = delete;
  StudyLock& operator=(const StudyLock&) = delete;

  // The study itself, where it was made after the lock was taken. Throws StorageError.
  void hold_file();
  // Throws StorageError where the study has other names (hard links): what is written under one of them damages what
  // the others see. Names that killed programs left as drafts are cleared away before.
  void refuse_other_names() const;

  // Of the study; -1 where it does not exist yet.
  int descriptor() const noexcept { return file_; }
  const std::filesystem::path& place() const noexcept { return place_; }

 private:
  std::filesystem::path study_, place_, path_;
  int descriptor_ = -1;
  int file_ = -1;
};

}  // namespace jnd
