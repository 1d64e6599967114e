#include "data/files/draft.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <random>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "data/files/descriptor.h"
#include "data/files/left_beside.h"
#include "protocols/input/file_trouble.h"
#include "protocols/input/utf8.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDraft = ".jnd-draft-", kOld = ".jnd-old-", kKept = ".jnd-kept-";  // kept ones stay
constexpr std::string_view kAlphabet = "abcdefghijklmnopqrstuvwxyz0123456789", kDigits = "0123456789";
constexpr std::size_t kLetters = 6;     // random ones, at the end of a name
constexpr std::size_t kMostName = 200;  // bytes of NAME that a draft keeps, so that long names have drafts too

// "NAME.jnd-draft-", cut between characters.
std::string beginning(const fs::path& place, std::string_view mark) {
  std::string name = place.filename().string();
  name.resize(character_boundary(name, kMostName));
  return name + std::string(mark);
}

// With a digit among them, so that no word that people give a file ("backup") looks like them.
bool are_letters(std::string_view text) {
  return text.size() == kLetters && text.find_first_not_of(kAlphabet) == std::string_view::npos &&
         text.find_first_of(kDigits) != std::string_view::npos;
}

std::string letters() {
  std::random_device device;
  std::uniform_int_distribution<std::size_t> any(0, kAlphabet.size() - 1);
  std::string text;
  while (!are_letters(text)) {
    text.clear();
    for (std::size_t i = 0; i < kLetters; ++i) text += kAlphabet[any(device)];
  }
  return text;
}

fs::path fresh_name(const fs::path& place, std::string_view mark) {
  return folder_of(place) / (beginning(place, mark) + letters());
}

// A descriptor of what has this name and is no link, locked; -1 where another process holds it, or it is not ours.
int take(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return -1;
  struct stat found {};
  const bool ours = ::fstat(descriptor, &found) == 0 && found.st_uid == ::geteuid() &&
                    (S_ISREG(found.st_mode) || S_ISDIR(found.st_mode)) && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 &&
                    is_at(path, descriptor);
  if (ours) return descriptor;
  ::close(descriptor);
  return -1;
}

// Locks what has this name and is to be replaced, so that no other program takes it for a killed program's draft and
// clears it away once it has a draft's name. Where it cannot be opened or locked, clear_drafts cannot take it either.
class Held {
 public:
  explicit Held(const fs::path& path) { hold(path); }
  ~Held() { let_go(); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  // Another one may have come to the place before it was moved.
  void hold_instead(const fs::path& path) {
    if (descriptor_ >= 0 && is_at(path, descriptor_)) return;
    let_go();
    hold(path);
  }

 private:
  void hold(const fs::path& path) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ >= 0) (void)::flock(descriptor_, LOCK_EX | LOCK_NB);
  }
  void let_go() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }

  int descriptor_ = -1;
};

void remove_draft(const fs::path& path) noexcept {
  std::error_code ignored;
  if (fs::is_directory(fs::symlink_status(path, ignored))) {
    fs::remove_all(path, ignored);
    return;
  }
  for (const char* suffix : kBesideDatabase) ::unlink((path.string() + suffix).c_str());
  ::unlink(path.c_str());  // last: clear_drafts() finds the others by it
}

// Names beside `place` that begin as its drafts do and go on with the random letters and nothing else.
std::vector<fs::path> names_of(const fs::path& place, std::string_view mark) {
  std::vector<fs::path> found;
  const std::string begin = beginning(place, mark);
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(place), error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(begin) && are_letters(std::string_view(name).substr(begin.size())))
      found.push_back(entry->path());
  }
  return found;
}

int exchange(const fs::path& one, const fs::path& other) noexcept {
  return ::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0 ? 0 : errno;
}

bool is_unknown_to_file_system(int error) noexcept {
  return error == EINVAL || error == ENOSYS || error == ENOTSUP;
}

}  // namespace

fs::path folder_of(const fs::path& place) {
  return place.has_parent_path() ? place.parent_path() : fs::path(".");
}

StorageError cannot_write(const fs::path& path, int error) {
  return StorageError(
      fmt::format("{}: cannot be written: {}", path.string(), file_trouble(path, error, FileUse::write).text()));
}

StorageError cannot_read(const fs::path& path, int error) {
  return StorageError(
      fmt::format("{}: cannot be read: {}", path.string(), file_trouble(path, error, FileUse::read).text()));
}

Draft::Draft(const fs::path& place, What what, Access access) : place_(place), what_(what), access_(access) {
  clear_drafts(place);
  const mode_t mode = access == Access::everyone ? 0777 : 0700;
  for (;;) {
    path_ = fresh_name(place, kDraft);
    if (what == What::folder) {
      if (::mkdir(path_.c_str(), mode) == 0)
        descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    } else {
      descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode & 0666);
    }
    const int error = errno;
    if (descriptor_ < 0 && error == EEXIST) continue;
    if (descriptor_ < 0) {
      if (what == What::folder) ::rmdir(path_.c_str());
      throw cannot_write(place, error);
    }
    // Another program that clears up may have come between the two calls: it holds it, or has taken it away.
    const int failed = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (failed == 0 && is_at(path_, descriptor_)) break;
    if (failed != 0) remove_draft(path_);
    ::close(descriptor_);
    descriptor_ = -1;
    if (failed != 0 && failed != EWOULDBLOCK) throw cannot_write(place, failed);
  }
  // Whatever the umask took away. A file system without modes has none to give.
  if (access == Access::owner) (void)::fchmod(descriptor_, what == What::folder ? 0700 : 0600);
}

Draft::~Draft() {
  if (!path_.empty()) remove_draft(path_);
  ::close(descriptor_);
}

void Draft::write(std::string_view bytes) const {
  if (const int error = write_all(descriptor_, bytes); error != 0) throw cannot_write(place_, error);
  if (::fsync(descriptor_) != 0) throw cannot_write(place_, errno);
}

DraftPart::DraftPart(const fs::path& path, fs::path place) : place_(std::move(place)) {
  descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (descriptor_ < 0) throw cannot_write(place_, errno);
}

DraftPart::DraftPart(DraftPart&& other) noexcept
    : place_(std::move(other.place_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

DraftPart::~DraftPart() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void DraftPart::write(std::string_view bytes) {
  if (const int error = write_all(descriptor_, bytes); error != 0) throw cannot_write(place_, error);
}

void DraftPart::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) throw cannot_write(place_, errno);
}

void Draft::write_within(const fs::path& relative, std::string_view bytes) const {
  DraftPart part = open_within(relative);
  part.write(bytes);
  part.close();
}

DraftPart Draft::open_within(const fs::path& relative) const {
  fs::path folder = path_;
  for (const fs::path& part : relative.parent_path()) {
    folder /= part;
    const bool made = ::mkdir(folder.c_str(), access_ == Access::everyone ? 0777 : 0700) == 0;
    if (!made && errno != EEXIST) throw cannot_write(place_ / relative, errno);
    if (made && access_ == Access::owner) (void)::chmod(folder.c_str(), 0700);
  }
  return {path_ / relative, place_ / relative};
}

bool Draft::publish() {
  // A file's content was flushed by who wrote it. A folder's is flushed here, all of it at once.
  if (what_ == What::folder && ::syncfs(descriptor_) != 0 && !is_unknown_to_file_system(errno))
    throw cannot_write(place_, errno);
  if (const int error = give_name(path_, place_); error != 0) {
    if (error == EEXIST) return false;
    throw cannot_write(place_, error);
  }
  path_.clear();
  finish();
  return true;
}

void Draft::replace(const std::function<void(const fs::path&)>& may_go) {
  if (publish()) return;
  may_go(place_);
  Held held(place_);
  const int error = exchange(path_, place_);
  if (error == 0) {
    try {
      held.hold_instead(path_);
      may_go(path_);
    } catch (...) {
      if (const int failed = exchange(path_, place_); failed != 0) throw kept(std::exchange(path_, {}), failed);
      may_go(place_);  // the same once more, in words that name the place and not the draft
      throw;
    }
    remove_draft(path_);
    path_.clear();
    return finish();
  }
  if (!is_unknown_to_file_system(error)) throw cannot_write(place_, error);
  if (what_ == What::file) {
    if (std::rename(path_.c_str(), place_.c_str()) != 0) throw cannot_write(place_, errno);
    path_.clear();
    return finish();
  }
  const fs::path old = fresh_name(place_, kOld);
  if (std::rename(place_.c_str(), old.c_str()) != 0) throw cannot_write(place_, errno);
  try {
    held.hold_instead(old);
    may_go(old);
    if (const int failed = give_name(path_, place_); failed != 0) throw cannot_write(place_, failed);
  } catch (...) {
    if (const int failed = give_name(old, place_); failed != 0) throw kept(old, failed);
    may_go(place_);
    throw;
  }
  path_.clear();
  remove_draft(old);
  finish();
}

StorageError Draft::kept(const fs::path& old, int error) const {
  // A draft's name is cleared away by the next program.
  fs::path name = fresh_name(place_, kKept);
  if (give_name(old, name) != 0) name = old;
  return StorageError(fmt::format(
      "{}: what was there may not be replaced, and could not be put back ({}); it is kept as {}. Look which "
      "of the two you want, and move it there",
      place_.string(), file_trouble(place_, error, FileUse::write).why, name.string()));
}

// The output has its name by now. Not every file system can say whether that is flushed, and a folder that may be
// written into need not be one that may be opened.
void Draft::finish() {
  const int folder = ::open(folder_of(place_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 && errno == EACCES) return;
  if (folder < 0) throw cannot_write(place_, errno);
  const int error = ::fsync(folder) == 0 ? 0 : errno;
  ::close(folder);
  if (error != 0 && !is_unknown_to_file_system(error)) throw cannot_write(place_, error);
}

void clear_drafts(const fs::path& place) {
  for (const fs::path& old : names_of(place, kOld)) {
    const int descriptor = take(old);
    if (descriptor < 0) continue;
    if (give_name(old, place) == EEXIST) remove_draft(old);  // its successor is there
    ::close(descriptor);
  }
  for (const fs::path& draft : names_of(place, kDraft)) {
    const int descriptor = take(draft);
    if (descriptor < 0) continue;
    remove_draft(draft);
    ::close(descriptor);
  }
}

std::vector<fs::path> left_drafts(const fs::path& place) {
  std::vector<fs::path> left = names_of(place, kDraft);
  std::erase_if(left, [](const fs::path& draft) {
    const int descriptor = take(draft);
    if (descriptor >= 0) ::close(descriptor);
    return descriptor < 0;
  });
  return left;
}

int give_name(const fs::path& made, const fs::path& path) noexcept {
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (!is_unknown_to_file_system(errno)) return errno;
  if (::link(made.c_str(), path.c_str()) == 0) {
    ::unlink(made.c_str());
    return 0;
  }
  // Folders have one name only, and so have files on some file systems: looking first is then the best there is.
  if (errno != EPERM && !is_unknown_to_file_system(errno)) return errno;
  struct stat taken {};
  if (::lstat(path.c_str(), &taken) == 0) return EEXIST;
  return std::rename(made.c_str(), path.c_str()) == 0 ? 0 : errno;
}

}  // namespace jnd
