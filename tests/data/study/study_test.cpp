// A study file: making, opening, refusing, closing.
#include "data/study/study.h"

#include <limits>

#include <sys/stat.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/event_body.h"
#include "data/log/utc_time.h"
#include "data/study/database.h"
#include "data/study/schema.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

using Access = Study::Access;

TEST_CASE("a study keeps its seed, its protocol to the byte, and its sessions", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  std::string bytes = tutorial().bytes + std::string("\0\r\n\xC3\xA9", 5);
  Study::create(path, "tutorial", bytes, std::numeric_limits<std::uint64_t>::max(), {1, 1})->close();
  const auto study = Study::open(path, Access::read_only);
  CHECK(study->info().seed == std::numeric_limits<std::uint64_t>::max());
  CHECK(study->info().protocol_bytes == bytes);
  CHECK(study->info().protocol_name == "tutorial");
  CHECK(study->info().protocol_sha256.size() == 64);
  CHECK(study->sessions().empty());
}

TEST_CASE("a closed study is one private file", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  run_whole_session(*study, tutorial(), 1, SessionKind::real);
  CHECK(std::filesystem::exists(path.string() + "-wal"));
  study->close();
  study->close();
  struct stat status {};
  REQUIRE(::stat(path.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0600);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  CHECK(files == 1);
  CHECK_THROWS_WITH(study->sessions(), Catch::Contains("closed"));
}

TEST_CASE("sessions are listed by kind and number, with what happened in them", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  run_whole_session(*study, tutorial(), 2);
  run_whole_session(*study, tutorial(), 1);
  const auto log = study->open_session(new_session(1, SessionKind::real));
  const Plan plan = make_plan(tutorial(), 1, kSeed);
  log->append(event_kind::kTrialVoided, voided_body(tutorial(), plan.trials[0], 1, "no_answer"), {1, 1});
  answer_all(*log, tutorial(), 1, 10);  // eight of practice, two of the main part
  const std::vector<SessionInfo> sessions = study->sessions();
  REQUIRE(sessions.size() == 3);
  CHECK(sessions[0].kind == SessionKind::real);
  CHECK(sessions[0].state == "open");
  CHECK(sessions[0].trials_done == 2);
  CHECK(sessions[0].trials_voided == 1);
  CHECK(sessions[0].trials_total == 16);
  CHECK(sessions[0].ended.empty());
  CHECK(sessions[0].responder == "keyboard");
  CHECK(sessions[1].participant == "P01");
  CHECK(sessions[2].participant == "P02");
  CHECK(sessions[2].state == "closed");
  CHECK(sessions[2].trials_done == 16);
  CHECK(sessions[2].started == "2023-11-14T22:13:21.000000002Z");
  CHECK(sessions[2].ended == "2023-11-14T22:28:20.000000000Z");
  CHECK(sessions[2].head == study->events("P02-simulated").back().hash);
}

TEST_CASE("a second writer is refused with the process that holds the study; readers are welcome", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto writer = new_study(path);
  const auto log = writer->open_session(new_session(1));
  CHECK_THROWS_WITH(Study::open(path, Access::read_write), Catch::Contains(std::to_string(::getpid())));
  {
    const auto reader = Study::open(path, Access::read_only);
    answer_all(*log, tutorial(), 1, 3);
    CHECK(reader->events("P01-simulated").size() == 4);
    CHECK(verify(*reader).problems.empty());
    CHECK_THROWS_WITH(reader->open_session(new_session(2)), Catch::Contains("reading only"));
  }
  answer_all(*writer->resume_session("P01-simulated"), tutorial(), 2, 0);
  writer->close();
  CHECK_NOTHROW(Study::open(path, Access::read_write));
}

TEST_CASE("a statement that only reads ends when that is asked for, a writer's does not", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  new_study(path)->close();
  constexpr const char* kLong =
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 300000) SELECT count(*) FROM n";
  const auto count = [&](SQLite::Database& database) {
    return with_storage_errors(path, [&] { return database.execAndGet(kLong).getInt(); });
  };
  const auto reader = open_database(path, false), writer = open_database(path, true);
  CHECK(count(*reader) == 300'000);
  {
    const StopAsked asked;
    CHECK_THROWS_AS(count(*reader), Stopped);
    CHECK(count(*writer) == 300'000);
  }
  CHECK(count(*reader) == 300'000);
}

TEST_CASE("a row that another program put in our place is told as that", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  const auto study = new_study(path);
  const auto log = study->open_session(new_session(1));
  SQLite::Database(path.string(), SQLite::OPEN_READWRITE)
      .exec(
          "INSERT INTO event (session, seq, kind, utc, monotonic_ns, version, body, hash) "
          "SELECT session, seq + 1, 'note', utc, monotonic_ns, version, body, hash FROM event "
          "WHERE session = 'P01-simulated'");
  CHECK_THROWS_WITH(log->append(event_kind::kNote, {{"text", "hello"}}, Stamp{1'700'001'000'000'000'000, 7}),
                    Catch::Contains("as if another program had written to it meanwhile"));
}

TEST_CASE("a reader that stays open does not hinder the writer's close, nor lose anything", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  auto writer = new_study(path);
  auto reader = Study::open(path, Access::read_only);
  run_whole_session(*writer, tutorial(), 1);
  CHECK(reader->sessions().size() == 1);
  writer->close();
  CHECK(reader->sessions().size() == 1);
  reader.reset();
  CHECK_FALSE(std::filesystem::exists(path.string() + "-wal"));
  CHECK(Study::open(path, Access::read_only)->sessions().size() == 1);
}

TEST_CASE("names that cannot be folders and numbers that contradict each other are refused", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  study->open_session(new_session(1));
  CHECK_THROWS_WITH(study->open_session(new_session(1)), Catch::Contains("exists already"));
  NewSession session = new_session(2);
  for (const char* name : {"", "../P02", "P 02", ".P02", "P/02"}) {
    session.participant = name;
    CHECK_THROWS_AS(study->open_session(session), StorageError);
  }
  session = new_session(2);
  session.participant_number = 1;  // P01's
  CHECK_THROWS_WITH(study->open_session(session), Catch::Contains("number 1"));
  CHECK_NOTHROW(study->open_session(new_session(1, SessionKind::pilot)));
  session = new_session(3);
  session.id = "study";  // the chain of the study itself
  CHECK_THROWS_AS(study->open_session(session), StorageError);
  CHECK_THROWS_WITH(study->resume_session("P99"), Catch::Contains("no session P99"));
  CHECK_THROWS_AS(study->resume_session("study"), StorageError);
  CHECK_THROWS_AS(study->close_session("study", {1, 1}), StorageError);
  CHECK_THROWS_AS(study->close_session("P99", {1, 1}), StorageError);
}

TEST_CASE("nothing is added to a closed session", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  study->close_session("P01-simulated", {2, 2});
  CHECK_THROWS_WITH(log->append(event_kind::kBreakTaken, {{"after_trial", 1}}, {3, 3}), Catch::Contains("closed"));
  CHECK_THROWS_AS(study->close_session("P01-simulated", {3, 3}), StorageError);
  CHECK_THROWS_AS(study->resume_session("P01-simulated"), StorageError);
  CHECK(log->events().size() == 2);
}

TEST_CASE("a failed append leaves the log as it was and usable", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1));
  answer_all(*log, tutorial(), 1, 2);
  CHECK_THROWS_WITH(answer_all(*log, tutorial(), 1, 1), Catch::Contains("completed already"));
  CHECK(log->events().size() == 3);
  log->append(event_kind::kBreakTaken, {{"after_trial", 2}, {"duration_s", 1.0}}, {9, 9});
  CHECK(verify(*study).problems.empty());
}

TEST_CASE("a full disk is said, loses nothing saved, and the session goes on when there is room", "[data]") {
  const TemporaryFolder folder;
  const auto study = new_study(folder / "study.jnd");
  const auto log = study->open_session(new_session(1, SessionKind::real));
  const std::vector<Trial> trials = make_plan(tutorial(), 1, kSeed).trials;
  SQLite::Database& database = study->impl().database();
  const int pages = database.execAndGet("PRAGMA page_count").getInt();
  database.exec("PRAGMA max_page_count = " + std::to_string(pages + 4));  // SQLite's own SQLITE_FULL
  std::size_t saved = 0;
  const auto append = [&] {
    const Trial& trial = trials.at(saved);
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), trial, usual_answer(trial))),
                stamp_of(trial));
    ++saved;
  };
  CHECK_THROWS_WITH(
      [&] {
        for (;;) append();
      }(),
      Catch::Contains("disk is full"));
  REQUIRE(saved < trials.size());
  CHECK(log->events().size() == 1 + saved);
  CHECK_THROWS_AS(append(), StorageError);
  database.exec("PRAGMA max_page_count = 1000000");
  while (saved < trials.size()) append();
  study->close_session("P01-real", {9, 9});
  CHECK(verify(*study).problems.empty());
}

TEST_CASE("network file systems are known by their numbers", "[data]") {
  CHECK(is_network_file_system(0x6969));                        // NFS
  CHECK(is_network_file_system(0xFE534D42));                    // SMB2
  CHECK(is_network_file_system(static_cast<int>(0xFE534D42)));  // where f_type is a signed 32-bit number
  CHECK(is_network_file_system(0x786F4256));                    // a shared folder of VirtualBox
  CHECK_FALSE(is_network_file_system(0xEF53));                  // ext4
  CHECK_FALSE(is_network_file_system(0x01021994));              // tmpfs
}

TEST_CASE("what is not a study of ours is named and left alone", "[data]") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& words) {
    const auto path = folder / name;
    const std::string before = bytes_of(path);
    for (const Access access : {Access::read_only, Access::read_write})
      CHECK_THROWS_WITH(Study::open(path, access), Catch::Contains(words));
    CHECK(bytes_of(path) == before);
    CHECK_FALSE(std::filesystem::exists(path.string() + ".lock"));
  };
  std::ofstream(folder / "text.jnd") << "participant,condition\nP01,S\n";
  refused("text.jnd", "not a study");
  std::ofstream(folder / "empty.jnd").close();
  refused("empty.jnd", "not a study");
  SQLite::Database((folder / "other.jnd").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE notes (text)");
  refused("other.jnd", "not a jnd study");
  CHECK_THROWS_WITH(Study::open(folder / "none.jnd", Access::read_only), Catch::Contains("no such study"));
  CHECK_THROWS_WITH(Study::open(folder / "none.jnd", Access::read_write), Catch::Contains("no such study"));
  CHECK_THROWS_WITH(Study::open(folder.path(), Access::read_only), Catch::Contains("not a file"));

  new_study(folder / "new.jnd")->close();
  raw_sql(folder / "new.jnd", "PRAGMA user_version = " + std::to_string(kSchemaVersion + 1));
  refused("new.jnd", "newer jnd");
}

TEST_CASE("a damaged study is refused for writing, and not changed", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    for (int number = 1; number <= 3; ++number) run_whole_session(*study, tutorial(), number);
  }
  const auto size = std::filesystem::file_size(path);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(size / 2 / 4096 * 4096));
    file << std::string(4096, '\xA5');
  }
  const std::string before = bytes_of(path);
  CHECK_THROWS_WITH(Study::open(path, Access::read_write),
                    Catch::Contains("damaged") && Catch::Contains("not changed"));
  CHECK(bytes_of(path) == before);
  CHECK_FALSE(verify(*Study::open(path, Access::read_only)).problems.empty());
  std::filesystem::resize_file(path, size / 2);  // a copy that broke off
  CHECK_THROWS_WITH(Study::open(path, Access::read_write), Catch::Contains("damaged"));
}

TEST_CASE("an event that is no JSON any more is told as damage, and verify names it", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    run_whole_session(*study, tutorial(), 1);
  }
  std::string bytes = bytes_of(path);
  bytes.at(bytes.find("{\"index\":1,")) = 'x';
  std::ofstream(path, std::ios::binary) << bytes;
  CHECK_THROWS_WITH(Study::open(path, Access::read_write),
                    Catch::Contains("is damaged (an event in it is not what was written); it was not changed"));
  CHECK(bytes_of(path) == bytes);
  std::string told;
  for (const Problem& problem : verify(*Study::open(path, Access::read_only)).problems) told += problem.text + "\n";
  CHECK_THAT(told, Catch::Contains("Session P01-simulated, event 2") && Catch::Contains("its hash does not match"));
}

TEST_CASE("a study is never made over a file that exists", "[data]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "study.jnd") << "precious";
  CHECK_THROWS_WITH(new_study(folder / "study.jnd"), Catch::Contains("exists already"));
  CHECK(bytes_of(folder / "study.jnd") == "precious");
  CHECK_THROWS_WITH(new_study(folder / "no-folder" / "study.jnd"), Catch::Contains("no-folder"));
}

TEST_CASE("times go to text and back with every nanosecond", "[data]") {
  CHECK(to_iso8601(0) == "1970-01-01T00:00:00.000000000Z");
  CHECK(to_iso8601(1'700'000'000'123'456'789) == "2023-11-14T22:13:20.123456789Z");
  CHECK(to_iso8601(-1) == "1969-12-31T23:59:59.999999999Z");
  for (const std::int64_t time : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{951'782'400'000'000'000},
                                  std::numeric_limits<std::int64_t>::max()})
    CHECK(utc_ns_from(to_iso8601(time)) == time);
  for (const char* text : {"", "2023-11-14", "2023-11-14 22:13:20.123456789Z", "2023-13-14T22:13:20.123456789Z",
                           "2023-02-30T22:13:20.123456789Z"})
    CHECK_THROWS_AS(utc_ns_from(text), StorageError);
}

}  // namespace
}  // namespace jnd
