#include "runner/report/report_files.h"

#include <system_error>

#include <fmt/format.h>

#include "data/files/draft.h"
#include "data/files/seal.h"
#include "data/log/storage_error.h"
#include "runner/keys/interrupt.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCommand = "report";

// "out/" is "out".
fs::path plain_path(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

// What an earlier report wrote and has not been changed since. Throw StorageError otherwise.
void page_may_go(const fs::path& page) {
  require_sealed(page, kCommand);
}
void figures_may_go(const fs::path& folder) {
  if (!fs::is_directory(fs::symlink_status(folder)))
    throw StorageError(fmt::format("{}: is not a folder", folder.string()));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) require_sealed(entry.path(), kCommand);
}

void check_place(const fs::path& place, bool replace, void (*may_go)(const fs::path&), std::string_view other) {
  if (!fs::exists(fs::symlink_status(place))) return;
  if (!replace) throw StorageError(fmt::format("{}: exists already; {}, or say --replace", place.string(), other));
  may_go(place);
}

void publish(Draft& draft, const fs::path& place, bool replace, void (*may_go)(const fs::path&)) {
  if (replace)
    draft.replace(may_go);
  else if (!draft.publish())
    throw StorageError(fmt::format("{}: exists already; it was not changed", place.string()));
}

// Figures of an earlier report where this one has none. Under a draft's name they go with it.
void take_figures_away(const fs::path& folder) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  Draft nothing(folder, Draft::What::folder);
  nothing.replace(figures_may_go);
  fs::remove(folder);  // fails where something was put into it meanwhile
}

}  // namespace

void check_report_place(const fs::path& page, const fs::path& folder, bool replace) {
  try {
    if (plain_path(page) == plain_path(folder))
      throw StorageError(fmt::format("{}: the page and the folder of figures need two names", page.string()));
    check_place(plain_path(page), replace, page_may_go, "report to another file");
    check_place(plain_path(folder), replace, figures_may_go, "put the figures into another folder");
  } catch (const fs::filesystem_error& error) {
    throw cannot_write(error.path1().empty() ? page : error.path1(), error.code().value());
  }
}

void write_report(const ReportFiles& files, bool replace) {
  const HoldInterrupts hold;
  check_report_place(files.page, files.folder, replace);
  const fs::path page = plain_path(files.page), folder = plain_path(files.folder);
  try {
    fs::create_directories(page.parent_path());
    fs::create_directories(folder.parent_path());
    Draft page_draft(page, Draft::What::file);
    page_draft.write(sealed(files.page_bytes, kCommand));
    if (files.figures.empty()) {
      take_figures_away(folder);
    } else {
      Draft figures(folder, Draft::What::folder);
      for (const auto& [name, bytes] : files.figures) figures.write_within(name, sealed(bytes, kCommand));
      publish(figures, folder, replace, figures_may_go);
    }
    publish(page_draft, page, replace, page_may_go);
  } catch (const fs::filesystem_error& error) {
    throw cannot_write(error.path1().empty() ? page : error.path1(), error.code().value());
  }
}

}  // namespace jnd
