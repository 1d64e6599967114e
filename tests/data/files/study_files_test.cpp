// A study whose file is taken away while it is written to: what was said to be saved can be found. And one writer only,
// whatever names a study has.
#include <functional>

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/files/draft.h"
#include "data/files/seal.h"
#include "data/study/study_impl.h"
#include "data/study/study_lock.h"
#include "data/verify/verify.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

struct Running {
  TemporaryFolder folder;
  fs::path path = folder / "study.jnd", rescued = folder / "study-rescued.jnd";
  std::unique_ptr<Study> study = new_study(path);
  std::unique_ptr<SessionLog> log = study->open_session(new_session(1, SessionKind::pilot));

  void answer(std::size_t trial) const {
    const Trial one = make_plan(tutorial(), 1, kSeed).trials[trial];
    log->append(event_kind::kTrialCompleted, to_body(record_of(tutorial(), one, usual_answer(one))), stamp_of(one));
  }
  std::size_t events() const { return log->events().size(); }
};

void write_over(const fs::path& path, off_t place, const std::string& bytes) {
  const int file = ::open(path.c_str(), O_WRONLY);
  CHECK(::pwrite(file, bytes.data(), bytes.size(), place) == static_cast<ssize_t>(bytes.size()));
  ::close(file);
}

std::size_t events_in(const fs::path& path) {
  const auto study = Study::open(path, Study::Access::read_only);
  CHECK(verify(*study).problems == std::vector<Problem>{});
  return study->events("P01-pilot").size();
}

TEST_CASE("a session whose file is taken away stops, is rescued, and goes on in the new file", "[data]") {
  struct Case {
    const char* words;
    std::function<void(const fs::path&)> take_away;
  };
  const std::vector<Case> cases = {
      {"was removed", [](const fs::path& path) { fs::remove(path); }},
      {"was renamed or moved to", [](const fs::path& path) { fs::rename(path, path.string() + "-moved"); }},
      {"another file was put in the place of",
       [](const fs::path& path) {
         write_bytes(path.string() + ".tmp", "an earlier version");
         fs::rename(path.string() + ".tmp", path);
       }},
      {"was cut off", [](const fs::path& path) { fs::resize_file(path.string() + "-wal", 0); }},
      {"was cut off or written over", [](const fs::path& path) { fs::resize_file(path, 0); }},
      {"was cut off or written over", [](const fs::path& path) { fs::resize_file(path, 4096); }},
      {"was cut off or written over", [](const fs::path& path) { write_over(path, 0, std::string(100, '\0')); }},
      {"was cut off or written over", [](const fs::path& path) { write_over(path, 4096, std::string(4096, '\xA5')); }},
      {"was cut off or written over",
       [](const fs::path& path) { write_over(path, 0, std::string(fs::file_size(path), '\xA5')); }},
      {"was cut off or written over",
       [](const fs::path& path) { write_over(path, static_cast<off_t>(fs::file_size(path)), "grown"); }},
  };
  for (const Case& one : cases) {
    CAPTURE(one.words);
    const Running running;
    for (std::size_t i = 0; i < 3; ++i) running.answer(i);
    one.take_away(running.path);
    try {
      running.answer(3);
      FAIL("it was not noticed");
    } catch (const StorageTrouble& trouble) {
      CHECK_THAT(trouble.what(), Catch::Contains(one.words) && Catch::Contains(running.rescued.string()));
    }
    CHECK(events_in(running.rescued) == 4);  // before the operator was asked: killed now, all of it is there
    running.answer(3);
    running.answer(4);
    CHECK(running.study->path() == running.rescued);
    running.study->close();
    CHECK(events_in(running.rescued) == 6);
    CHECK_FALSE(fs::exists(running.rescued.string() + "-wal"));
  }
}

TEST_CASE("what any program's checkpoint puts into a study is no damage", "[data]") {
  const Running running;
  const auto note = [&](int size) {
    running.log->append(event_kind::kNote, {{"text", std::string(static_cast<std::size_t>(size), 'x')}}, kLater);
  };
  SQLite::Database other(running.path.string(), SQLite::OPEN_READWRITE);
  for (const char* how : {"PASSIVE", "FULL", "RESTART", "TRUNCATE"}) {
    note(100'000);
    note(10);
    SQLite::Statement(other, std::string("PRAGMA wal_checkpoint(") + how + ")").executeStep();
    note(10);
  }
  for (int i = 0; i < 80; ++i) note(100'000);  // several of this program's own
  CHECK(fs::file_size(running.path) > 4'000'000);
  CHECK(fs::file_size(running.path.string() + "-wal") < 8'000'000);
  running.study->close();
  CHECK(running.study->path() == running.path);
}

TEST_CASE("the sessions before are rescued too, and what was put into the file since", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", rescued = folder / "study-rescued.jnd";
  const auto study = new_study(path);
  study->open_session(new_session(1));
  study->close_session("P01-simulated", kLater);
  const auto log = study->open_session(new_session(1, SessionKind::pilot));
  const auto note = [&] { log->append(event_kind::kNote, {{"text", std::string(100'000, 'x')}}, kLater); };
  for (int i = 0; i < 100; ++i) note();
  fs::resize_file(path, 0);
  CHECK_THROWS_WITH(study->close(), Catch::Contains(rescued.string()));
  const auto found = Study::open(rescued, Study::Access::read_only);
  CHECK(found->events("P01-pilot").size() == 101);
  CHECK(found->sessions().size() == 2);
  CHECK(verify(*found).problems == std::vector<Problem>{});
}

TEST_CASE("a study that is put back is gone on with, and the rescued copy goes", "[data]") {
  const Running running;
  running.answer(0);
  fs::rename(running.path, running.folder / "elsewhere");
  CHECK_THROWS_AS(running.answer(1), StorageTrouble);
  fs::rename(running.folder / "elsewhere", running.path);
  running.answer(1);
  CHECK(running.study->path() == running.path);
  CHECK_FALSE(fs::exists(running.rescued));
  running.study->close();
  CHECK(events_in(running.path) == 3);
}

TEST_CASE("a log that was removed costs nothing: the study takes it in and goes on", "[data]") {
  const Running running;
  running.answer(0);
  fs::remove(running.path.string() + "-wal");
  CHECK_THROWS_WITH(running.answer(1), Catch::EndsWith("and in the study again. Try again"));
  running.answer(1);
  CHECK_FALSE(fs::exists(running.rescued));
  running.study->close();
  CHECK(running.study->path() == running.path);
  CHECK(events_in(running.path) == 3);
}

TEST_CASE("a rescue is not given up because the program is asked to end", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", rescued = folder / "study-rescued.jnd";
  const auto study = new_study(path);
  const auto log = study->open_session(new_session(1));
  const auto note = [&] { log->append(event_kind::kNote, {{"text", "one of many"}}, kLater); };
  for (int i = 0; i < 1000; ++i) note();
  fs::remove(path);
  {
    const StopAsked asked;
    CHECK_THROWS_WITH(note(), Catch::Contains(rescued.string()));
    note();
    study->close();
  }
  const auto found = Study::open(rescued, Study::Access::read_only);
  CHECK(found->events("P01-simulated").size() == 1002);
  CHECK(verify(*found).problems == std::vector<Problem>{});
}

TEST_CASE("a study whose folder is gone too is rescued when there is one again", "[data]") {
  const Running running;
  running.answer(0);
  fs::remove_all(running.folder.path());
  CHECK_THROWS_WITH(running.answer(1),
                    Catch::Contains("its folder is gone too") && Catch::Contains("This event is not saved"));
  fs::create_directory(running.folder.path());
  CHECK_THROWS_WITH(running.answer(1), Catch::Contains(running.rescued.string()));
  running.answer(1);
  running.study->close();
  CHECK(events_in(running.rescued) == 3);
}

TEST_CASE("a study that is gone when it is closed is rescued, and its new name told", "[data]") {
  const Running running;
  running.answer(0);
  fs::remove(running.path);
  CHECK_THROWS_WITH(running.study->close(), Catch::Contains(running.rescued.string()) &&
                                                Catch::EndsWith("Use that file from now on") &&
                                                !Catch::Contains("try again"));
  CHECK(events_in(running.rescued) == 2);
}

TEST_CASE("what was written over a log never comes into the study, also where nothing can be rescued", "[data]") {
  Running running;
  running.answer(0);
  const std::string before = bytes_of(running.path);
  fs::create_directory(running.rescued.string() + ".lock");  // no file can be made under that name
  const fs::path log = running.path.string() + "-wal";
  write_bytes(log, std::string(fs::file_size(log), '\xA5'));
  CHECK_THROWS_WITH(running.answer(1), Catch::Contains("could not be put into another file"));
  running.log.reset();
  running.study.reset();
  CHECK(bytes_of(running.path) == before);
}

TEST_CASE("an event that is in what was taken away is not called unsaved, and not added again", "[data]") {
  const Running running;
  const fs::path folder = running.folder.path();
  const auto take_away = [](void* place) {
    fs::remove_all(*static_cast<const fs::path*>(place));
    return 0;
  };
  sqlite3_commit_hook(running.study->impl().database().getHandle(), take_away, const_cast<fs::path*>(&folder));
  try {
    running.study->close_session("P01-pilot", kLater);
    FAIL("it was not noticed");
  } catch (const StorageTrouble&) {
    FAIL("it would be added again");
  } catch (const StorageError& error) {
    CHECK_THAT(error.what(), Catch::Contains("This event and all before it are saved in what was taken away"));
  }
  CHECK_THROWS_WITH(running.answer(0), Catch::Contains("is closed"));
}

TEST_CASE("a study that lacked an event before is rescued all the same", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  hidden_sql(path, "DELETE FROM event WHERE session = 'P01-simulated' AND seq = 5");
  const auto study = Study::open(path, Study::Access::read_write);
  const auto log = study->resume_session("P03-simulated");
  fs::remove(path);
  const auto note = [&] { log->append(event_kind::kNote, {{"text", "later"}}, kLater); };
  const fs::path rescued = folder / "study-rescued.jnd";
  CHECK_THROWS_WITH(note(), Catch::Contains("is now in " + rescued.string()));
  note();
  study->close();
  CHECK(Study::open(rescued, Study::Access::read_only)->events("P03-simulated").size() == 5);
}

TEST_CASE("a study that cannot be looked at is not taken for removed", "[data]") {
  const Running running;
  running.answer(0);
  const fs::path folder = running.folder.path(), away = folder.string() + "-away";
  fs::rename(folder, away);
  fs::create_directory_symlink(folder, folder);  // a name that leads to itself
  CHECK_THROWS_WITH(running.answer(1), Catch::Contains("cannot be looked at") && Catch::Contains("try again"));
  fs::remove(folder);
  fs::rename(away, folder);
  running.answer(1);
  CHECK(running.study->path() == running.path);
  running.study->close();
  CHECK(events_in(running.path) == 3);
}

TEST_CASE("a log that a killed program left goes into the study before anything is added", "[data]") {
  const Running running;
  running.answer(0);
  const fs::path killed = running.folder / "killed.jnd", log = killed.string() + "-wal";
  fs::copy_file(running.path, killed);
  fs::copy_file(running.path.string() + "-wal", log);
  const auto study = Study::open(killed, Study::Access::read_write);
  CHECK(fs::file_size(log) == 0);
  CHECK(study->events("P01-pilot").size() == 2);
}

TEST_CASE("one writer only, by whatever name the study is called", "[data]") {
  const Running running;
  const auto refused = Catch::Contains("writing to this study");
  fs::create_symlink(running.path, running.folder / "link.jnd");
  CHECK_THROWS_WITH(Study::open(running.folder / "link.jnd", Study::Access::read_write), refused);
  fs::create_hard_link(running.path, running.folder / "twin.jnd");
  CHECK_THROWS_WITH(Study::open(running.folder / "twin.jnd", Study::Access::read_write),
                    refused && Catch::Contains("another program, perhaps under another name"));
  fs::remove(running.folder / "twin.jnd");
  fs::remove(running.path.string() + ".lock");
  CHECK_THROWS_WITH(Study::open(running.path, Study::Access::read_write), refused);
}

TEST_CASE("a study with several names is not written to, but a draft's name is cleared away", "[data]") {
  const TemporaryFolder folder;
  const auto path = filled_study(folder);
  fs::create_hard_link(path, folder / "study.jnd.jnd-draft-abc123");
  CHECK_NOTHROW(Study::open(path, Study::Access::read_write)->close());
  CHECK_FALSE(fs::exists(folder / "study.jnd.jnd-draft-abc123"));
  fs::create_hard_link(path, folder / "twin.jnd");
  CHECK_THROWS_WITH(Study::open(path, Study::Access::read_write), Catch::Contains("has 2 names"));
}

TEST_CASE("a draft of a program that lives is left alone, one of a killed program goes", "[data]") {
  const TemporaryFolder folder;
  const Draft living(folder / "page.html", Draft::What::file);
  write_bytes(folder / "page.html.jnd-draft-abc123", "half");
  fs::create_directory(folder / "page.html.jnd-draft-abc124");
  fs::create_symlink(folder / "elsewhere", folder / "page.html.jnd-draft-abc125");
  const Draft second(folder / "page.html", Draft::What::file);
  CHECK(fs::exists(living.path()));
  CHECK_FALSE(fs::exists(folder / "page.html.jnd-draft-abc123"));
  CHECK_FALSE(fs::exists(folder / "page.html.jnd-draft-abc124"));
  CHECK(fs::is_symlink(folder / "page.html.jnd-draft-abc125"));
}

TEST_CASE("what changes while it is replaced is put back", "[data]") {
  const TemporaryFolder folder;
  const fs::path place = folder / "page.html";
  write_bytes(place, sealed("old", "report"));
  Draft draft(place, Draft::What::file);
  draft.write(sealed("new", "report"));
  bool looked = false;
  CHECK_THROWS_AS(draft.replace([&](const fs::path& earlier) {
    if (looked) write_bytes(earlier, "edited just now");
    looked = true;
    require_sealed(earlier, "report");
  }),
                  StorageError);
  CHECK(bytes_of(place) == "edited just now");
  write_bytes(place, sealed("old", "report"));
  draft.replace([](const fs::path& earlier) { require_sealed(earlier, "report"); });
  CHECK(bytes_of(place) == sealed("new", "report"));
}

TEST_CASE("a seal tells what was changed, and whose it is", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "methods.md";
  write_bytes(path, sealed("# Methods\n", "analyze"));
  CHECK_NOTHROW(require_sealed(path, "analyze"));
  CHECK_THROWS_WITH(require_sealed(path, "report"), Catch::Contains("was not written by jnd report"));
  write_bytes(path, sealed("# Methods\n", "analyze") + "mine\n");
  CHECK_THROWS_WITH(require_sealed(path, "analyze"), Catch::Contains("was changed"));
  write_bytes(path, "# Methods: mine\n");
  CHECK_THROWS_WITH(require_sealed(path, "analyze"), Catch::Contains("was not written by"));
}

}  // namespace
}  // namespace jnd
