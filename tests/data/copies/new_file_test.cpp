// What a new file is made from is never in its way.
#include "data/copies/new_file.h"

#include "data/copies/backup.h"
#include "data/copies/merge.h"
#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a source that lies under the name of the new file's lock is refused and kept", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "s.lock", to = folder / "s", other = folder / "other";
  fill_study(*new_study(source));
  Study::create(other, "tutorial", tutorial().bytes, 7, kLater)->close();
  const std::string before = bytes_of(source);
  const auto refused = Catch::Contains("would overwrite " + source.string());
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), to, false), refused);
  CHECK_THROWS_WITH(recover(source, to, std::nullopt, kLater), refused);
  CHECK_THROWS_WITH(merge({other, source}, to, kLater), refused);
  CHECK(bytes_of(source) == before);
  CHECK_FALSE(fs::exists(to));
  CHECK(back_up(*Study::open(source, Study::Access::read_only), folder / "t", false).written);
}

TEST_CASE("files that have names like a draft's are nobody's to take", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "study.jnd", to = folder / "copy.jnd";
  fill_study(*new_study(source));
  for (const char* name : {"copy.jnd.new", "copy.jnd.new-wal", "copy.jnd.jnd-draft-", "copy.jnd.lock"})
    write_bytes(folder / name, "mine");
  CHECK_THROWS_WITH(back_up(*Study::open(source, Study::Access::read_only), to, false),
                    Catch::Contains("is no lock file of jnd"));
  CHECK(bytes_of(folder / "copy.jnd.lock") == "mine");
  fs::remove(folder / "copy.jnd.lock");
  CHECK(back_up(*Study::open(source, Study::Access::read_only), to, false).written);
  for (const char* name : {"copy.jnd.new", "copy.jnd.new-wal", "copy.jnd.jnd-draft-"})
    CHECK(bytes_of(folder / name) == "mine");
}

TEST_CASE("a link to the source is known as the source", "[data]") {
  const TemporaryFolder folder;
  const fs::path source = folder / "study.jnd";
  fill_study(*new_study(source));
  const std::string before = bytes_of(source);
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
