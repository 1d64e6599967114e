// What SQLite keeps beside a study goes into no other file, and goes on to be taken into its own.
#include "data/study/continuation.h"

#include "data/copies/backup.h"
#include "data/copies/merge.h"
#include "data/files/left_beside.h"
#include "data/study/database.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPage = 4096;
constexpr auto kAccesses = {Study::Access::read_only, Study::Access::read_write};

// A study as a killed program leaves it: the file as of its last checkpoint, and its log.
struct Killed {
  std::string file, log, whole;  // whole: the file after a checkpoint
  StudyContent content;
};

Killed killed_study(const fs::path& path, std::uint64_t seed = kSeed) {
  Killed killed;
  {
    const auto study = Study::create(path, tutorial().name, tutorial().bytes, seed, {1'700'000'000'000'000'001, 5});
    fill_study(*study);
    killed.file = bytes_of(path);
    killed.log = bytes_of(path.string() + "-wal");
    killed.content = content_of(path);
  }
  killed.whole = bytes_of(path);
  fs::remove(path);
  REQUIRE(killed.log.size() > 100'000);
  return killed;
}

std::size_t events_in(const StudyContent& content) {
  std::size_t count = 0;
  for (const auto& [session, events] : content.events) count += events.size();
  return count;
}

// Neither reading nor writing takes in what lies beside `path`, and neither changes anything.
void check_refused(const fs::path& path, const char* suffix) {
  const fs::path beside = path.string() + suffix;
  const std::string file = bytes_of(path), left = bytes_of(beside);
  for (const Study::Access access : kAccesses)
    CHECK_THROWS_WITH(Study::open(path, access), Catch::Contains(beside.string() + ", which lies beside it, does not "
                                                                                   "continue this study"));
  CHECK(bytes_of(path) == file);
  CHECK(bytes_of(beside) == left);
}

TEST_CASE("a name that something of SQLite's lies beside is given to no file", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = filled_study(folder), other = folder / "other.jnd", to = folder / "new.jnd";
  Study::create(other, tutorial().name, tutorial().bytes, kSeed, kLater)->close();
  for (const std::string suffix : {"-wal", "-journal", "-shm"}) {
    const fs::path beside = to.string() + suffix;
    write_bytes(beside, "answers");
    const auto refused = Catch::Contains(beside.string() + " lies beside this name");
    CHECK(left_beside(to) == beside);
    CHECK_THROWS_WITH(new_study(to), refused);
    CHECK_THROWS_WITH(back_up(*Study::open(path, Study::Access::read_only), to, false), refused);
    CHECK_THROWS_WITH(recover(path, to, std::nullopt, kLater), refused);
    CHECK_THROWS_WITH(merge({path, other}, to, kLater), refused);
    CHECK(bytes_of(beside) == "answers");
    CHECK_FALSE(fs::exists(to));
    CHECK_FALSE(fs::exists(to.string() + ".lock"));
    fs::remove(beside);
  }
  CHECK_FALSE(left_beside(to));
  CHECK(back_up(*Study::open(path, Study::Access::read_only), to, false).written);
}

TEST_CASE("a log goes into the study that it continues, and into no other", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", log = path.string() + "-wal";
  const Killed killed = killed_study(path);
  std::vector<std::string> others;
  for (const std::uint64_t seed : {std::uint64_t{7}, kSeed}) {
    const auto study = Study::create(path, tutorial().name, tutorial().bytes, seed, kLater);
    others.push_back(bytes_of(path));
    run_whole_session(*study, tutorial(), 4);
    study->close();
    others.push_back(bytes_of(path));
    fs::remove(path);
  }
  {  // the same study, with an event more than the log has
    write_bytes(path, killed.whole);
    Study::open(path, Study::Access::read_write)->open_session(new_session(5));
    others.push_back(bytes_of(path));
    fs::remove(path);
  }
  for (const std::string& other : others) {
    write_bytes(path, other);
    write_bytes(log, killed.log);
    check_refused(path, "-wal");
  }
  for (const Study::Access access : kAccesses) {
    // Also a log that a checkpoint has copied into the file, in whole or up to some page.
    for (const std::string& file : {killed.file, killed.whole, killed.whole.substr(0, killed.file.size() + 5 * kPage),
                                    killed.whole.substr(0, 7 * kPage) + killed.file.substr(7 * kPage)}) {
      CAPTURE(file.size());
      write_bytes(path, file);
      write_bytes(log, killed.log);
      Study::open(path, access)->close();
      CHECK(events_in(content_of(path)) == events_in(killed.content));
      CHECK(problems_of(path) == "");
    }
  }
}

TEST_CASE("a damaged study is shown with its log, and neither is changed", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", log = path.string() + "-wal";
  const Killed killed = killed_study(path);
  write_bytes(path, killed.file);
  // The page of an index that no event of the log touches.
  const std::int64_t root = SQLite::Database(path.string())
                                .execAndGet("SELECT rootpage FROM sqlite_schema WHERE name = 'event_note'")
                                .getInt64();
  std::string file = killed.file;
  file.replace(static_cast<std::size_t>(root - 1) * kPage, kPage, std::string(kPage, '\xA5'));
  write_bytes(path, file);
  write_bytes(log, killed.log);
  CHECK_THROWS_WITH(Study::open(path, Study::Access::read_write), Catch::Contains("is damaged"));
  CHECK_THAT(problems_of(path), Catch::Contains("is damaged"));
  CHECK(bytes_of(path) == file);
  CHECK(bytes_of(log) == killed.log);
}

TEST_CASE("a journal is played back into the study that it belongs to, and into no other", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = filled_study(folder), journal = path.string() + "-journal", other = folder / "other.jnd";
  const std::string whole = bytes_of(path);
  const StudyContent content = content_of(path);
  Study::create(other, tutorial().name, tutorial().bytes, kSeed, kLater)->close();
  std::string file, log;
  {  // another program, killed within a transaction
    SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
    database.exec(
        "PRAGMA synchronous = OFF; PRAGMA cache_size = 2; BEGIN; DROP TRIGGER event_no_update; UPDATE event SET version = 'none'");
    file = bytes_of(path);
    log = bytes_of(journal);
  }
  REQUIRE(file != whole);
  for (const Study::Access access : kAccesses) {
    write_bytes(path, file);
    write_bytes(journal, log);
    Study::open(path, access)->close();
    CHECK_FALSE(fs::exists(journal));
    CHECK(events_in(content_of(path)) == events_in(content));
    CHECK(problems_of(path) == "");
  }
  write_bytes(other.string() + "-journal", log);
  check_refused(other, "-journal");
  write_bytes(other.string() + "-journal", std::string(512, '\0'));  // one that is over
  CHECK_NOTHROW(Study::open(other, Study::Access::read_only));
}

TEST_CASE("a recovery leaves out the log of another study", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", other = folder / "other.jnd";
  const Killed killed = killed_study(path);
  {
    const auto study = Study::create(other, tutorial().name, tutorial().bytes, kSeed, kLater);
    run_whole_session(*study, tutorial(), 4);
  }
  write_bytes(other.string() + "-wal", killed.log);
  const RecoveryReport report = recover(other, folder / "new.jnd", std::nullopt, kLater);
  CHECK_THAT(report.doubts.back(), Catch::Contains("belongs to another study"));
  CHECK_FALSE(report.whole());
  CHECK(report.sessions.size() == 1);
  CHECK(report.verified.problems == std::vector<Problem>{});
}

}  // namespace
}  // namespace jnd
