// A study whose file is taken away while it is written to: what was said to be saved can be found. And one writer only,
// whatever names a study has.
#include <functional>

#include <sys/stat.h>
#include <unistd.h>

#include "data/draft.h"
#include "data/seal.h"
#include "data/study_lock.h"
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
    CHECK(events_in(running.rescued) == 4);  // before anybody was asked: killed now, all of it is there
    running.answer(3);
    running.answer(4);
    CHECK(running.study->path() == running.rescued);
    running.study->close();
    CHECK(events_in(running.rescued) == 6);
    CHECK_FALSE(fs::exists(running.rescued.string() + "-wal"));
  }
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
  CHECK_THROWS_AS(running.answer(1), StorageTrouble);
  running.answer(1);
  running.study->close();
  CHECK(running.study->path() == running.path);
  CHECK(events_in(running.path) == 3);
}

TEST_CASE("one writer only, by whatever name the study is called", "[data]") {
  const Running running;
  const auto refused = Catch::Contains("writing to this study");
  fs::create_symlink(running.path, running.folder / "link.jnd");
  CHECK_THROWS_WITH(Study::open(running.folder / "link.jnd", Study::Access::read_write), refused);
  fs::create_hard_link(running.path, running.folder / "twin.jnd");
  CHECK_THROWS_WITH(Study::open(running.folder / "twin.jnd", Study::Access::read_write), refused);
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
