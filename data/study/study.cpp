#include "data/study/study.h"

#include <charconv>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "data/files/draft.h"
#include "data/log/event_body.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "protocols/input/sha256.h"

namespace jnd {

Study::Study(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Study::~Study() {
  try {
    close();
  } catch (const std::exception& error) {
    // Everything acknowledged is committed; the next opening replays the write-ahead log. But it may be in a new file
    // now, or in one that was taken away, and nobody else tells of that.
    std::fputs((std::string("jnd: ") + error.what() + "\n").c_str(), stderr);
  }
}

std::unique_ptr<Study> Study::create(const std::filesystem::path& path, const std::string& protocol_name,
                                     const std::string& protocol_bytes, std::uint64_t seed, Stamp stamp) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->info = {seed, sha256_hex(protocol_bytes), protocol_name, protocol_bytes};
  impl->lock = std::make_unique<StudyLock>(path);
  if (std::filesystem::exists(path))
    throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
  // Made under another name and renamed when whole: killed at any instant, there is a study or there is none.
  {
    Draft draft(path, Draft::What::file);
    impl->connection = create_database(draft.path());
    impl->fill_new(stamp);
    if (!draft.publish()) throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
  }
  impl->lock->hold_file();
  impl->connection = open_database(path, true);
  with_storage_errors(path, [&] { impl->begin_writing(); });
  return std::unique_ptr<Study>(new Study(std::move(impl)));
}

std::unique_ptr<Study> Study::open(const std::filesystem::path& path, Access access) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  const bool writable = access == Access::read_write;
  // A missing or foreign file is named as such before a lock file is made beside it.
  if (!writable || !std::filesystem::exists(path)) {
    impl->connection = open_database(path, false);
  } else {
    impl->lock = std::make_unique<StudyLock>(path);
    impl->lock->refuse_other_names();
    impl->connection = open_database(path, true);
  }
  with_storage_errors(path, [&] {
    impl->read_info();
    if (!writable) return;
    impl->read_ends();
    impl->begin_writing();
  });
  return std::unique_ptr<Study>(new Study(std::move(impl)));
}

const StudyInfo& Study::info() const noexcept {
  return impl_->info;
}

std::filesystem::path Study::path() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->path;
}

std::vector<Event> Study::events(const std::string& session) const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->events(session);
}

std::vector<TelemetryBlob> Study::telemetry(const std::string& session, std::int64_t seq) const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->telemetry(session, seq);
}

std::vector<SessionInfo> Study::sessions() const {
  const std::scoped_lock lock(impl_->mutex);
  return impl_->sessions();
}

std::string Study::head() const {
  const std::scoped_lock lock(impl_->mutex);
  return with_storage_errors(impl_->path, [&] {
    SQLite::Statement last(impl_->database(), "SELECT hash FROM event WHERE session = ? ORDER BY seq DESC LIMIT 1");
    last.bind(1, kStudyChain);
    return last.executeStep() ? last.getColumn(0).getString() : std::string();
  });
}

void Study::close() {
  const std::scoped_lock lock(impl_->mutex);
  impl_->close();
}

SQLite::Database& Study::Impl::database() const {
  if (!connection) throw StorageError(fmt::format("{}: this study was closed", path.string()));
  return *connection;
}

void Study::Impl::require_writable() const {
  database();
  if (!lock) throw StorageError(fmt::format("{}: was opened for reading only", path.string()));
}

// The rows of a study without sessions; closes the connection.
void Study::Impl::fill_new(Stamp stamp) {
  with_storage_errors(path, [&] {
    SQLite::Transaction transaction(database());
    SQLite::Statement protocol(database(), "INSERT INTO protocol (sha256, name, bytes) VALUES (?, ?, ?)");
    protocol.bind(1, info.protocol_sha256);
    protocol.bind(2, info.protocol_name);
    protocol.bind(3, info.protocol_bytes.data(), static_cast<int>(info.protocol_bytes.size()));
    insert_row(protocol, path);
    SQLite::Statement study(database(), "INSERT INTO study (id, seed, protocol) VALUES (1, ?, ?)");
    study.bind(1, std::to_string(info.seed));
    study.bind(2, info.protocol_sha256);
    insert_row(study, path);
    append(kStudyChain, event_kind::kStudyCreated,
           body_text({{"seed", std::to_string(info.seed)},
                      {"protocol_sha256", info.protocol_sha256},
                      {"protocol_name", info.protocol_name}}),
           stamp);
    transaction.commit();
  });
  insert.reset();
  connection.reset();
}

void Study::Impl::read_info() {
  SQLite::Statement query(
      database(),
      "SELECT study.seed, protocol.sha256, protocol.name, protocol.bytes FROM study JOIN protocol ON "
      "protocol.sha256 = study.protocol");
  if (!query.executeStep())
    throw StorageError(fmt::format("{}: holds no protocol: it is damaged; it was not changed", path.string()));
  const std::string seed = query.getColumn(0).getString();
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), info.seed);
  if (error != std::errc() || end != seed.data() + seed.size())
    throw StorageError(fmt::format("{}: its seed \"{}\" is not a number of 64 bits: it is damaged; it was not changed",
                                   path.string(), seed));
  info.protocol_sha256 = query.getColumn(1).getString();
  info.protocol_name = query.getColumn(2).getString();
  info.protocol_bytes = query.getColumn(3).getString();
}

void Study::Impl::close() {
  if (!connection) return;
  std::string trouble = std::exchange(untold, {});
  if (lock && files) {
    const StudyFiles::State state = files->look(*connection);
    if (state != StudyFiles::State::in_place && state != StudyFiles::State::unseen)
      trouble = rescue(state, "What was saved could not be put into another file");
  }
  if (!trouble.empty())
    trouble += back ? " Go on with the study; the other file is a copy" : " Use that file from now on";
  forget_statements();
  files.reset();  // from here on SQLite itself takes the log away, also where it then fails
  try {
    if (lock) with_storage_errors(path, [&] { end_writing(*connection); });
  } catch (const StorageError& error) {
    if (trouble.empty()) throw;
    throw StorageError(fmt::format("{}. {}", trouble, error.what()));
  }
  connection.reset();
  former.reset();
  lock.reset();
  if (!trouble.empty()) throw StorageError(trouble);
}

}  // namespace jnd
