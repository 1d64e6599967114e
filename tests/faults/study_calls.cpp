// The calls of the C library that a study makes itself and not through SQLite. The linker brings them here (--wrap), so
// that names which it links and removes are lost at a power cut like SQLite's own.
#include <cerrno>

#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/faults/faulty_disk.h"

namespace {

// False, with errno set: the call must fail.
bool allowed(jnd::test::Step step) {
  const int code = jnd::test::FaultyDisk::of_the_program().take(step);
  errno = code == SQLITE_FULL ? ENOSPC : EIO;
  return code == SQLITE_OK;
}

}  // namespace

extern "C" {

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker's names
int __real_link(const char* from, const char* to);
int __real_unlink(const char* path);
int __real_fsync(int descriptor);
int __real_renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags);

int __wrap_link(const char* from, const char* to) {
  if (!jnd::test::FaultyDisk::of_the_program().has_links()) {
    errno = EPERM;
    return -1;
  }
  if (!allowed(jnd::test::Step::name)) return -1;
  const int result = __real_link(from, to);
  if (result == 0) jnd::test::FaultyDisk::of_the_program().linked(from, to);
  return result;
}

int __wrap_unlink(const char* path) {
  if (!allowed(jnd::test::Step::name)) return -1;
  const int result = __real_unlink(path);
  if (result == 0) jnd::test::FaultyDisk::of_the_program().removed(path);
  return result;
}

// Both names change at once, as FaultyDisk::renamed has it.
int __wrap_renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  if (!allowed(jnd::test::Step::name)) return -1;
  const int result = __real_renameat2(from_folder, from, to_folder, to, flags);
  if (result == 0) jnd::test::FaultyDisk::of_the_program().renamed(from, to);
  return result;
}

// Only folders: files are synced through SQLite.
int __wrap_fsync(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISDIR(status.st_mode)) return __real_fsync(descriptor);
  if (!allowed(jnd::test::Step::sync)) return -1;
  jnd::test::FaultyDisk::of_the_program().synced_folder();
  return 0;
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}
