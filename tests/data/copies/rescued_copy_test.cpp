// Nobody goes on in a study's old file while its rescued copy has more.
#include "data/copies/rescued_copy.h"

#include "tests/data/damage_fixture.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;

TEST_CASE("the file of a study whose rescued copy holds more is refused, and the copy named", "[data]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "study.jnd", away = folder / "away.jnd", second = folder / "study-rescued-2.jnd";
  CHECK(rescued_name(path, 1) == folder / "study-rescued.jnd");
  CHECK(rescued_name(path, 2) == second);
  CHECK_NOTHROW(refuse_rescued(path));
  write_bytes(second, "notes on a rescue");
  {
    const auto study = new_study(path);
    fs::rename(path, away);
    const auto note = [&] { study->add_study_event(event_kind::kNote, {{"text", "one"}}, kLater); };
    CHECK_THROWS_AS(note(), StorageTrouble);
    note();
    REQUIRE(study->path() == rescued_name(path, 1));
  }
  const auto refused = Catch::Contains("went on in " + rescued_name(path, 1).string());
  CHECK_THROWS_WITH(refuse_rescued(path), refused && Catch::Contains("are nowhere else"));
  fs::rename(away, path);
  CHECK_THROWS_WITH(refuse_rescued(path), refused && Catch::Contains("this file lacks"));
  write_bytes(path, "damaged");
  CHECK_THROWS_WITH(refuse_rescued(path), refused);
  write_bytes(path, bytes_of(rescued_name(path, 1)));
  CHECK_NOTHROW(refuse_rescued(path));  // it holds the same
  fs::remove(path);
  Study::create(path, "tutorial", tutorial().bytes, 7, kLater)->close();
  CHECK_NOTHROW(refuse_rescued(path));  // of another study
}

}  // namespace
}  // namespace jnd
