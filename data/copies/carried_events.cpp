#include "data/copies/carried_events.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "data/log/event_body.h"
#include "data/log/storage_error.h"
#include "data/study/study_lock.h"

namespace jnd {

bool is_carried(std::string_view kind) noexcept {
  return kind != event_kind::kStudyCreated && kind != event_kind::kSessionClosed;
}

bool in_use(const std::filesystem::path& study) {
  const int descriptor = ::open((real_place(study).string() + ".lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool free = ::flock(descriptor, LOCK_SH | LOCK_NB) == 0;
  ::close(descriptor);
  return !free;
}

void refuse_in_use(const std::filesystem::path& study) {
  if (in_use(study))
    throw StorageError(fmt::format(
        "{}: another process is writing to this study; wait until it ends, or end it, and try again", study.string()));
}

}  // namespace jnd
