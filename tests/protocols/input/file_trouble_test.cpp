// The words for files that cannot be read or written tell the causes apart, and name what is in the way.
#include "protocols/input/file_trouble.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "tests/catch.h"
#include "tests/protocols/rigs.h"

namespace jnd {
namespace {

namespace fs = std::filesystem;
constexpr uid_t kNobody = 65534;

// Permissions do not bind root.
class AsNobody {
 public:
  AsNobody() { change(kNobody); }
  ~AsNobody() { change(0); }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  void change(uid_t user) const {
    if (root_ && ::seteuid(user) != 0) throw std::runtime_error("the user cannot be changed");
  }
  const bool root_ = ::getuid() == 0;
};

int error_of_opening(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor < 0) return errno;
  ::close(descriptor);
  return 0;
}

class Folder {
 public:
  fs::path operator/(const char* name) const { return path() / name; }
  fs::path path() const { return kept_.write("file", "x").parent_path(); }

 private:
  test::TemporaryFolder kept_;
};

fs::path file_in(const fs::path& folder, const char* name) {
  std::ofstream(folder / name) << "x";
  return folder / name;
}

std::string said(const fs::path& path, int error, FileUse use = FileUse::write) {
  return file_trouble(path, error, use).text();
}

TEST_CASE("every cause has words of its own, and no other cause is called a full disk") {
  const Folder folder;
  std::set<std::string> all;
  const int causes[] = {EACCES, EROFS, ENOSPC, EDQUOT, EFBIG, ENOENT, ENOTDIR, EISDIR, EIO, ENAMETOOLONG};
  for (const int cause : causes) {
    const FileTrouble trouble = file_trouble(folder / "file", cause, FileUse::write);
    CAPTURE(cause, trouble.why, trouble.what_to_do);
    CHECK_FALSE(trouble.what_to_do.empty());
    CHECK((trouble.why.find("full") != std::string::npos) == (cause == ENOSPC));
    all.insert(trouble.why);
  }
  CHECK(all.size() == std::size(causes));
}

TEST_CASE("without permission the words name the folder that may not be entered or written to, or the file") {
  const Folder folder;
  fs::permissions(folder.path(), fs::perms(0755));
  const fs::path closed = folder / "closed", fixed = folder / "fixed", open = folder / "open";
  for (const fs::path& one : {closed, fixed, open}) fs::create_directory(one);
  const fs::path inside = file_in(closed, "study"), beside = file_in(fixed, "study"), secret = file_in(open, "secret");
  fs::permissions(open, fs::perms(0777));
  fs::permissions(secret, fs::perms(0));
  fs::permissions(fixed, fs::perms(0555));
  fs::permissions(closed, fs::perms(0));
  {
    const AsNobody nobody;
    const int entering = error_of_opening(inside, O_RDONLY);
    REQUIRE(entering == EACCES);
    CHECK(said(inside, entering, FileUse::read).starts_with("no permission to enter the folder " + closed.string()));
    CHECK(said(inside, entering).starts_with("no permission to enter the folder " + closed.string()));
    const int making = error_of_opening(fixed / "new", O_WRONLY | O_CREAT);
    REQUIRE(making == EACCES);
    CHECK(said(fixed / "new", making).starts_with("no permission to write to the folder " + fixed.string()));
    const int reading = error_of_opening(secret, O_RDONLY);
    REQUIRE(reading == EACCES);
    CHECK(said(secret, reading, FileUse::read).starts_with("no permission to read the file " + secret.string()));
    CHECK(said(secret, error_of_opening(secret, O_WRONLY))
              .starts_with("no permission to write to the file " + secret.string()));
    CHECK(write_obstacle(secret) == EACCES);
    CHECK(write_obstacle(beside) == EACCES);
    CHECK(write_obstacle(inside) == EACCES);
  }
  fs::permissions(closed, fs::perms(0700));
  fs::permissions(secret, fs::perms(0600));
  CHECK(write_obstacle(secret) == 0);
}

TEST_CASE("the part of a path that is not there, or is a file, is named") {
  const Folder folder;
  const fs::path file = file_in(folder.path(), "file");
  CHECK(error_of_opening(folder / "no" / "such" / "place", O_RDONLY) == ENOENT);
  CHECK(said(folder / "no" / "such" / "place", ENOENT)
            .starts_with("there is no such folder: " + (folder / "no").string() + ";"));
  CHECK(said(folder / "none", ENOENT, FileUse::read).starts_with("there is no such file"));
  CHECK(error_of_opening(file / "below", O_RDONLY) == ENOTDIR);
  CHECK(said(file / "below" / "it", ENOTDIR).starts_with(file.string() + " is a file, not a folder"));
  CHECK(error_of_opening(folder.path(), O_WRONLY) == EISDIR);
  CHECK(write_obstacle(folder.path()) == EISDIR);
  CHECK(write_obstacle(folder / "none") == ENOENT);
}

}  // namespace
}  // namespace jnd
