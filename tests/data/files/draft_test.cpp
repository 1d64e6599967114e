// Drafts on file systems that lack locks, links or the exchange of two names, and beside other people's files.
#include "data/files/draft.h"

#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "data/files/seal.h"
#include "tests/catch.h"
#include "tests/data/damage_fixture.h"

namespace {

// What the file system says instead of doing it; 0: it does it.
struct Refusals {
  int lock = 0, locks = 0;  // how many times
  int exchange = 0, name = 0, link = 0, flush = 0;
};
Refusals refusals;
int flushes = 0;

struct Refusing {
  explicit Refusing(const Refusals& these) { refusals = these; }
  ~Refusing() { refusals = {}; }
  Refusing(const Refusing&) = delete;
  Refusing& operator=(const Refusing&) = delete;
};

int refuse(int error) {
  errno = error;
  return -1;
}

}  // namespace

// In the place of the C library's.
extern "C" int flock(int descriptor, int operation) noexcept {
  if (refusals.locks > 0 && --refusals.locks >= 0) return refuse(refusals.lock);
  return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
}
extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  const int error = flags == RENAME_EXCHANGE ? refusals.exchange : refusals.name;
  if (error != 0) return refuse(error);
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}
extern "C" int link(const char* from, const char* to) noexcept {
  if (refusals.link != 0) return refuse(refusals.link);
  return static_cast<int>(::syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0));
}
extern "C" int syncfs(int descriptor) noexcept {
  ++flushes;
  if (refusals.flush != 0) return refuse(refusals.flush);
  return static_cast<int>(::syscall(SYS_syncfs, descriptor));
}

namespace jnd {
namespace {

namespace fs = std::filesystem;

// The only entry of the folder whose name begins so.
fs::path named(const TemporaryFolder& folder, const std::string& beginning) {
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    if (entry.path().filename().string().starts_with(beginning)) {
      CHECK(found.empty());
      found = entry.path();
    }
  return found;
}

TEST_CASE("a file system without locks is told, and no draft stays on it", "[data]") {
  const TemporaryFolder folder;
  for (const Draft::What what : {Draft::What::file, Draft::What::folder}) {
    const Refusing refusing({.lock = ENOLCK, .locks = 20});
    CHECK_THROWS_WITH(Draft(folder / "page.html", what),
                      Catch::Contains("page.html: cannot be written: No locks available"));
    CHECK(refusals.locks == 19);
    CHECK(fs::is_empty(folder.path()));
  }
  // Another program that clears up holds it for a moment.
  const Refusing refusing({.lock = EWOULDBLOCK, .locks = 3});
  const Draft draft(folder / "page.html", Draft::What::file);
  CHECK(named(folder, "page.html") == draft.path());
}

TEST_CASE("what is being replaced is nobody's to clear away, and words about it name its place", "[data]") {
  const TemporaryFolder folder;
  const fs::path place = folder / "page.html";
  const auto may_go = [&](const fs::path& earlier) {
    if (earlier != place) {
      clear_drafts(place);  // as another command would
      CHECK(fs::exists(earlier));
    }
    if (bytes_of(earlier) == "mine") throw StorageError(earlier.string() + ": is mine");
    if (earlier == place) {  // it changes between the two looks
      fs::remove(place);
      write_bytes(place, "mine");
    }
  };
  for (const int error : {0, EINVAL}) {
    const Refusing refusing({.exchange = error});
    fs::remove_all(place);
    fs::create_directory(place);
    Draft draft(place, Draft::What::folder);
    bool looked = false;
    CHECK_THROWS_WITH(draft.replace([&](const fs::path& earlier) {
      if (earlier != place) {
        clear_drafts(place);
        CHECK(fs::exists(earlier));
      }
      if (looked) throw StorageError(earlier.string() + ": is mine");
      looked = true;
    }),
                      place.string() + ": is mine");
    CHECK(fs::is_directory(place));
  }
  fs::remove(place);
  write_bytes(place, "old");
  {
    Draft draft(place, Draft::What::file);
    draft.write("new");
    CHECK_THROWS_WITH(draft.replace(may_go), place.string() + ": is mine");
  }
  CHECK(named(folder, "page.html") == place);
  CHECK(bytes_of(place) == "mine");
}

TEST_CASE("what can neither go nor be put back is kept, and said where", "[data]") {
  const TemporaryFolder folder;
  const fs::path place = folder / "page.html";
  write_bytes(place, "old");
  {
    Draft draft(place, Draft::What::file);
    draft.write("new");
    CHECK_THROWS_WITH(draft.replace([&](const fs::path& earlier) {
      if (earlier == place) return;
      fs::remove(place);  // nothing is left to change places with
      throw StorageError("no");
    }),
                      Catch::StartsWith(place.string() + ": what was there") &&
                          Catch::Contains("it is kept as " + place.string() + ".jnd-kept-"));
  }
  clear_drafts(place);
  CHECK(bytes_of(named(folder, "page.html")) == "old");
}

TEST_CASE("a folder that was set aside is removed only where its place is taken", "[data]") {
  const TemporaryFolder folder;
  const fs::path place = folder / "out", old = folder / "out.jnd-old-abc123";
  fs::create_directory(old);
  {
    const Refusing refusing({.name = EIO});
    clear_drafts(place);
  }
  CHECK(fs::exists(old));
  clear_drafts(place);
  CHECK(fs::exists(place));
  CHECK_FALSE(fs::exists(old));
  fs::create_directory(old);
  clear_drafts(place);
  CHECK_FALSE(fs::exists(old));
}

TEST_CASE("a file gets its name where a file system knows neither the call nor links", "[data]") {
  const TemporaryFolder folder;
  write_bytes(folder / "made", "new");
  write_bytes(folder / "taken", "old");
  for (const int error : {ENOSYS, EINVAL, ENOTSUP, EPERM}) {
    CAPTURE(error);
    const Refusing refusing({.name = ENOSYS, .link = error});
    CHECK(give_name(folder / "made", folder / "taken") == EEXIST);
    CHECK(give_name(folder / "made", folder / "free") == 0);
    CHECK(bytes_of(folder / "free") == "new");
    fs::rename(folder / "free", folder / "made");
  }
}

TEST_CASE("a folder is flushed before it gets its name", "[data]") {
  const TemporaryFolder folder;
  Draft draft(folder / "out", Draft::What::folder);
  draft.write_within("sub/a.csv", "x");
  {
    const Refusing refusing({.flush = EIO});
    CHECK_THROWS_WITH(draft.publish(), Catch::Contains("out: cannot be written"));
    CHECK_FALSE(fs::exists(folder / "out"));
  }
  flushes = 0;
  CHECK(draft.publish());
  CHECK(flushes == 1);
  CHECK(bytes_of(folder / "out" / "sub" / "a.csv") == "x");
}

TEST_CASE("folders within a folder are its owner's alone, whatever the umask", "[data]") {
  const TemporaryFolder folder;
  for (const mode_t mask : {0, 0277}) {
    const fs::path out = folder / std::to_string(mask);
    const mode_t before = ::umask(mask);
    Draft draft(out, Draft::What::folder);
    draft.write_within("a/b/c.csv", "x");
    CHECK(draft.publish());
    ::umask(before);
    for (const fs::path& path : {out, out / "a", out / "a" / "b"})
      CHECK(fs::status(path).permissions() == fs::perms::owner_all);
  }
}

TEST_CASE("only names with the random letters of a draft are cleared away", "[data]") {
  const TemporaryFolder folder;
  const fs::path place = folder / "study.sqlite";
  for (const char* name : {"backup", "Back01", "a.b123", "ab1234"})
    write_bytes(place.string() + ".jnd-draft-" + name, "mine");
  clear_drafts(place);
  for (const char* name : {"backup", "Back01", "a.b123"})
    CHECK(bytes_of(place.string() + ".jnd-draft-" + name) == "mine");
  CHECK_FALSE(fs::exists(place.string() + ".jnd-draft-ab1234"));
  for (int i = 0; i < 50; ++i) {
    const Draft draft(folder / "x", Draft::What::file);
    const std::string name = draft.path().filename().string();
    CHECK(name.find_first_of("0123456789") != std::string::npos);
  }
}

TEST_CASE("a seal that cannot be looked for is no seal", "[data]") {
  const TemporaryFolder folder;
  for (const fs::path& path : {fs::path("/proc/self/mem"), folder / std::string(300, 'x')})
    CHECK_THROWS_WITH(require_sealed(path, "report"), Catch::StartsWith(path.string() + ": cannot be read"));
}

}  // namespace
}  // namespace jnd
