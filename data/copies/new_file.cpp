#include "data/copies/new_file.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "data/files/left_beside.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

StorageError taken(const fs::path& path) {
  return StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
}

void flush(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw cannot_write(path, errno);
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  if (error != 0) throw cannot_write(path, error);
}

}  // namespace

void refuse_beside(const fs::path& source, const fs::path& to) {
  std::error_code ignored;  // of names that nothing has
  if (fs::equivalent(source, to, ignored))
    throw StorageError(fmt::format("{}: is the study itself; choose another name for the new file", to.string()));
  if (fs::equivalent(source, to.string() + ".lock", ignored))
    throw StorageError(fmt::format("{}: would overwrite {}, which it is to be made from; choose another name",
                                   to.string(), source.string()));
}

NewFile::NewFile(const fs::path& path, bool replace)
    : path_(path), replace_(replace), lock_(path), draft_(allowed_path(), Draft::What::file) {}

const fs::path& NewFile::allowed_path() const {
  const fs::file_status status = fs::symlink_status(path_);
  if (fs::exists(status) && !replace_) throw taken(path_);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw StorageError(fmt::format("{}: is not a file and cannot be replaced", path_.string()));
  refuse_left_beside(path_);
  return path_;
}

void NewFile::publish(const std::function<void(const fs::path&)>& may_go) {
  flush(made());
  allowed_path();
  if (!replace_ && !draft_.publish()) throw taken(path_);
  // The lock has kept this program's writers away, but no other program.
  if (replace_)
    draft_.replace([&](const fs::path& earlier) {
      if (may_go) may_go(earlier);
    });
}

}  // namespace jnd
