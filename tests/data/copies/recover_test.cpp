// Whatever happens to the file: what comes back was there, event for event, and the new study is whole.
#include "data/copies/recover.h"

#include <algorithm>
#include <csignal>
#include <string>

#include <sys/resource.h>
#include <sys/stat.h>

#include "data/copies/damaged_file.h"
#include "data/copies/salvage.h"
#include "data/log/utc_time.h"
#include "data/study/schema.h"
#include "data/study/study_admin.h"
#include "data/verify/verify.h"
#include "protocols/input/read_file.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

struct Recovered {
  std::size_t events = 0, telemetry = 0;
  bool whole = false;
};

// Recovers `bytes` and compares with what was there; nothing where the study cannot be made again, with the reason.
Recovered recover_bytes(const TemporaryFolder& folder, const StudyContent& before, const std::string& bytes,
                        const std::string& log = {}) {
  const auto damaged = folder / "damaged.jnd", to = folder / "new.jnd";
  std::filesystem::remove(to);
  write_bytes(damaged, bytes);
  if (!log.empty()) write_bytes(folder / "damaged.jnd-wal", log);
  Recovered recovered;
  try {
    const RecoveryReport report =
        recover(damaged, to, std::string(JND_SOURCE_DIR) + "/protocols/tutorial.json", kLater);
    CHECK(report.verified.problems == std::vector<Problem>{});
    recovered.whole = report.whole();
  } catch (const StorageError& error) {
    CHECK_THAT(error.what(), Catch::Contains("nothing of a study was found"));
    CHECK_FALSE(std::filesystem::exists(to));
    return recovered;
  }
  CHECK(verify(*Study::open(to, Study::Access::read_only)).problems == std::vector<Problem>{});
  const StudyContent now = content_of(to);
  for (const auto& [session, events] : now.events) recovered.events += kept_of(before, now, session);
  for (const auto& [key, blobs] : now.telemetry) {
    for (const TelemetryBlob& blob : blobs) {
      const std::vector<TelemetryBlob>& original = before.telemetry.at(key);
      CHECK(std::find(original.begin(), original.end(), blob) != original.end());
    }
    recovered.telemetry += blobs.size();
  }
  CHECK(bytes_of(damaged) == bytes);
  return recovered;
}

std::size_t all_events(const StudyContent& content) {
  std::size_t sum = 0;
  for (const auto& [session, events] : content.events) sum += events.size();
  return sum;
}

TEST_CASE("an undamaged study comes back whole, with its exclusions and notes", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  const Recovered recovered = recover_bytes(folder, before, bytes_of(path));
  CHECK(recovered.events == all_events(before));
  CHECK(recovered.telemetry == 6);
  CHECK(recovered.whole);
  const auto study = Study::open(folder / "new.jnd", Study::Access::read_only);
  CHECK(study->info().seed == kSeed);
  CHECK(study->info().protocol_bytes == tutorial().bytes);
  const std::vector<Event> own = study->events(kStudyChain);
  REQUIRE(own.size() == 4);  // created, recovered, two closings
  CHECK(own[1].kind == event_kind::kRecovered);
  const auto body = nlohmann::ordered_json::parse(own[1].body);
  CHECK(body.at("study_events").size() == 3);
  CHECK(body.at("file") == "damaged.jnd");
  CHECK(std::count_if(std::filesystem::directory_iterator(folder.path()), {}, [](const auto&) { return true; }) == 3);
}

TEST_CASE("the report of a recovery counts what each session has, as the new study does", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const RecoveryReport report = recover(path, folder / "new.jnd", std::nullopt, kLater);
  CHECK(report.events_added == report.events_found);
  CHECK(report.pages == static_cast<std::int64_t>(std::filesystem::file_size(path) / 4096));
  const std::vector<SessionInfo> sessions = Study::open(folder / "new.jnd", Study::Access::read_only)->sessions();
  REQUIRE(report.sessions.size() == sessions.size());
  for (const RecoveredChain& chain : report.sessions) {
    const auto info =
        std::find_if(sessions.begin(), sessions.end(), [&](const SessionInfo& one) { return one.id == chain.session; });
    REQUIRE(info != sessions.end());
    CHECK(chain.trials == info->trials_done);
    CHECK(chain.last_found == chain.events);
    CHECK((chain.last_kind == event_kind::kSessionClosed) == chain.closed);
  }
}

TEST_CASE("a recovered study goes on", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  recover_bytes(folder, content_of(path), bytes_of(path));
  const auto study = Study::open(folder / "new.jnd", Study::Access::read_write);
  study->resume_session("P03-simulated")->append(event_kind::kSessionResumed, {{"cause", "recovered"}}, kLater);
  study->close_session("P03-simulated", kLater);
  run_whole_session(*study, tutorial(), 4);
  CHECK(verify(*study).problems == std::vector<Problem>{});
}

TEST_CASE("a truncated study gives what is left of it", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  const std::string bytes = bytes_of(path);
  std::size_t most = 0;
  for (std::size_t part = 0; part <= 16; ++part) {
    const std::size_t size = bytes.size() * part / 16 + (part % 3) * 101;
    CAPTURE(size);
    const Recovered recovered = recover_bytes(folder, before, bytes.substr(0, size));
    CHECK(recovered.events >= most);  // a longer file never gives less
    CHECK(recovered.whole == (size >= bytes.size()));
    most = std::max(most, recovered.events);
  }
  CHECK(most == all_events(before));
}

TEST_CASE("flipped bits never become answers", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  const std::string bytes = bytes_of(path);
  std::vector<std::size_t> places = {0, 16, 17, 18, 20, 28, 40, 100, 103, 105, 108};  // headers of file and first page
  for (std::size_t i = 1; i <= 16; ++i) places.push_back(i * 104'729 % bytes.size());
  for (const std::size_t place : places) {
    CAPTURE(place);
    std::string changed = bytes;
    changed[place] = static_cast<char>(changed[place] ^ (1 << (place % 8)));
    const Recovered recovered = recover_bytes(folder, before, changed);
    CHECK(recovered.events + 26 >= all_events(before));  // one chain at most ends early
    if (place < 110) CHECK(recovered.events == all_events(before));
  }
}

TEST_CASE("lost pages cost the events on them, and those behind", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  const std::string bytes = bytes_of(path);
  const std::size_t page_size = 4096;
  bool lost_some = false;
  for (std::size_t page = 0; page < bytes.size() / page_size; page += 3) {
    CAPTURE(page);
    std::string changed = bytes;
    changed.replace(page * page_size, page_size, page_size, '\0');
    const Recovered recovered = recover_bytes(folder, before, changed);
    if (recovered.events < all_events(before)) CHECK_FALSE(recovered.whole);
    lost_some = recovered.events < all_events(before) || lost_some;
  }
  CHECK(lost_some);
}

TEST_CASE("recovery stops at a changed event and counts what lies behind it", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  std::string bytes = bytes_of(path);
  const std::string& body = before.events.at("P01-simulated")[11].body;
  for (std::size_t at = bytes.find(body); at != std::string::npos; at = bytes.find(body, at + 1))
    bytes[at + 9] = bytes[at + 9] == '9' ? '8' : '9';  // a digit of {"index":
  write_bytes(folder / "damaged.jnd", bytes);
  const RecoveryReport report = recover(folder / "damaged.jnd", folder / "new.jnd", std::nullopt, kLater);
  CHECK_FALSE(report.whole());
  REQUIRE(report.sessions.size() == 3);
  const RecoveredChain& chain = report.sessions[0];
  CHECK(chain.session == "P01-simulated");
  CHECK(chain.events == 11);
  CHECK(chain.unchained == 26 - 11);
  CHECK(chain.last_found == 26);
  CHECK(chain.last_kind == before.events.at("P01-simulated")[10].kind);
  CHECK(utc_ns_from(chain.last_utc) == before.events.at("P01-simulated")[10].stamp.utc_ns);
  CHECK(chain.cut);
  CHECK_FALSE(chain.closed);
  CHECK(report.sessions[1].closed);
  CHECK(report.pages_missing == 0);
  CHECK(report.events_added == report.events_found + chain.unchained);
  CHECK(report.verified.problems == std::vector<Problem>{});
  // The session is open in the new study, and can be gone on with.
  const auto study = Study::open(folder / "new.jnd", Study::Access::read_only);
  CHECK(study->sessions().front().state != study->sessions().back().state);
}

TEST_CASE("what a killed program left in the write-ahead log is recovered", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  std::string file, log;
  StudyContent before;
  {
    const auto study = new_study(path);
    fill_study(*study);
    file = bytes_of(path);
    log = bytes_of(folder / "study.jnd-wal");
    before = content_of(path);
  }
  REQUIRE(log.size() > 100'000);
  CHECK(recover_bytes(folder, before, file, log).events == all_events(before));
  // The log without its header, and with a damaged frame in the middle, where SQLite would stop reading.
  CHECK(recover_bytes(folder, before, file, std::string(32, '\0') + log.substr(32)).events == all_events(before));
  std::string changed = log;
  changed[32 + 10 * 4120 + 5] = 'x';
  changed[32 + 10 * 4120 + 2000] = static_cast<char>(changed[32 + 10 * 4120 + 2000] ^ 1);
  CHECK(recover_bytes(folder, before, file, changed).events == all_events(before));
  std::size_t most = 0;
  for (std::size_t part = 1; part <= 6; ++part) {
    const std::size_t events = recover_bytes(folder, before, file, log.substr(0, log.size() * part / 6)).events;
    CHECK(events >= most);
    most = std::max(most, events);
  }
  CHECK(most == all_events(before));
}

TEST_CASE("telemetry that is lost is said to be lost, and its trial stays", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const StudyContent before = content_of(path);
  std::string bytes = bytes_of(path);
  const std::string& blob = before.telemetry.at({"P03-simulated", 3})[1].bytes;
  const std::size_t at = bytes.find(blob.substr(100, 200));
  REQUIRE(at != std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  const Recovered recovered = recover_bytes(folder, before, bytes);
  CHECK(recovered.events == all_events(before));
  CHECK(recovered.telemetry == 5);
  CHECK_FALSE(recovered.whole);
}

TEST_CASE("without its protocol a study is recovered only with the same file", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  std::string bytes = bytes_of(path);
  for (std::size_t at = bytes.find("\"reference\""); at != std::string::npos; at = bytes.find("\"reference\"", at + 1))
    bytes[at + 1] = 'X';
  write_bytes(folder / "damaged.jnd", bytes);
  const auto recover_with = [&](const std::optional<std::filesystem::path>& protocol) {
    return recover(folder / "damaged.jnd", folder / "new.jnd", protocol, kLater);
  };
  const std::string protocols = std::string(JND_SOURCE_DIR) + "/protocols/";
  CHECK_THROWS_WITH(recover_with(std::nullopt), Catch::Contains("--protocol") && Catch::Contains(tutorial().sha256));
  CHECK_THROWS_WITH(recover_with(protocols + "chinello2017.json"),
                    Catch::Contains("is not the protocol of this study"));
  const RecoveryReport report = recover_with(protocols + "tutorial.json");
  CHECK(report.doubts.size() == 1);
  CHECK(report.verified.problems == std::vector<Problem>{});
}

TEST_CASE("a study chain that lost its end is known by a session that it does not close", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  // The closing of the second session is the last event of the study's own chain: nothing lies behind the gap.
  hidden_sql(
      path,
      "PRAGMA secure_delete = ON; DELETE FROM event WHERE session = 'study' AND seq = 3; VACUUM; UPDATE tally SET "
      "events = events - 1");
  const RecoveryReport report = recover(path, folder / "new.jnd", std::nullopt, kLater);
  CHECK(report.sessions.size() == 3);
  CHECK(report.own.events == 2);
  CHECK(report.own.unchained == 0);
  CHECK(report.own.cut);
  CHECK_FALSE(report.whole());
  REQUIRE(report.doubts.size() == 1);
  CHECK_THAT(report.doubts[0], Catch::Contains("the end of the study's own events is lost"));
  CHECK(report.verified.problems == std::vector<Problem>{});
}

TEST_CASE("an end that was cut off is missed where nothing but a later session or the count of events knows of it",
          "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    run_whole_session(*study, tutorial(), 1);
    exclude_participant(*study, "P01", SessionKind::simulated, "asleep", false, kLater);
    study->open_session(new_session(2, SessionKind::real));
  }
  const std::string cut = "PRAGMA secure_delete = ON; DELETE FROM event WHERE kind = 'participant.excluded'; VACUUM;";
  hidden_sql(path, cut);
  const RecoveryReport counted = recover(path, folder / "counted.jnd", std::nullopt, kLater);
  CHECK_FALSE(counted.whole());
  REQUIRE(counted.doubts.size() == 2);
  CHECK(counted.doubts[0] == "30 events were added to the study, and 29 of them were found");
  CHECK_THAT(counted.doubts[1], Catch::Contains("the end of the study's own events is lost"));
  CHECK(counted.verified.problems == std::vector<Problem>{});
  hidden_sql(path, "UPDATE tally SET events = events - 1");
  const RecoveryReport pinned = recover(path, folder / "pinned.jnd", std::nullopt, kLater);
  CHECK_FALSE(pinned.whole());
  CHECK(pinned.own.cut);
  CHECK(pinned.doubts.size() == 1);
  CHECK(pinned.verified.problems == std::vector<Problem>{});
}

TEST_CASE("a file that ends early says how many of its pages are missing", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    for (int number = 1; number <= 6; ++number) run_whole_session(*study, tutorial(), number);
  }
  const std::string bytes = bytes_of(path);
  write_bytes(path, bytes.substr(0, bytes.size() - 2 * 4096 - 1));
  const RecoveryReport report = recover(path, folder / "new.jnd", std::nullopt, kLater);
  CHECK_FALSE(report.whole());
  CHECK(report.pages == static_cast<std::int64_t>(bytes.size() / 4096));
  CHECK(report.pages_missing == 3);
  REQUIRE_FALSE(report.doubts.empty());
  CHECK(report.doubts[0] == "the file ends early: 3 of its " + std::to_string(bytes.size() / 4096) +
                                " pages are missing, and what was on them");
  std::string headless = bytes;
  headless.replace(0, 100, 100, 'x');
  write_bytes(path, headless);
  const RecoveryReport lost = recover(path, folder / "headless.jnd", std::nullopt, kLater);
  CHECK_THAT(lost.doubts.at(0), Catch::Contains("header is damaged"));
  CHECK_FALSE(lost.pages);
  CHECK_FALSE(lost.events_added);
}

TEST_CASE("of two events that both follow, the one written last is kept", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  for (const int flipped : {0, 1}) {  // one of the two orders is not that of the hashes
    std::filesystem::remove(path);
    new_study(path)->open_session(new_session(1));
    const std::string file = bytes_of(path);
    const auto add = [&](int last) {
      write_bytes(path, file);
      const auto study = Study::open(path, Study::Access::read_write);
      const auto log = study->resume_session("P01-simulated");
      log->append(event_kind::kBreakTaken, {{"after_trial", 1}, {"duration_s", 1.0 + last}}, kLater);
      return log->events().back().hash;
    };
    add(flipped);
    const std::string first = bytes_of(path);
    const std::string written_last = add(1 - flipped);
    const std::string second = bytes_of(path);
    // Both one behind the other, as pages: the rows of the second are found later.
    const std::string both = first + second;
    const Bytes bytes{reinterpret_cast<const unsigned char*>(both.data()), both.size()};
    const Salvage salvage(bytes, {});
    CHECK(salvage.chain("P01-simulated").head == written_last);
  }
}

TEST_CASE("a copy that cannot be written says why, and speaks of room only where that is missing", "[data]") {
  const TemporaryFolder folder;
  write_bytes(folder / "damaged.jnd", std::string(20'000, 'x'));
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const rlimit little{4096, before.rlim_max};
  auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
  std::string why;
  try {
    const PrivateCopy copy(folder / "damaged.jnd", folder.path());
  } catch (const StorageError& error) {
    why = error.what();
  }
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
  std::signal(SIGXFSZ, handler);
  CHECK_THAT(why, Catch::StartsWith(folder.path().string() + ": a copy of the damaged file cannot be written: ") &&
                      Catch::Contains("larger than is allowed") && !Catch::Contains("the disk is full"));
}

TEST_CASE("recovery refuses what it must not touch", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  CHECK_THROWS_WITH(recover(folder / "none.jnd", folder / "new.jnd", std::nullopt, kLater),
                    Catch::Contains("there is no such file"));
  CHECK_THROWS_WITH(recover(folder.path(), folder / "new.jnd", std::nullopt, kLater),
                    Catch::Contains("it is a folder, not a file"));
  write_bytes(folder / "text.jnd", std::string(20'000, 'x'));
  CHECK_THROWS_WITH(recover(folder / "text.jnd", folder / "new.jnd", std::nullopt, kLater),
                    Catch::Contains("nothing of a study was found"));
  CHECK_THROWS_WITH(recover(path, path, std::nullopt, kLater), Catch::Contains("is the study itself"));
  const auto open = Study::open(path, Study::Access::read_write);
  CHECK_THROWS_WITH(recover(path, folder / "new.jnd", std::nullopt, kLater), Catch::Contains("writing to this study"));
  CHECK_FALSE(std::filesystem::exists(folder / "new.jnd"));
}

TEST_CASE("a study that was not closed is in doubt where its log is not beside it", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "study.jnd";
  {
    const auto study = new_study(path);
    fill_study(*study);
    // What was saved until now is in the file, and only in the log from here on.
    SQLite::Database other(path.string(), SQLite::OPEN_READWRITE);
    SQLite::Statement(other, "PRAGMA wal_checkpoint(PASSIVE)").executeStep();
    write_bytes(folder / "copy.jnd", bytes_of(path));
    study->open_session(new_session(4));
  }
  const RecoveryReport report = recover(folder / "copy.jnd", folder / "new.jnd", std::nullopt, kLater);
  CHECK_FALSE(report.whole());
  REQUIRE(report.doubts.size() == 1);
  CHECK_THAT(report.doubts[0], Catch::Contains("was not closed, and its log (-wal) is missing or empty"));
  CHECK(recover(path, folder / "closed.jnd", std::nullopt, kLater).whole());
}

TEST_CASE("more events than a study counts leave a doubt about its newest count", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  hidden_sql(path, "UPDATE tally SET events = events - 4");
  const RecoveryReport report = recover(path, folder / "new.jnd", std::nullopt, kLater);
  CHECK_FALSE(report.whole());
  REQUIRE(report.doubts.size() == 1);
  CHECK_THAT(report.doubts[0], Catch::StartsWith("the newest count of the study's events is lost ("));
}

TEST_CASE("a header that says of more pages than a disk holds is told, and not counted through", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  std::string bytes = bytes_of(path);
  const std::size_t pages = bytes.size() / 4096;
  bytes.replace(28, 4, 4, '\xFF');
  write_bytes(path, bytes);
  CHECK(recover(path, folder / "new.jnd", std::nullopt, kLater).doubts.at(0) ==
        "the file ends early: " + std::to_string(0xFFFFFFFFU - pages) +
            " of its 4294967295 pages are missing, and what was on them");
}

TEST_CASE("a log that is no file is refused", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  const auto log = folder / "study.jnd-wal";
  const auto refused = [&] {
    CHECK_THROWS_WITH(recover(path, folder / "new.jnd", std::nullopt, kLater),
                      log.string() + ": is not a file; remove it and try again");
    std::filesystem::remove(log);
  };
  REQUIRE(::mkfifo(log.c_str(), 0600) == 0);
  refused();
  std::filesystem::create_symlink("/dev/zero", log);
  refused();
  std::filesystem::create_directory(log);
  refused();
}

}  // namespace
}  // namespace jnd
