// What a new file is made from is never in its way.
#include "data/new_file.h"

#include "data/backup.h"
#include "data/merge.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a source that lies under a name of the new file's own is refused and kept", "[data]") {
  for (const std::string suffix : {".new", ".lock", ".new-wal", ".new-shm", ".new-journal"}) {
    CAPTURE(suffix);
    const TemporaryFolder folder;
    const fs::path source = folder / ("s" + suffix), to = folder / "s", other = folder / "other";
    fill_study(*new_study(source));
    run_whole_session(*Study::create(other, "tutorial", tutorial().bytes, 7, kLater), tutorial(), 9);
    const std::string before = bytes_of(source);
    const auto refused = Catch::Contains("would overwrite " + source.string());
    CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), to, false), refused);
    CHECK_THROWS_WITH(recover(source, to, std::nullopt, kLater), refused);
    CHECK_THROWS_WITH(merge({other, source}, to, kLater), refused);
    CHECK(bytes_of(source) == before);
    CHECK_FALSE(fs::exists(to));
    CHECK(back_up(*Study::open(source, Study::Access::read_only), folder / "t", false).written);
  }
}

TEST_CASE("a link to the source is known as the source", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "study.jnd";
  fill_study(*new_study(source));
  const std::string before = bytes_of(source);
  fs::create_symlink(source, folder / "link.new");
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), folder / "link", false),
                    Catch::Contains("would overwrite"));
  fs::create_hard_link(source, folder / "twin");
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), folder / "twin", true),
                    Catch::Contains("is the study itself"));
  CHECK(bytes_of(source) == before);
}

TEST_CASE("a name that is taken is never given to another file", "[data]") {
  const TemporaryFolder folder;
  write_bytes(folder / "made", "new");
  write_bytes(folder / "taken", "old");
  CHECK(give_name(folder / "made", folder / "taken") == EEXIST);
  CHECK(bytes_of(folder / "taken") == "old");
  CHECK(give_name(folder / "made", folder / "free") == 0);
  CHECK(bytes_of(folder / "free") == "new");
  CHECK_FALSE(fs::exists(folder / "made"));
}

}  // namespace
}  // namespace jnd
