// The faulty disk itself: a fault that is asked for happens, and nothing else does.
#include "tests/faults/faulty_vfs.h"

#include <set>

#include <sqlite3.h>

#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace jnd::test {
namespace {

// A connection without any of ours around it.
class Plain {
 public:
  explicit Plain(const std::filesystem::path& path) {
    REQUIRE(sqlite3_open_v2(path.c_str(), &connection_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr) ==
            SQLITE_OK);
    sqlite3_extended_result_codes(connection_, 1);
  }
  ~Plain() { sqlite3_close(connection_); }
  Plain(const Plain&) = delete;
  Plain& operator=(const Plain&) = delete;
  int run(const std::string& sql) { return sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr); }
  // The first column of every row; empty where the query fails.
  std::vector<std::string> column(const std::string& sql) {
    std::vector<std::string> rows;
    const int result = sqlite3_exec(
        connection_, sql.c_str(),
        [](void* into, int, char** values, char**) {
          static_cast<std::vector<std::string>*>(into)->emplace_back(values[0] != nullptr ? values[0] : "");
          return 0;
        },
        &rows, nullptr);
    return result == SQLITE_OK ? rows : std::vector<std::string>{};
  }

 private:
  sqlite3* connection_ = nullptr;
};

// Rows 1..n, each committed on its own.
void prepare(Plain& plain, const std::string& journal, int rows) {
  REQUIRE(plain.run("PRAGMA synchronous = FULL; PRAGMA journal_mode = " + journal) == SQLITE_OK);
  REQUIRE(plain.run("CREATE TABLE t (x INTEGER PRIMARY KEY, filler TEXT)") == SQLITE_OK);
  for (int row = 1; row <= rows; ++row)
    REQUIRE(plain.run("INSERT INTO t VALUES (" + std::to_string(row) + ", hex(randomblob(300)))") == SQLITE_OK);
}

FaultyDisk& fresh_disk() {
  FaultyDisk& disk = use_faulty_disk();
  disk.start_afresh();
  return disk;
}

TEST_CASE("A fault that is asked for happens, once or until it is lifted", "[vfs]") {
  struct Case {
    Step step;
    int code;
  };
  for (const std::string journal : {"WAL", "DELETE"})
    for (const Case& one : {Case{Step::write, SQLITE_IOERR_WRITE}, Case{Step::write, SQLITE_FULL},
                            Case{Step::sync, SQLITE_IOERR_FSYNC}, Case{Step::lock, SQLITE_IOERR_LOCK}})
      for (const bool lasting : {false, true}) {
        FaultyDisk& disk = fresh_disk();
        const TemporaryFolder folder;
        Plain plain(folder / "a.sqlite");
        prepare(plain, journal, 3);
        if (one.step == Step::lock) plain.run("PRAGMA locking_mode = NORMAL");
        disk.forget_counts();
        disk.fail({one.step, 1, one.code, lasting, 0.5});
        CAPTURE(journal, one.code, lasting);
        const int result = plain.run("INSERT INTO t VALUES (4, 'x')");
        // A write-ahead log takes its locks in the index, not in the file.
        if (one.step == Step::lock && journal == "WAL") {
          CHECK(disk.struck() == 0);
          disk.lift();
          continue;
        }
        CHECK(result == one.code);
        CHECK(disk.struck() >= 1);
        CHECK(plain.run("INSERT INTO t VALUES (4, 'x')") == (lasting ? one.code : SQLITE_OK));
        disk.lift();
        CHECK(plain.run("INSERT INTO t VALUES (5, 'x')") == SQLITE_OK);
        CHECK(plain.column("SELECT x FROM t").size() == (lasting ? 4 : 5));
        CHECK(plain.column("PRAGMA integrity_check") == std::vector<std::string>{"ok"});
      }
}

TEST_CASE("Opening and truncating fail when they are asked to", "[vfs]") {
  FaultyDisk& disk = fresh_disk();
  const TemporaryFolder folder;
  disk.fail({Step::open, 1, SQLITE_CANTOPEN});
  sqlite3* connection = nullptr;
  CHECK(sqlite3_open((folder / "a.sqlite").c_str(), &connection) == SQLITE_CANTOPEN);
  sqlite3_close(connection);
  Plain plain(folder / "a.sqlite");
  prepare(plain, "WAL", 3);
  disk.fail({Step::truncate, 1, SQLITE_IOERR_TRUNCATE});
  CHECK(plain.run("PRAGMA wal_checkpoint(TRUNCATE)") == SQLITE_IOERR_TRUNCATE);
  CHECK(plain.run("PRAGMA wal_checkpoint(TRUNCATE)") == SQLITE_OK);
}

TEST_CASE("A disk fills up at the byte that was asked for, and goes on once there is room", "[vfs]") {
  FaultyDisk& disk = fresh_disk();
  const TemporaryFolder folder;
  Plain plain(folder / "a.sqlite");
  prepare(plain, "WAL", 3);
  const auto size_before = std::filesystem::file_size((folder / "a.sqlite-wal").string());
  disk.leave_room(10'000);
  int rows = 3;
  while (rows < 100 && plain.run("INSERT INTO t (filler) VALUES (hex(randomblob(300)))") == SQLITE_OK) ++rows;
  CHECK(rows > 3);
  CHECK(rows < 10);
  CHECK(disk.struck() == 1);
  CHECK(std::filesystem::file_size((folder / "a.sqlite-wal").string()) == size_before + 10'000);
  CHECK(plain.run("INSERT INTO t (filler) VALUES (hex(randomblob(300)))") == SQLITE_FULL);
  disk.lift();
  CHECK(plain.run("INSERT INTO t (filler) VALUES ('x')") == SQLITE_OK);
  CHECK(plain.column("SELECT x FROM t").size() == static_cast<std::size_t>(rows) + 1);
}

TEST_CASE("A power cut takes what was not synced, and only that", "[vfs]") {
  std::set<std::size_t> survivors;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    FaultyDisk& disk = fresh_disk();
    const TemporaryFolder folder;
    std::mt19937_64 generator(seed);
    {
      Plain plain(folder / "a.sqlite");
      prepare(plain, "WAL", 3);
      // NORMAL commits without a sync: these may be lost, but never in part.
      plain.run("PRAGMA synchronous = NORMAL");
      for (int row = 4; row <= 9; ++row) plain.run("INSERT INTO t VALUES (" + std::to_string(row) + ", 'x')");
      disk.cut_power_at(1);
      CHECK(plain.run("INSERT INTO t VALUES (10, 'x')") != SQLITE_OK);
      CHECK(disk.off());
      CHECK_THROWS_AS(disk.power_on(generator), std::logic_error);
    }
    disk.power_on(generator);
    Plain plain(folder / "a.sqlite");
    const std::vector<std::string> rows = plain.column("SELECT x FROM t ORDER BY x");
    CAPTURE(seed);
    REQUIRE(rows.size() >= 3);
    REQUIRE(rows.size() <= 9);
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i] == std::to_string(i + 1));
    CHECK(plain.column("PRAGMA integrity_check") == std::vector<std::string>{"ok"});
    survivors.insert(rows.size());
  }
  CHECK(survivors.contains(3));
  CHECK(survivors.contains(9));
  CHECK(survivors.size() > 2);
}

// The model must be able to convict: a journal that is not synced does lose and tear.
TEST_CASE("Without any sync a power cut does damage", "[vfs]") {
  int damaged = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    FaultyDisk& disk = fresh_disk();
    const TemporaryFolder folder;
    std::mt19937_64 generator(seed);
    {
      Plain plain(folder / "a.sqlite");
      prepare(plain, "DELETE", 20);
      plain.run("PRAGMA synchronous = OFF");
      plain.run("UPDATE t SET filler = hex(randomblob(400))");
      disk.cut_power_at(1);
      plain.run("DELETE FROM t WHERE x < 5");
    }
    disk.power_on(generator);
    Plain plain(folder / "a.sqlite");
    const std::vector<std::string> rows = plain.column("SELECT length(filler) FROM t");
    const std::set<std::string> lengths(rows.begin(), rows.end());
    if (rows.size() != 20 || lengths.size() != 1 ||
        plain.column("PRAGMA integrity_check") != std::vector<std::string>{"ok"})
      ++damaged;
  }
  CHECK(damaged > 5);
}

TEST_CASE("A name is lost at a power cut until its folder is synced", "[vfs]") {
  std::set<bool> there;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    FaultyDisk& disk = fresh_disk();
    const TemporaryFolder folder;
    std::mt19937_64 generator(seed);
    {
      Plain plain(folder / "durable.sqlite");
      prepare(plain, "DELETE", 1);
    }
    {
      Plain plain(folder / "fresh.sqlite");
      plain.run("PRAGMA synchronous = OFF");
      plain.run("CREATE TABLE t (x)");
      disk.cut_power_at(1);
      plain.run("INSERT INTO t VALUES (1)");
    }
    disk.power_on(generator);
    CHECK(std::filesystem::exists((folder / "durable.sqlite").string()));
    there.insert(std::filesystem::exists((folder / "fresh.sqlite").string()));
  }
  CHECK(there.size() == 2);
}

TEST_CASE("A bit flips on the read that was asked for, and at rest", "[vfs]") {
  FaultyDisk& disk = fresh_disk();
  const TemporaryFolder folder;
  const auto path = folder / "a.sqlite";
  const auto text = [&] {
    Plain plain(path);
    const std::vector<std::string> found = plain.column("SELECT x FROM t");
    return found.empty() ? std::string() : found[0];
  };
  {
    Plain plain(path);
    REQUIRE(plain.run("CREATE TABLE t (x TEXT); INSERT INTO t VALUES ('@@@@')") == SQLITE_OK);
  }
  REQUIRE(text() == "@@@@");
  const std::string bytes = bytes_of(path);
  const std::size_t place = bytes.find("@@@@");
  REQUIRE(place != std::string::npos);
  int seen = 0;
  for (int read = 1; read <= 12; ++read) {
    disk.flip_on_read({read, static_cast<int>(place % 4096) * 8});
    if (text() == "A@@@") ++seen;
    disk.lift();
  }
  CHECK(seen == 1);
  CHECK(bytes_of(path) == bytes);
  flip_bit_at_rest(path.string(), static_cast<std::int64_t>(place), 1);
  CHECK(text() == "B@@@");
}

}  // namespace
}  // namespace jnd::test
