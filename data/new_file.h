// A file that appears whole or not at all: it is made as FILE.new and gets its name when it is finished.
#pragma once

#include <filesystem>

#include "data/study_lock.h"

namespace jnd {

// Making `to` removes what lies beside it under the names of NewFile and StudyLock. Throws StorageError where `source`,
// which it is made from, is one of these files or `to` itself. Ask before anything is locked.
void refuse_beside(const std::filesystem::path& source, const std::filesystem::path& to);

// Gives a finished file its name and takes `made` away; a file that has the name already is never replaced. 0 or errno.
int give_name(const std::filesystem::path& made, const std::filesystem::path& path) noexcept;

// Holds FILE.lock while it lives, so that two programs never make the same file, and a study that is being written is
// never replaced. Without publish() nothing of it stays.
class NewFile {
 public:
  // Throws StorageError: the file exists (unless replace), is in use, or its folder cannot be written. What a killed
  // program left as FILE.new is removed.
  explicit NewFile(const std::filesystem::path& path, bool replace = false);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  // Where to write it; not made yet.
  const std::filesystem::path& made() const noexcept { return made_; }
  const std::filesystem::path& path() const noexcept { return path_; }
  // Flushes it, gives it its name and flushes the folder, so that it survives a power cut. Throws StorageError.
  void publish();

 private:
  void refuse_existing() const;

  std::filesystem::path path_, made_;
  bool replace_;
  StudyLock lock_;
};

}  // namespace jnd
