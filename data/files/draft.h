// What a command writes appears whole or not at all: it is made under a name of its own beside its place, and then gets
// its name, or changes places with what stood there. Where a file system cannot let two names change places, a file is
// renamed over what stood there, and a folder is absent for an instant.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "data/log/storage_error.h"

namespace jnd {

// The folder that has this file, or is to have it.
std::filesystem::path folder_of(const std::filesystem::path& place);

// "{path}: cannot be written: ..." from errno, with what to do about it (protocols/input/file_trouble.h).
StorageError cannot_write(const std::filesystem::path& path, int error);
StorageError cannot_read(const std::filesystem::path& path, int error);

// A file within a folder's draft, written piece by piece and never over one that exists.
class DraftPart {
 public:
  // path: of the file; place: what it is called where it cannot be written. Throws StorageError, as write and close do.
  DraftPart(const std::filesystem::path& path, std::filesystem::path place);
  ~DraftPart();
  DraftPart(DraftPart&& other) noexcept;
  DraftPart& operator=(DraftPart&&) = delete;
  void write(std::string_view bytes);
  void close();

 private:
  std::filesystem::path place_;
  int descriptor_ = -1;
};

// A file or folder called NAME.jnd-draft-XXXXXX until it is finished. It is never opened through a link, nor over
// anything that exists, and is locked while this program lives: what killed programs left for the same place is cleared
// away by the next one, and nothing else is.
class Draft {
 public:
  enum class What { file, folder };
  // What people said and did is for its owner (0600, folders and those within them 0700), whatever the umask; other
  // files follow the umask.
  enum class Access { owner, everyone };
  // Makes it, empty. Throws StorageError.
  Draft(const std::filesystem::path& place, What what, Access access = Access::owner);
  ~Draft();  // removes it where it was not published
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }
  // A file's content. Throws StorageError.
  void write(std::string_view bytes) const;
  // A file within the folder, which must not exist yet; folders on its way are made. It is flushed when the folder gets
  // its name. Throws StorageError.
  void write_within(const std::filesystem::path& relative, std::string_view bytes) const;
  // The same for a file that comes piece by piece.
  DraftPart open_within(const std::filesystem::path& relative) const;

  // Gives it its name. False where something has that name: then nothing is changed. Throws StorageError.
  bool publish();
  // The same where `may_go` of what has the name throws nothing. It is asked before and, of what was there until then,
  // once more after both have changed places: where it throws then, they change back, and it is asked of the place for
  // the words. So nothing that was put there meanwhile is lost; what cannot change back is kept under a name that the
  // StorageError says. Where names cannot change places, it is asked about a file only before.
  void replace(const std::function<void(const std::filesystem::path&)>& may_go);

 private:
  void finish();  // flushes the names
  // Gives `old` a name that clear_drafts() leaves alone.
  StorageError kept(const std::filesystem::path& old, int error) const;

  std::filesystem::path place_, path_;
  What what_;
  Access access_;
  int descriptor_ = -1;
};

// What killed programs left beside `place` as its drafts.
std::vector<std::filesystem::path> left_drafts(const std::filesystem::path& place);

// Removes what killed programs left beside `place` as its drafts. A folder that one had taken away from its place to
// put another there, on a file system where two names cannot change places at once, is put back; it is removed only
// where something else has that place.
void clear_drafts(const std::filesystem::path& place);

// Gives a finished file or folder its name and takes `made` away; what has the name already is never replaced. 0 or
// errno.
int give_name(const std::filesystem::path& made, const std::filesystem::path& path) noexcept;

}  // namespace jnd
