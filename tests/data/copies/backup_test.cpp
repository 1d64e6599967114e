// A backup is whole, private and verified, or it is not there.
#include "data/copies/backup.h"

#include <sys/stat.h>

#include "data/study/schema.h"
#include "data/verify/verify.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

unsigned mode_of(const std::filesystem::path& path) {
  struct stat status {};
  REQUIRE(::stat(path.c_str(), &status) == 0);
  return static_cast<unsigned>(status.st_mode) & 0777U;
}

BackupReport backup_of(const std::filesystem::path& path, const std::filesystem::path& to, bool replace = false,
                       const std::function<bool()>& stop = {}) {
  return back_up(*Study::open(path, Study::Access::read_only), to, replace, stop);
}

std::size_t files_in(const TemporaryFolder& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++count;
  return count;
}

TEST_CASE("a backup holds every event and head, and is private", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const BackupReport report = backup_of(path, folder / "backup.jnd");
  CHECK(report.written);
  CHECK(report.verified.sessions == 3);
  CHECK(report.verified.problems == std::vector<Problem>{});
  CHECK(report.bytes == std::filesystem::file_size(folder / "backup.jnd"));
  CHECK(mode_of(folder / "backup.jnd") == 0600);
  CHECK(files_in(folder) == 2);
  const StudyContent before = content_of(path), now = content_of(folder / "backup.jnd");
  for (const auto& [session, events] : before.events) CHECK(kept_of(before, now, session) == events.size());
  CHECK(now.telemetry == before.telemetry);
  REQUIRE(report.sessions.size() == 3);
  for (const SessionInfo& session : report.sessions) CHECK(session.head == before.events.at(session.id).back().hash);
  const auto study = Study::open(path, Study::Access::read_only);
  CHECK(report.study_head == study->events(kStudyChain).back().hash);
}

TEST_CASE("a study is backed up while a session writes to it", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto writing = new_study(path);
  fill_study(*writing);
  const auto log = writing->open_session(new_session(4));
  int looked = 0;
  // The session goes on between two pieces of the copy, which does not see it.
  const BackupReport report = backup_of(path, folder / "backup.jnd", false, [&] {
    log->append(event_kind::kBreakTaken, {{"after_trial", ++looked}, {"duration_s", 1.0}}, kLater);
    return false;
  });
  CHECK(looked > 0);
  CHECK(report.written);
  CHECK(report.verified.sessions == 4);
  CHECK(content_of(folder / "backup.jnd").events.at("P04-simulated").size() == 1);
  CHECK(log->events().size() == 1 + static_cast<std::size_t>(looked));
  CHECK_FALSE(std::filesystem::exists(folder / "backup.jnd-wal"));
  // The study's own process may make one too.
  CHECK(back_up(*writing, folder / "second.jnd", false).verified.events ==
        verify(*Study::open(path, Study::Access::read_only)).events);
  // And what was backed up can be gone on with.
  CHECK_NOTHROW(Study::open(folder / "backup.jnd", Study::Access::read_write)->resume_session("P04-simulated"));
}

TEST_CASE("an interrupted backup leaves nothing, and the earlier one as it was", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  CHECK(backup_of(path, folder / "backup.jnd", false, [] { return true; }).interrupted);
  CHECK(files_in(folder) == 1);
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  const std::string earlier = bytes_of(folder / "backup.jnd");
  CHECK_FALSE(backup_of(path, folder / "backup.jnd", true, [] { return true; }).written);
  CHECK(bytes_of(folder / "backup.jnd") == earlier);
  CHECK(files_in(folder) == 2);
  write_bytes(folder / "backup.jnd.jnd-draft-abc123", "half");  // of a program that was killed
  CHECK(backup_of(path, folder / "backup.jnd", true).written);
  CHECK(files_in(folder) == 2);
}

TEST_CASE("a backup never takes another file's place unasked", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  CHECK_THROWS_WITH(backup_of(path, folder / "backup.jnd"), Catch::Contains("exists already"));
  CHECK_THROWS_WITH(backup_of(path, path, true), Catch::Contains("is the study itself"));
  {
    const auto open = Study::open(folder / "backup.jnd", Study::Access::read_write);
    CHECK_THROWS_WITH(backup_of(path, folder / "backup.jnd", true), Catch::Contains("writing to this study"));
  }
  write_bytes(folder / "backup.jnd-wal", "log");
  CHECK_THROWS_WITH(backup_of(path, folder / "backup.jnd", true), Catch::Contains("backup.jnd-wal"));
  CHECK_THROWS_WITH(backup_of(path, folder / "none" / "backup.jnd"),
                    Catch::Contains("there is no such folder: " + (folder / "none").string()));
  CHECK(backup_of(path, folder / "again.jnd").written);
}

TEST_CASE("a backup takes the place of an earlier one only", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const auto is_kept = [&](const std::filesystem::path& to) {
    const std::string before = bytes_of(to);
    CHECK_THROWS_WITH(backup_of(path, to, true), Catch::Contains("is no backup of this study"));
    CHECK(bytes_of(to) == before);
  };
  write_bytes(folder / "thesis.tex", "precious");
  is_kept(folder / "thesis.tex");
  Study::create(folder / "other-seed", "tutorial", tutorial().bytes, 7, kLater)->close();
  is_kept(folder / "other-seed");
  new_study(folder / "other-protocol", chinello())->close();
  is_kept(folder / "other-protocol");
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  CHECK(backup_of(path, folder / "backup.jnd", true).written);
}

TEST_CASE("a study that somebody went on with is no earlier backup", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  Study::open(folder / "backup.jnd", Study::Access::read_write)->open_session(new_session(9));
  const std::string before = bytes_of(folder / "backup.jnd");
  CHECK_THROWS_WITH(backup_of(path, folder / "backup.jnd", true), Catch::Contains("events that this study lacks"));
  CHECK(bytes_of(folder / "backup.jnd") == before);
}

TEST_CASE("a study that cannot be read is named, and not its backup", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const auto study = Study::open(path, Study::Access::read_only);
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  const int page = database.execAndGet("SELECT rootpage FROM sqlite_schema WHERE name = 'study'").getInt();
  std::string bytes = bytes_of(path);
  bytes.replace(static_cast<std::size_t>(page - 1) * 4096, 4096, 4096, '\xFF');
  bytes[27] = static_cast<char>(bytes[27] + 1);  // the counter of changes: what was read before is read again
  write_bytes(path, bytes);
  CHECK_THROWS_WITH(back_up(*study, folder / "backup.jnd", false), Catch::StartsWith(path.string() + ": "));
  CHECK_FALSE(std::filesystem::exists(folder / "backup.jnd"));
}

TEST_CASE("a damaged study does not take the place of a good backup", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  const std::string earlier = bytes_of(folder / "backup.jnd");
  raw_sql(path, "DROP TRIGGER event_no_update; UPDATE event SET monotonic_ns = 1 WHERE seq = 7");
  const BackupReport report = backup_of(path, folder / "backup.jnd", true);
  CHECK_FALSE(report.written);
  CHECK_FALSE(report.verified.problems.empty());
  CHECK(bytes_of(folder / "backup.jnd") == earlier);
}

TEST_CASE("what is put at a backup's place while it is made is kept", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder), to = folder / "backup.jnd";
  REQUIRE(backup_of(path, to).written);
  CHECK_THROWS_WITH(backup_of(path, to, true,
                              [&] {
                                write_bytes(to, "precious");
                                return false;
                              }),
                    Catch::StartsWith(to.string() + ": is no backup of this study"));
  CHECK(bytes_of(to) == "precious");
  CHECK(files_in(folder) == 2);
}

TEST_CASE("a study whose events cannot be read is named, and not the backup that it is compared with", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  REQUIRE(backup_of(path, folder / "backup.jnd").written);
  const auto study = Study::open(path, Study::Access::read_only);
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  const int page = database.execAndGet("SELECT rootpage FROM sqlite_schema WHERE name = 'event'").getInt();
  std::string bytes = bytes_of(path);
  bytes.replace(static_cast<std::size_t>(page - 1) * 4096, 4096, 4096, '\xFF');
  bytes[27] = static_cast<char>(bytes[27] + 1);  // the counter of changes: what was read before is read again
  write_bytes(path, bytes);
  CHECK_THROWS_WITH(back_up(*study, folder / "backup.jnd", true), Catch::StartsWith(path.string() + ": "));
}

}  // namespace
}  // namespace jnd
