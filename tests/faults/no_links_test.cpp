// On FAT and exFAT a file has one name only: a study is created there all the same, whole or not at all.
#include <fstream>

#include "data/copies/backup.h"
#include "data/copies/new_file.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"
#include "tests/faults/faulty_vfs.h"
#include "tests/faults/study_session.h"

namespace jnd::test {
namespace {

FaultyDisk& disk_without_links() {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  disk.go_without_links();
  return disk;
}

TEST_CASE("A disk without links takes a study, its backup and no second one of the same name") {
  FaultyDisk& disk = disk_without_links();
  const TemporaryFolder folder;
  new_study(folder / "study.jnd")->close();
  CHECK_THROWS_WITH(new_study(folder / "study.jnd"), Catch::Contains("exists already"));
  CHECK(back_up(*Study::open(folder / "study.jnd", Study::Access::read_only), folder / "backup.jnd", false).written);
  std::ofstream(folder / "made") << "new";
  CHECK(give_name(folder / "made", folder / "study.jnd") == EEXIST);
  CHECK(give_name(folder / "made", folder / "free") == 0);
  CHECK(bytes_of(folder / "free") == "new");
  CHECK_FALSE(std::filesystem::exists(folder / "made"));
  CHECK(verify(*Study::open(folder / "study.jnd", Study::Access::read_only)).problems.empty());
  disk.start_afresh();
}

// How many changes of the disk a study makes that is created and closed.
int changes_of_a_study() {
  FaultyDisk& disk = disk_without_links();
  const TemporaryFolder folder;
  new_study(folder / "study.jnd")->close();
  return disk.changes();
}

TEST_CASE("A power cut at any step of creating a study on a disk without links leaves it whole or absent",
          "[power_loss]") {
  const int changes = changes_of_a_study();
  int there = 0, absent = 0;
  for (int step = 1; step <= changes; ++step) {
    CAPTURE(step);
    std::mt19937_64 generator(static_cast<std::uint64_t>(step));
    FaultyDisk& disk = disk_without_links();
    const TemporaryFolder folder;
    const auto path = folder / "study.jnd";
    disk.cut_power_at(step);
    bool created = false;
    try {
      const auto study = new_study(path);
      created = true;
      study->close();
    } catch (const StorageError&) {
    }
    REQUIRE(disk.off());
    disk.power_on(generator);
    if (std::filesystem::exists(path)) {
      ++there;
      REQUIRE(verify(*Study::open(path, Study::Access::read_only)).problems == std::vector<Problem>{});
    } else {
      ++absent;
      REQUIRE_FALSE(created);
      REQUIRE_NOTHROW(new_study(path)->close());
    }
  }
  CHECK(there > 0);
  CHECK(absent > 0);
  use_faulty_disk().start_afresh();
}

TEST_CASE("A session on a disk without links comes to its end") {
  disk_without_links();
  const TemporaryFolder folder;
  StudySession session(folder / "study.jnd", SessionKind::pilot);
  OperatorView view;
  session.run(view);
  CHECK(session.check(view.acknowledged, nullptr) == "");
  use_faulty_disk().start_afresh();
}

}  // namespace
}  // namespace jnd::test
