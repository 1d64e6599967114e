// Files of an older version can be read as they are, and become current ones when they are opened for writing. Files of
// programs from before the release are refused.
#include "data/copies/backup.h"
#include "data/copies/merge.h"
#include "data/copies/recover.h"
#include "data/study/schema_check.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/data/older_study.h"

namespace jnd {
namespace {

using Access = Study::Access;

TEST_CASE("a study of an older version is read as it is", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  const std::string before = bytes_of(path);
  {
    const auto database = open_database(path, false, example_steps());
    CHECK(schema_differences(*database, example_steps()).empty());
    CHECK(database->execAndGet("SELECT count(*) FROM trials").getInt() == 24 + 10);
    CHECK_FALSE(database->tableExists("length"));
  }
  CHECK(bytes_of(path) == before);
  CHECK(version_of(path) == kSchemaVersion);
}

TEST_CASE("a study of an older version becomes current when it is opened for writing, and loses nothing", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  // A reader that has the older file open goes on.
  const auto reader = open_database(path, false, example_steps());
  const std::string before = hashes_in(*reader);
  {
    const auto database = open_database(path, true, example_steps());
    CHECK(schema_differences(*database, example_steps()).empty());
    CHECK(faults_of_second_version(*database).empty());
    CHECK(hashes_in(*database) == before);
    CHECK(hashes_in(*reader) == before);
    CHECK(reader->execAndGet("SELECT count(*) FROM length").getInt() > 0);
  }
  CHECK_THROWS_WITH(Study::open(path, Access::read_only), Catch::Contains("newer jnd"));
  CHECK_THROWS_WITH(Study::open(path, Access::read_write), Catch::Contains("newer jnd"));
}

// Two ways to the same tables: made new, and brought forward.
TEST_CASE("a study brought forward has the schema of a new one", "[data]") {
  const TemporaryFolder folder;
  write_older_study(folder / "older.jnd");
  open_database(folder / "older.jnd", true, example_steps());
  SQLite::Database(folder / "new.jnd", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("");
  {
    SQLite::Database fresh(folder / "new.jnd", SQLite::OPEN_READWRITE);
    migrate(fresh, 0, example_steps());
  }
  const auto schema = [](const std::filesystem::path& path) {
    SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
    SQLite::Statement query(database, "SELECT type, name, sql FROM sqlite_master ORDER BY type, name");
    std::string all;
    while (query.executeStep())
      all += query.getColumn(0).getString() + " " + query.getColumn(1).getString() + ": " +
             query.getColumn(2).getString() + "\n";
    return all;
  };
  CHECK(schema(folder / "older.jnd") == schema(folder / "new.jnd"));
  CHECK_THAT(schema(folder / "new.jnd"), Catch::Contains("table length"));
}

TEST_CASE("a step of the schema that fails leaves the file as it was", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "older.jnd";
  write_older_study(path);
  const std::string before = bytes_of(path);
  const std::array failing = {schema_steps()[0],
                              "CREATE TABLE length (x); INSERT INTO length SELECT raise_nothing(1) FROM event"};
  CHECK_THROWS_AS(open_database(path, true, failing), StorageError);
  CHECK(bytes_of(path) == before);
  CHECK(verify(*Study::open(path, Access::read_write)).problems == std::vector<Problem>{});
}

TEST_CASE("a study written before the release is refused, and not changed", "[data]") {
  const TemporaryFolder folder;
  const auto path = folder / "old.jnd", to = folder / "new.jnd";
  const auto words = Catch::Contains(
      "old.jnd: was written by a jnd from before its first release, whose files this program does not read; it was not "
      "changed. Simulate or run the study again with this program, or analyse the CSV files that were exported from it");
  const auto another = new_study(folder / "another.jnd");
  for (int version = 1; version <= 4; ++version) {
    CAPTURE(version);
    std::filesystem::remove(path);
    write_older_study(path);
    raw_sql(path, "PRAGMA application_id = " + std::to_string(kApplicationIdBeforeRelease) +
                      "; PRAGMA user_version = " + std::to_string(version));
    const std::string before = bytes_of(path);
    CHECK_THROWS_WITH(Study::open(path, Access::read_only), words);
    CHECK_THROWS_WITH(Study::open(path, Access::read_write), words);
    CHECK_THROWS_WITH(recover(path, to, std::nullopt, kNow), words);
    CHECK_THROWS_WITH(merge({path}, to, kNow), words);
    CHECK_THROWS_WITH(back_up(*another, path, true), Catch::Contains("is no backup of this study"));
    CHECK(bytes_of(path) == before);
    CHECK_FALSE(std::filesystem::exists(to));
    CHECK_FALSE(std::filesystem::exists(path.string() + ".lock"));
  }
}

}  // namespace
}  // namespace jnd
