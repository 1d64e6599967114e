#include "data/new_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "data/storage_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

fs::path beside(const fs::path& path, const char* suffix) {
  return path.string() + suffix;
}

StorageError cannot(const fs::path& path, int error) {
  return StorageError(fmt::format("{}: cannot be written: {}; check the disk, the folder and its permissions",
                                  path.string(), std::strerror(error)));
}

void flush(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) throw cannot(path, errno);
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (error != 0) throw cannot(path, error);
}

void remove_made(const fs::path& made) noexcept {
  ::unlink(made.c_str());
  for (const char* suffix : {"-journal", "-wal", "-shm"}) ::unlink(beside(made, suffix).c_str());
}

}  // namespace

void refuse_beside(const fs::path& source, const fs::path& to) {
  std::error_code ignored;  // of names that nothing has
  if (fs::equivalent(source, to, ignored))
    throw StorageError(fmt::format("{}: is the study itself; choose another name for the new file", to.string()));
  for (const char* suffix : {".new", ".lock", ".new-wal", ".new-shm", ".new-journal"})
    if (fs::equivalent(source, beside(to, suffix), ignored))
      throw StorageError(fmt::format("{}: would overwrite {}, which it is to be made from; choose another name",
                                     to.string(), source.string()));
}

int give_name(const fs::path& made, const fs::path& path) noexcept {
  if (::link(made.c_str(), path.c_str()) == 0) {
    ::unlink(made.c_str());
    return 0;
  }
  // FAT and exFAT, which USB sticks have, know no second name of a file.
  if (errno != EPERM && errno != ENOTSUP) return errno;
  return ::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE) == 0 ? 0 : errno;
}

NewFile::NewFile(const fs::path& path, bool replace)
    : path_(path), made_(beside(path, ".new")), replace_(replace), lock_(path) {
  refuse_existing();
  remove_made(made_);
}

NewFile::~NewFile() {
  remove_made(made_);
}

void NewFile::refuse_existing() const {
  const fs::file_status status = fs::symlink_status(path_);
  if (!fs::exists(status)) return;
  if (!replace_) throw StorageError(fmt::format("{}: exists already; it was not changed", path_.string()));
  if (!fs::is_regular_file(status))
    throw StorageError(fmt::format("{}: is not a file and cannot be replaced", path_.string()));
  // SQLite would play the old file's log into the new one.
  for (const char* suffix : {"-wal", "-journal"})
    if (fs::exists(beside(path_, suffix)))
      throw StorageError(
          fmt::format("{}: is open in a program, or was left by one that was killed ({} lies beside it); close that "
                      "program, run jnd verify on the file, and try again",
                      path_.string(), beside(path_, suffix).string()));
}

void NewFile::publish() {
  flush(made_, O_RDONLY);
  refuse_existing();
  if (replace_) {
    if (std::rename(made_.c_str(), path_.c_str()) != 0) throw cannot(path_, errno);
  } else if (const int error = give_name(made_, path_); error != 0) {
    if (error == EEXIST) throw StorageError(fmt::format("{}: exists already; it was not changed", path_.string()));
    throw cannot(path_, error);
  }
  flush(path_.has_parent_path() ? path_.parent_path() : fs::path("."), O_RDONLY | O_DIRECTORY);
}

}  // namespace jnd
