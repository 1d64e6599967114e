// What a trial costs on the disk, and what happens when the disk is full or fails: nothing acknowledged is lost, and
// the same event can be added again.
#include <atomic>
#include <cerrno>
#include <functional>

#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "data/log/replay.h"
#include "data/study/study_impl.h"
#include "data/verify/verify.h"
#include "tests/catch.h"
#include "tests/data/study_fixture.h"

namespace {

std::atomic<int> flushes{0};
std::atomic<int> failing_flush{0};  // 1: the next one; 0: none
std::atomic<int> failing_write{0};
std::atomic<int> write_error{0};

int flush(int descriptor, long call) {
  ++flushes;
  if (failing_flush > 0 && --failing_flush == 0) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(call, descriptor));
}

bool write_fails() {
  if (failing_write <= 0 || --failing_write != 0) return false;
  errno = write_error;
  return true;
}

ssize_t failing_pwrite(int descriptor, const void* bytes, size_t size, off_t offset) {
  return write_fails() ? -1 : ::pwrite(descriptor, bytes, size, offset);
}

ssize_t failing_plain_write(int descriptor, const void* bytes, size_t size) {
  return write_fails() ? -1 : ::write(descriptor, bytes, size);
}

}  // namespace

// In the place of the C library's, for SQLite too.
extern "C" int fdatasync(int descriptor) {
  return flush(descriptor, SYS_fdatasync);
}
extern "C" int fsync(int descriptor) {
  return flush(descriptor, SYS_fsync);
}

namespace jnd {
namespace {

// SQLite's writes go through ours while it lives.
class WatchedWrites {
 public:
  WatchedWrites() {
    set("pwrite", reinterpret_cast<sqlite3_syscall_ptr>(&failing_pwrite));
    set("pwrite64", reinterpret_cast<sqlite3_syscall_ptr>(&failing_pwrite));
    set("write", reinterpret_cast<sqlite3_syscall_ptr>(&failing_plain_write));
  }
  ~WatchedWrites() {
    failing_write = 0;
    failing_flush = 0;
    for (const char* name : {"pwrite", "pwrite64", "write"}) set(name, nullptr);
  }
  WatchedWrites(const WatchedWrites&) = delete;
  WatchedWrites& operator=(const WatchedWrites&) = delete;

 private:
  static void set(const char* name, sqlite3_syscall_ptr function) {
    sqlite3_vfs* vfs = sqlite3_vfs_find(nullptr);
    vfs->xSetSystemCall(vfs, name, function);
  }
};

struct Bench {
  TemporaryFolder folder;
  std::unique_ptr<Study> study = new_study(folder / "study.jnd", chinello());
  std::vector<Trial> trials = make_plan(chinello(), 1, kSeed).trials;
  std::unique_ptr<SessionLog> log;

  explicit Bench(SessionKind kind) : log(study->open_session(new_session(1, kind))) {}
  void begin(std::size_t i) const {
    log->mark(event_kind::kTrialBegan, {{"index", trials[i].index}, {"attempt", 1}}, stamp_of(trials[i]));
  }
  void answer(std::size_t i) const {
    log->append(event_kind::kTrialCompleted, to_body(record_of(chinello(), trials[i], usual_answer(trials[i]))),
                stamp_of(trials[i]));
  }
  int synchronous() const { return study->impl().database().execAndGet("PRAGMA synchronous").getInt(); }
  bool idle() const { return sqlite3_get_autocommit(study->impl().database().getHandle()) != 0; }
};

TEST_CASE("a person's trial costs one flush, a simulated one none", "[data]") {
  for (const SessionKind kind : {SessionKind::real, SessionKind::pilot, SessionKind::simulated}) {
    const Bench bench(kind);
    for (std::size_t i = 0; i < 20; ++i) {
      const int before = flushes;
      bench.begin(i);
      CHECK(flushes == before);
      bench.answer(i);
      CHECK(flushes == before + (kind == SessionKind::simulated ? 0 : 1));
    }
    CHECK(bench.synchronous() == (kind == SessionKind::simulated ? 1 : 2));
    CHECK(verify(*bench.study).problems == std::vector<Problem>{});
  }
}

TEST_CASE("an event of the study itself is flushed although only simulated sessions run", "[data]") {
  const Bench bench(SessionKind::simulated);
  const int before = flushes;
  bench.study->add_study_event(event_kind::kNote, {{"text", "dark room"}}, {1, 1});
  CHECK(flushes == before + 1);
  CHECK(bench.synchronous() == 1);
}

// Every write, then every flush of an answer and its mark fails once.
void fail_one_by_one(std::atomic<int>& what, int error, const std::string& words) {
  CAPTURE(words);
  const WatchedWrites watched;
  const Bench bench(SessionKind::real);
  write_error = error;
  std::size_t trial = 0;
  int failures = 0;
  for (int nth = 1; nth < 40; ++nth, ++trial) {
    what = nth;
    bool failed = false;
    const auto attempt = [&](const std::function<void()>& action) {
      const std::size_t events = bench.log->events().size();
      try {
        action();
      } catch (const StorageTrouble& trouble) {
        failed = true;
        CHECK_THAT(trouble.what(),
                   Catch::Contains(words) && Catch::Contains("not saved") && Catch::Contains("try again"));
        CHECK(bench.idle());
        CHECK(bench.synchronous() == 2);
        CHECK(bench.log->events().size() == events);
        action();
      }
      CHECK(bench.log->events().size() == events + 1);
    };
    attempt([&] { bench.begin(trial); });
    attempt([&] { bench.answer(trial); });
    what = 0;
    if (!failed) break;
    ++failures;
  }
  CHECK(failures >= 1);
  const SessionState state = replay(bench.log->events());
  CHECK(state.completed.size() == trial + 1);
  bench.study->close_session("P01-real", {9, 9});
  CHECK(verify(*bench.study).problems == std::vector<Problem>{});
  bench.study->close();
  CHECK(verify(*Study::open(bench.folder / "study.jnd", Study::Access::read_only)).problems.empty());
}

TEST_CASE("a full disk and a failing one are trouble that passes, at every write", "[data]") {
  fail_one_by_one(failing_write, ENOSPC, "disk is full");
  fail_one_by_one(failing_write, EDQUOT, "the quota of disk space is used up");
  fail_one_by_one(failing_write, EFBIG, "larger than is allowed");
  fail_one_by_one(failing_write, EROFS, "mounted read-only");
  fail_one_by_one(failing_write, EIO, "disk reported an error");
  fail_one_by_one(failing_flush, 0, "disk reported an error");
}

TEST_CASE("after a flush that failed, what is committed goes into the study before anything is added", "[data]") {
  const Bench bench(SessionKind::real);
  bench.begin(0);
  bench.answer(0);
  bench.begin(1);
  failing_flush = 1;
  CHECK_THROWS_AS(bench.answer(1), StorageTrouble);
  const auto wal = (bench.folder / "study.jnd").string() + "-wal";
  const auto before = std::filesystem::file_size(wal);
  const int flushed = flushes;
  bench.answer(1);
  CHECK(flushes >= flushed + 3);  // of the log, of the study, of the answer
  CHECK(std::filesystem::file_size(wal) < before);
}

TEST_CASE("another program's lock is trouble that passes", "[data]") {
  const Bench bench(SessionKind::real);
  bench.study->impl().database().setBusyTimeout(0);
  SQLite::Database other((bench.folder / "study.jnd").string(), SQLite::OPEN_READWRITE);
  other.exec("BEGIN IMMEDIATE");
  try {
    bench.answer(0);
    FAIL("the lock was not noticed");
  } catch (const StorageTrouble& trouble) {
    CHECK_THAT(trouble.what(), Catch::Contains("another program holds the file"));
  }
  other.exec("COMMIT");
  bench.answer(0);
  CHECK(verify(*bench.study).problems == std::vector<Problem>{});
}

TEST_CASE("study files are private whatever the umask", "[data]") {
  for (const mode_t mask : {mode_t{0}, mode_t{0022}, mode_t{0777}}) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(mask);
    const auto study = new_study(folder / "study.jnd");
    study->open_session(new_session(1));
    ::umask(before);
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      struct stat status {};
      REQUIRE(::stat(entry.path().c_str(), &status) == 0);
      CAPTURE(entry.path().string(), mask);
      CHECK((status.st_mode & 0777) == 0600);
      ++files;
    }
    CHECK(files == 4);  // the study, -wal, -shm, .lock
  }
}

}  // namespace
}  // namespace jnd
