// A study that appears whole or not at all: it is made as a draft and gets its name when it is finished.
#pragma once

#include <filesystem>
#include <functional>

#include "data/files/draft.h"
#include "data/study/study_lock.h"

namespace jnd {

// Making `to` takes its lock. Throws StorageError where `source`, which it is made from, is the lock file or `to`
// itself. Ask before anything is locked.
void refuse_beside(const std::filesystem::path& source, const std::filesystem::path& to);

// Holds FILE.lock while it lives, so that two programs never make the same file, and a study that is being written is
// never replaced. Without publish() nothing of it stays.
class NewFile {
 public:
  // Throws StorageError: the file exists (unless replace), is in use, has something of SQLite's beside its name, or its
  // folder cannot be written.
  explicit NewFile(const std::filesystem::path& path, bool replace = false);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  // Where to write it: an empty file, readable by its owner only.
  const std::filesystem::path& made() const noexcept { return draft_.path(); }
  const std::filesystem::path& path() const noexcept { return path_; }
  // Flushes it, gives it its name and flushes the folder, so that it survives a power cut. may_go: throws where the
  // file that would be replaced is not to go; it is asked as Draft::replace says. Throws StorageError.
  void publish(const std::function<void(const std::filesystem::path&)>& may_go = {});

 private:
  const std::filesystem::path& allowed_path() const;  // throws StorageError where it is taken

  std::filesystem::path path_;
  bool replace_;
  StudyLock lock_;
  Draft draft_;
};

}  // namespace jnd
