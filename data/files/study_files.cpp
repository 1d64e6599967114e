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
constexpr std::size_t kIndexHeader = 48, kPageSizeAt = 14, kFramesAt = 16, kPagesAt = 20, kIndexSaltAt = 32;
constexpr int kIndexRegion = 32768;
// Two changes of a file within a tick of the kernel's clock may have one time.
constexpr std::int64_t kTick_ns = 20'000'000;

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

// As this connection has it mapped; none where there is none, or while another program changes it.
std::optional<LogIndex> index_of(SQLite::Database& connection) {
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
  index.pages = number_at<std::uint32_t>(header.data() + kPagesAt);
  std::memcpy(index.salt.data(), header.data() + kIndexSaltAt, index.salt.size());
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
  const std::optional<LogIndex> index = index_of(connection);
  // After an error of the disk SQLite makes the log with the next event only: nothing can be missing before it.
  if (log_ < 0 && index && index->frames > 0) return State::log_removed;
  const bool log_whole = log_is_whole(index);
  if (image_ && index && log_whole && !image_->add(log_, *index)) return State::log_cut;
  if (!file_is_whole(index.has_value())) return State::file_cut;
  if (log_ < 0) return State::in_place;
  const Named log = named(log_place_, log_);
  if (log == Named::unseen) return unseen();
  if (log != Named::same) return log == Named::none ? State::log_removed : State::log_replaced;
  return log_whole ? State::in_place : State::log_cut;
}

std::uint32_t StudyFiles::log_length(SQLite::Database& connection) {
  const std::optional<LogIndex> index = index_of(connection);
  return index ? index->frames : 0;
}

bool StudyFiles::file_is_whole(bool index_known) {
  struct stat now {
  }, after{};
  timespec clock{};
  ::clock_gettime(CLOCK_REALTIME_COARSE, &clock);
  if (::fstat(study_, &now) != 0) return false;
  const auto same_time = [](const timespec& one, const timespec& other) {
    return one.tv_sec == other.tv_sec && one.tv_nsec == other.tv_nsec;
  };
  const auto unchanged = [&](const struct stat& one, const struct stat& other) {
    return one.st_size == other.st_size && same_time(one.st_mtim, other.st_mtim) &&
           same_time(one.st_ctim, other.st_ctim);
  };
  if (settled_ && unchanged(now, seen_)) return true;
  if (!index_known) return true;  // another program is at it: seen at the next look
  if (now.st_size < seen_.st_size || (image_ && !image_->explains(log_))) return false;
  seen_ = now;
  settled_ = ::fstat(study_, &after) == 0 && unchanged(now, after) &&
             (clock.tv_sec - now.st_ctim.tv_sec) * 1'000'000'000 + clock.tv_nsec - now.st_ctim.tv_nsec > kTick_ns;
  return true;
}

bool StudyFiles::log_is_whole(const std::optional<LogIndex>& index) const {
  if (!index || index->frames == 0) return true;
  struct stat status {};
  std::array<char, kLogHeader> header{};
  return ::fstat(log_, &status) == 0 &&
         static_cast<std::uint64_t>(status.st_size) >=
             kLogHeader + std::uint64_t{index->frames} * (kFrameHeader + index->page_size) &&
         ::pread(log_, header.data(), header.size(), 0) == static_cast<ssize_t>(header.size()) &&
         std::memcmp(header.data() + kLogSaltAt, index->salt.data(), index->salt.size()) == 0;
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
    case State::file_cut:
      return fmt::format("{} was cut off or written over", study);
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
  if (state == State::log_cut || state == State::file_cut) {
    // Nothing of a damaged log must come into the file, and nothing at all into a damaged one.
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
