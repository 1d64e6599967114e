#include "data/study.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "data/event_body.h"
#include "data/new_file.h"
#include "data/schema.h"
#include "data/study_impl.h"
#include "protocols/sha256.h"

namespace jnd {

Study::Study(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Study::~Study() {
  try {
    close();
  } catch (const std::exception&) {
    // Everything acknowledged is committed; the next opening replays the write-ahead log.
  }
}

namespace {

// Gives a finished file its name, which must be free, and makes that survive a power cut.
void publish(const std::filesystem::path& made, const std::filesystem::path& path) {
  if (const int error = give_name(made, path); error != 0) {
    ::unlink(made.c_str());
    if (error == EEXIST) throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
    throw StorageError(fmt::format("{}: cannot be created: {}", path.string(), std::strerror(error)));
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

std::unique_ptr<Study> Study::create(const std::filesystem::path& path, const std::string& protocol_name,
                                     const std::string& protocol_bytes, std::uint64_t seed, Stamp stamp) {
  auto impl = std::make_unique<Impl>();
  impl->path = path;
  impl->info = {seed, sha256_hex(protocol_bytes), protocol_name, protocol_bytes};
  impl->lock = std::make_unique<StudyLock>(path);
  if (std::filesystem::exists(path))
    throw StorageError(fmt::format("{}: exists already; it was not changed", path.string()));
  // Made under another name and renamed when whole: killed at any instant, there is a study or there is none. What a
  // killed program left under that name is ours to remove, since we hold the study's lock.
  const std::filesystem::path made = path.string() + ".new";
  ::unlink(made.c_str());
  ::unlink((made.string() + "-journal").c_str());
  impl->connection = create_database(made);
  try {
    with_storage_errors(path, [&] {
      SQLite::Database& database = *impl->connection;
      SQLite::Transaction transaction(database);
      SQLite::Statement protocol(database, "INSERT INTO protocol (sha256, name, bytes) VALUES (?, ?, ?)");
      protocol.bind(1, impl->info.protocol_sha256);
      protocol.bind(2, protocol_name);
      protocol.bind(3, protocol_bytes.data(), static_cast<int>(protocol_bytes.size()));
      protocol.exec();
      SQLite::Statement study(database, "INSERT INTO study (id, seed, protocol) VALUES (1, ?, ?)");
      study.bind(1, std::to_string(seed));
      study.bind(2, impl->info.protocol_sha256);
      study.exec();
      impl->append(kStudyChain, event_kind::kStudyCreated,
                   body_text({{"seed", std::to_string(seed)},
                              {"protocol_sha256", impl->info.protocol_sha256},
                              {"protocol_name", protocol_name}}),
                   stamp);
      transaction.commit();
    });
    impl->insert.reset();
    impl->connection.reset();
    publish(made, path);
    impl->connection = open_database(path, true);
    with_storage_errors(path, [&] { begin_writing(*impl->connection); });
  } catch (...) {
    impl->insert.reset();
    impl->connection.reset();
    ::unlink(made.c_str());
    throw;
  }
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
    impl->connection = open_database(path, true);
  }
  with_storage_errors(path, [&] {
    impl->read_info();
    if (!writable) return;
    impl->read_ends();
    begin_writing(*impl->connection);
  });
  return std::unique_ptr<Study>(new Study(std::move(impl)));
}

const StudyInfo& Study::info() const noexcept {
  return impl_->info;
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
  insert.reset();
  insert_telemetry.reset();
  if (lock) with_storage_errors(path, [&] { end_writing(*connection); });
  connection.reset();
  lock.reset();
}

}  // namespace jnd
