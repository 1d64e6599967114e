// jnd backup: a copy of a study while it may be in use, that was found whole before it got its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/copies/new_file.h"
#include "data/study/study.h"
#include "data/verify/verify.h"

namespace jnd {

struct BackupReport {
  bool written = false;      // false: interrupted, or the copy has problems
  bool interrupted = false;  // by `stop`
  std::vector<SessionInfo> sessions;
  std::string study_head;  // hash of the last event in the study's own chain
  VerifyReport verified;   // of the copy
  std::uintmax_t bytes = 0;
};

// Copies the study as it stands at one instant, also while a session writes to it; verifies the copy; gives it its name
// when it is on the disk, readable by its owner only. stop: looked at between pieces; true leaves nothing behind.
// Throws StorageError: `to` exists (unless replace) or is the study itself, or a disk fails.
// replace: an earlier backup of this study, and nothing that has events which the study lacks.
BackupReport back_up(const Study& study, const std::filesystem::path& to, bool replace,
                     const std::function<bool()>& stop = {});

// What another file is to a study: holds nothing that the study lacks; has further events; is of another study, or none.
enum class Earlier { of_this_study, further, foreign };
Earlier judge(const Study& study, const std::filesystem::path& to);

// The two halves of it. The pages of an open connection to the study at `path`, as of one instant; false where `stop`
// came. Then the verification, and the name where it finds nothing (may_go: see NewFile::publish). Throw StorageError.
bool copy_into(NewFile& file, SQLite::Database& source, const std::filesystem::path& path,
               const std::function<bool()>& stop = {});
BackupReport finish_copy(NewFile& file, const std::function<void(const std::filesystem::path&)>& may_go = {});

}  // namespace jnd
