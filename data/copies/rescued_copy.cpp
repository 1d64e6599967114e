#include "data/copies/rescued_copy.h"

#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "data/copies/backup.h"
#include "data/log/storage_error.h"
#include "data/study/study.h"
#include "data/study/study_lock.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr int kMostCopies = 99;  // that are looked for

// Null if there is none that can be read.
std::unique_ptr<Study> readable(const fs::path& study) {
  try {
    return Study::open(study, Study::Access::read_only);
  } catch (const StorageError&) {
    return nullptr;
  }
}

}  // namespace

fs::path rescued_name(const fs::path& study, int n) {
  return study.parent_path() /
         (study.stem().string() + (n == 1 ? "-rescued" : fmt::format("-rescued-{}", n)) + study.extension().string());
}

void refuse_rescued(const fs::path& study) {
  std::unique_ptr<Study> opened;
  for (int n = 1; n <= kMostCopies; ++n) {
    const fs::path copy = rescued_name(real_place(study), n);
    std::error_code ignored;
    if (!fs::exists(copy, ignored)) continue;
    if (!opened) opened = readable(study);
    if (opened ? judge(*opened, copy) == Earlier::further : readable(copy) != nullptr)
      throw StorageError(
          fmt::format("{}: a session of this study went on in {} after this file was taken away, and that copy holds "
                      "answers that {}. Go on with --study {}, or give the copy this name",
                      study.string(), copy.string(), opened ? "this file lacks" : "are nowhere else", copy.string()));
  }
}

}  // namespace jnd
