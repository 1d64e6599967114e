#include "protocols/input/file_trouble.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace jnd {

namespace {

namespace fs = std::filesystem;

fs::path folder_above(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).parent_path();
}

// 0 or errno, as the user whose rights count.
int access_error(const fs::path& path, int mode) noexcept {
  return ::faccessat(AT_FDCWD, path.c_str(), mode, AT_EACCESS) == 0 ? 0 : errno;
}

bool is_there(const fs::path& path) noexcept {
  struct stat ignored {};
  return ::stat(path.c_str(), &ignored) == 0;
}

bool is_folder(const fs::path& path) noexcept {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
}

// The first folder on the way to `path` that is as asked; empty where none is.
template <typename Asked>
fs::path first_above(const fs::path& path, Asked asked) {
  const fs::path folder = folder_above(path);
  fs::path above;
  for (const fs::path& part : folder) {
    above /= part;
    if (asked(above)) return above;
  }
  return {};
}

FileTrouble no_permission(const fs::path& path, int error, FileUse use) {
  const auto trouble = [](const std::string& what, const std::string& name) {
    return FileTrouble{fmt::format("no permission to {} {}", what, name),
                       fmt::format("change the permissions of that {} (or ask its owner to), or choose another place",
                                   name.starts_with("the folder") ? "folder" : "file")};
  };
  const fs::path closed =
      first_above(path, [](const fs::path& above) { return is_folder(above) && access_error(above, X_OK) == EACCES; });
  if (!closed.empty()) return trouble("enter", fmt::format("the folder {}", closed.string()));
  const fs::path folder = folder_above(path);
  if (use == FileUse::write && is_folder(folder) && access_error(folder, W_OK) == EACCES)
    return trouble("write to", fmt::format("the folder {}", folder.string()));
  if (access_error(path, use == FileUse::write ? W_OK : R_OK) == EACCES)
    return trouble(use == FileUse::write ? "write to" : "read",
                   fmt::format("{} {}", is_folder(path) ? "the folder" : "the file", path.string()));
  return {fmt::format("the system does not permit it ({})", std::strerror(error)),
          "look at the permissions and attributes (lsattr) of the file and its folder, or choose another place"};
}

FileTrouble nothing_there(const fs::path& path, FileUse use) {
  const fs::path missing = first_above(path, [](const fs::path& above) { return !is_there(above); });
  if (!missing.empty())
    return {fmt::format("there is no such folder: {}", missing.string()), "make it, or correct the path"};
  if (use == FileUse::read) return {"there is no such file", "look at the path"};
  return {"the system makes no file of that name there", "look at the path, or choose another place"};
}

FileTrouble no_folder(const fs::path& path) {
  fs::path file = first_above(path, [](const fs::path& above) { return is_there(above) && !is_folder(above); });
  if (file.empty() && is_there(path) && !is_folder(path)) file = path;  // that was to be a folder itself
  if (file.empty()) return {"a part of its path is a file, not a folder", "correct the path"};
  return {fmt::format("{} is a file, not a folder", file.string()), "correct the path"};
}

}  // namespace

std::string FileTrouble::text() const {
  return fmt::format("{}; {}", why, what_to_do);
}

FileTrouble file_trouble(const fs::path& path, int error, FileUse use) {
  switch (error) {
    case EACCES:
    case EPERM:
      return no_permission(path, error, use);
    case EROFS:
      return {"the disk is mounted read-only",
              "choose another place, or find out why (a disk with errors becomes read-only: dmesg) and try again"};
    case ENOSPC:
      return {"the disk is full", "free some space on it and try again"};
    case EDQUOT:
      return {"the quota of disk space is used up", "delete files of yours there, or ask for more, and try again"};
    case EFBIG:
      return {"the file would be larger than is allowed there",
              "choose another disk, or raise the limit (ulimit -f), and try again"};
    case ENOENT:
      return nothing_there(path, use);
    case ENOTDIR:
      return no_folder(path);
    case EISDIR:
      return {"it is a folder, not a file", "name a file in it"};
    case EIO:
      return {"the disk reported an error", "look after the disk (cable, mount, dmesg) and try again"};
    default:
      return {std::strerror(error), "look at the disk, the folder and its permissions"};
  }
}

int write_obstacle(const fs::path& path) noexcept {
  try {
    if (is_folder(path)) return EISDIR;
    if (const int error = access_error(path, W_OK); error != 0) return error;
    const fs::path folder = folder_above(path);
    if (const int error = access_error(folder, W_OK | X_OK); error != 0) return error;
    struct statvfs space {};
    const bool full = ::statvfs(folder.c_str(), &space) == 0 &&
                      ((space.f_blocks > 0 && space.f_bavail == 0) || (space.f_files > 0 && space.f_favail == 0));
    return full ? ENOSPC : 0;
  } catch (const std::exception&) {
    return ENOMEM;
  }
}

}  // namespace jnd
