#include "data/study/study_lock.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/files/descriptor.h"
#include "data/files/draft.h"
#include "data/log/storage_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr off_t kLockedByte = off_t{1} << 62;
constexpr std::size_t kMostDigits = 20;  // of a process's number

std::string process_text(const std::string& pid) {
  std::string name;
  if (std::ifstream file("/proc/" + pid + "/comm"); file) std::getline(file, name);
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_'; });
  return name.empty() ? fmt::format("process {}", pid) : fmt::format("process {} ({})", pid, name);
}

bool is_number(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// What a lock file holds: a process's number, or nothing yet.
std::string content_of(int descriptor) {
  std::array<char, kMostDigits + 1> text{};
  const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
  return {text.data(), length > 0 ? static_cast<std::size_t>(length) : 0};
}

std::string holder(int descriptor) {
  const std::string pid = content_of(descriptor);
  return pid.empty() || !is_number(pid) ? "another process" : process_text(pid);
}

StorageError lock_taken(const fs::path& study, const std::string& who) {
  return StorageError(
      fmt::format("{}: {} is writing to this study; wait until it ends, or end it, and try again. Reading (status, "
                  "verify, backup, analyze) works meanwhile",
                  study.string(), who));
}

StorageError cannot_lock(const fs::path& study, int error) {
  return StorageError(fmt::format("{}: cannot be locked: {}; a study must be on a local disk that supports locks",
                                  study.string(), std::strerror(error)));
}

}  // namespace

fs::path real_place(const fs::path& path) {
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path) : resolved;
}

std::string open_elsewhere(int descriptor) {
  struct stat wanted {};
  if (::fstat(descriptor, &wanted) != 0) return {};
  std::vector<std::string> found;
  const std::string own = std::to_string(::getpid());
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end; process.increment(error)) {
    const std::string pid = process->path().filename().string();
    if (!is_number(pid) || pid == own) continue;
    std::error_code hidden;  // another user's
    for (fs::directory_iterator open(process->path() / "fd", hidden), last; !hidden && open != last;
         open.increment(hidden)) {
      struct stat status {};
      if (::stat(open->path().c_str(), &status) != 0 || !same_file(status, wanted)) continue;
      found.push_back(process_text(pid));
      break;
    }
  }
  return fmt::format("{}", fmt::join(found, ", "));
}

bool in_use(const std::filesystem::path& study, bool elsewhere) {
  const int descriptor = ::open((real_place(study).string() + ".lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool free = ::flock(descriptor, LOCK_SH | LOCK_NB) == 0 ||
                    (elsewhere && content_of(descriptor) == std::to_string(::getpid()));
  ::close(descriptor);
  return !free;
}

void refuse_in_use(const std::filesystem::path& study) {
  if (in_use(study))
    throw StorageError(fmt::format(
        "{}: another process is writing to this study; wait until it ends, or end it, and try again", study.string()));
}

StudyLock::StudyLock(const fs::path& study)
    : study_(study), place_(real_place(study)), path_(place_.string() + ".lock") {
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor_ < 0) {
      const int error = errno;
      std::error_code ignored;
      throw cannot_write(fs::exists(fs::symlink_status(path_, ignored)) ? path_ : study, error);
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      const std::string who = holder(descriptor_);
      ::close(descriptor_);
      throw error == EWOULDBLOCK ? lock_taken(study, who) : cannot_lock(study, error);
    }
    if (!is_number(content_of(descriptor_)) || content_of(descriptor_).size() > kMostDigits) {
      ::close(descriptor_);
      throw StorageError(fmt::format("{}: is no lock file of jnd, but would be taken for one; rename it and try again",
                                     path_.string()));
    }
    ::fchmod(descriptor_, 0600);  // whatever the umask took away; the lock holds without it
    // Else another process removed the file between our open and our lock: the lock then guards nothing.
    if (is_at(path_, descriptor_)) break;
    ::close(descriptor_);
  }
  // For the message to the second writer; the lock holds without it.
  const std::string pid = std::to_string(::getpid());
  const bool written = ::ftruncate(descriptor_, 0) == 0 &&
                       ::pwrite(descriptor_, pid.data(), pid.size(), 0) == static_cast<ssize_t>(pid.size());
  static_cast<void>(written);
  try {
    hold_file();
  } catch (...) {
    ::unlink(path_.c_str());
    ::close(descriptor_);
    throw;
  }
}

StudyLock::~StudyLock() {
  // While still locked: no other process can lock the name that goes. One that was removed meanwhile may be another
  // process's now.
  if (is_at(path_, descriptor_)) ::unlink(path_.c_str());
  ::close(descriptor_);
  if (file_ >= 0) ::close(file_);
}

void StudyLock::hold_file() {
  bool may_write = true;
  file_ = ::open(place_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0 && (errno == EACCES || errno == EROFS || errno == EPERM)) {
    may_write = false;
    file_ = ::open(place_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW);
  }
  if (file_ < 0) return;  // none yet, or one that may not even be read: who opens it says so
  struct stat status {};
  struct flock lock {};
  lock.l_type = may_write ? F_WRLCK : F_RDLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = kLockedByte;
  lock.l_len = 1;
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(file_);
    file_ = -1;
    return;
  }
  if (::fcntl(file_, F_OFD_SETLK, &lock) == 0) return;
  const int error = errno;
  const std::string elsewhere = open_elsewhere(file_);
  ::close(file_);
  file_ = -1;
  if (error != EAGAIN && error != EACCES) throw cannot_lock(study_, error);
  // Readers are among those that have it open: which one writes is not known.
  throw lock_taken(
      study_, elsewhere.empty()
                  ? "another program, perhaps under another name of the study,"
                  : fmt::format("another program, perhaps under another name of the study (open in: {}),", elsewhere));
}

void StudyLock::refuse_other_names() const {
  clear_drafts(place_);
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0 || status.st_nlink <= 1) return;
  throw StorageError(fmt::format(
      "{}: has {} names (hard links): what is written under one of them damages what the others see. Make a "
      "copy of its own with jnd backup, and go on with that, or remove the other names; it was not changed",
      study_.string(), static_cast<unsigned long>(status.st_nlink)));
}

}  // namespace jnd
