#include "data/files/study_files.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/files/descriptor.h"
#include "protocols/input/file_trouble.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

// The header of the log's index, https://sqlite.org/walformat.html, section 2.1: in this machine's byte order, but for
// the salts, which are as they stand in the log.
constexpr std::size_t kIndexHeader = 48, kPageSizeAt = 14, kFramesAt = 16, kIndexSaltAt = 32, kSalt = 8;
constexpr int kIndexRegion = 32768;
// Of the log itself, https://sqlite.org/fileformat2.html, section 4.1.
constexpr std::size_t kLogHeader = 32, kFrameHeader = 24, kLogSaltAt = 16;

struct LogIndex {
  std::uint32_t frames = 0;  // that the log must hold
  std::size_t page_size = 0;
  std::array<char, kSalt> salt{};
};

template <typename Number>
Number number_at(const char* bytes) {
  Number number = 0;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

// One that SQLite has open; nullptr where there is none.
sqlite3_file* open_file(SQLite::Database& connection, int which) {
  sqlite3_file* file = nullptr;
  if (sqlite3_file_control(connection.getHandle(), "main", which, &file) != SQLITE_OK) return nullptr;
  return file != nullptr && file->pMethods != nullptr ? file : nullptr;
}

// As this connection has it mapped; no frames where there is none, or while another program changes it.
LogIndex index_of(SQLite::Database& connection) {
  sqlite3_file* file = open_file(connection, SQLITE_FCNTL_FILE_POINTER);
  // Without an open log SQLite has no index, and would never let go of one that we mapped.
  if (file == nullptr || file->pMethods->iVersion < 2 || !open_file(connection, SQLITE_FCNTL_JOURNAL_POINTER))
    return {};
  void volatile* mapped = nullptr;
  if (file->pMethods->xShmMap(file, 0, kIndexRegion, 0, &mapped) != SQLITE_OK || mapped == nullptr) return {};
  std::array<char, 2 * kIndexHeader> header{};
  for (std::size_t i = 0; i < header.size(); ++i) header[i] = static_cast<const volatile char*>(mapped)[i];
  if (std::memcmp(header.data(), header.data() + kIndexHeader, kIndexHeader) != 0) return {};
  LogIndex index;
  index.frames = number_at<std::uint32_t>(header.data() + kFramesAt);
  const auto page_size = number_at<std::uint16_t>(header.data() + kPageSizeAt);
  index.page_size = page_size == 1 ? 65536 : page_size;
  std::memcpy(index.salt.data(), header.data() + kIndexSaltAt, kSalt);
  return index;
}

enum class Named { same, other, none, unseen };

// Whether `path` names the file of a descriptor; errno says why that is unseen.
Named named(const fs::path& path, int descriptor) {
  struct stat open {
  }, found{};
  if (::stat(path.c_str(), &found) != 0) return errno == ENOENT || errno == ENOTDIR ? Named::none : Named::unseen;
  if (::fstat(descriptor, &open) != 0) return Named::other;
  return same_file(open, found) ? Named::same : Named::other;
}

}  // namespace

StudyFiles::StudyFiles(fs::path place, int study)
    : place_(std::move(place)), log_place_(place_.string() + "-wal"), study_(study) {
  find_log();
}

void StudyFiles::find_log() {
  if (log_ < 0) log_ = ::open(log_place_.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
}

StudyFiles::~StudyFiles() {
  if (log_ >= 0) ::close(log_);  // SQLite holds no locks of it
}

StudyFiles::State StudyFiles::look(SQLite::Database& connection) {
  const auto unseen = [this] {
    error_ = errno;
    return State::unseen;
  };
  const Named study = named(place_, study_);
  if (study == Named::unseen) return unseen();
  if (study != Named::same) {
    if (!whereabouts().empty()) return study == Named::none ? State::moved : State::replaced;
    return study == Named::none ? State::removed : State::replaced;
  }
  find_log();
  // After an error of the disk SQLite makes the log with the next event only: nothing can be missing before it.
  if (log_ < 0) return index_of(connection).frames == 0 ? State::in_place : State::log_removed;
  const Named log = named(log_place_, log_);
  if (log == Named::unseen) return unseen();
  if (log != Named::same) return log == Named::none ? State::log_removed : State::log_replaced;
  return log_is_whole(connection) ? State::in_place : State::log_cut;
}

bool StudyFiles::log_is_whole(SQLite::Database& connection) const {
  const LogIndex index = index_of(connection);
  if (index.frames == 0) return true;
  struct stat status {};
  std::array<char, kLogHeader> header{};
  return ::fstat(log_, &status) == 0 &&
         static_cast<std::uint64_t>(status.st_size) >=
             kLogHeader + std::uint64_t{index.frames} * (kFrameHeader + index.page_size) &&
         ::pread(log_, header.data(), header.size(), 0) == static_cast<ssize_t>(header.size()) &&
         std::memcmp(header.data() + kLogSaltAt, index.salt.data(), kSalt) == 0;
}

fs::path StudyFiles::whereabouts() const {
  struct stat status {};
  if (::fstat(study_, &status) != 0 || status.st_nlink == 0) return {};
  std::error_code error;
  const fs::path now = fs::read_symlink(fmt::format("/proc/self/fd/{}", study_), error);
  return !error && named(now, study_) == Named::same ? now : fs::path();
}

std::string StudyFiles::in_words(State state) const {
  std::string study = place_.string();
  const std::string log = log_place_.string();
  switch (state) {
    case State::in_place:
      return fmt::format("{} is in its place", study);
    case State::removed:
      return fmt::format("{} was removed", study);
    case State::moved:
      return fmt::format("{} was renamed or moved to {}", study, whereabouts().string());
    case State::replaced:
      return fmt::format("another file was put in the place of {}", study);
    case State::log_removed:
      return fmt::format("{}, the log that belongs to the study, was removed", log);
    case State::log_replaced:
      return fmt::format("another file was put in the place of {}, the log that belongs to the study", log);
    case State::log_cut:
      return fmt::format("{}, the log that belongs to the study, was cut off or written over", log);
    case State::unseen:
      return fmt::format("{} or its log cannot be looked at ({})", study,
                         file_trouble(place_, error_, FileUse::read).why);
  }
  return study;
}

bool StudyFiles::leave(std::unique_ptr<SQLite::Database>& connection, State state) const {
  sqlite3* handle = connection->getHandle();
  if (state == State::log_cut) {
    // What the log holds now must not come into the file.
    sqlite3_db_config(handle, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    connection.reset();
    return false;
  }
  int keep_log = 1;  // SQLite would remove what has its name, be it this log or another file
  sqlite3_file_control(handle, "main", SQLITE_FCNTL_PERSIST_WAL, &keep_log);
  const bool whole =
      sqlite3_wal_checkpoint_v2(handle, "main", SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr) == SQLITE_OK;
  connection.reset();
  struct stat status {};
  if (log_ < 0 || ::fstat(log_, &status) != 0 || status.st_size != 0 || named(log_place_, log_) != Named::same)
    return whole;
  ::unlink(log_place_.c_str());
  ::unlink((place_.string() + "-shm").c_str());
  return whole;
}

}  // namespace jnd
