#include "data/study_lock.h"

#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/storage_error.h"

namespace jnd {

namespace {

std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t length = ::pread(descriptor, text.data(), text.size() - 1, 0);
  const std::string pid(text.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
  if (pid.empty()) return "another process";
  std::string name;
  if (std::ifstream file("/proc/" + pid + "/comm"); file) std::getline(file, name);
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_'; });
  return name.empty() ? fmt::format("process {}", pid) : fmt::format("process {} ({})", pid, name);
}

// False where another process removed the file between our open and our lock: the lock then guards nothing.
bool still_there(int descriptor, const std::filesystem::path& path) {
  struct stat ours {};
  struct stat named {};
  return ::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &named) == 0 && ours.st_ino == named.st_ino &&
         ours.st_dev == named.st_dev;
}

}  // namespace

StudyLock::StudyLock(const std::filesystem::path& study) : path_(study.string() + ".lock") {
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor_ < 0)
      throw StorageError(fmt::format("{}: cannot be opened for writing: {} ({}); check the folder and its permissions",
                                     study.string(), std::strerror(errno), path_.string()));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      const std::string who = holder(descriptor_);
      ::close(descriptor_);
      if (error == EWOULDBLOCK)
        throw StorageError(fmt::format(
            "{}: {} is writing to this study; wait until it ends, or end it, and try again. Reading (status, "
            "verify, backup, analyze) works meanwhile",
            study.string(), who));
      throw StorageError(fmt::format("{}: cannot be locked: {}; a study must be on a local disk that supports locks",
                                     study.string(), std::strerror(error)));
    }
    ::fchmod(descriptor_, 0600);  // whatever the umask took away; the lock holds without it
    if (still_there(descriptor_, path_)) break;
    ::close(descriptor_);
  }
  // For the message of whoever comes second; the lock holds without it.
  const std::string pid = std::to_string(::getpid());
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, pid.data(), pid.size(), 0) < 0) return;
}

StudyLock::~StudyLock() {
  ::unlink(path_.c_str());  // while still locked: nobody can lock the name that goes
  ::close(descriptor_);
}

}  // namespace jnd
