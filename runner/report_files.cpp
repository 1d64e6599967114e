#include "runner/report_files.h"

#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "data/storage_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

StorageError failed(const fs::path& path, const std::string& why) {
  return StorageError(fmt::format("{}: the report could not be written: {}", path.string(), why));
}

fs::path beside(const fs::path& path, std::string_view what) {
  return path.string() + fmt::format(".{}-{}", what, ::getpid());
}

// "out/" is "out".
fs::path plain_path(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

void check_page(const fs::path& page, bool replace) {
  const fs::file_status status = fs::symlink_status(page);
  if (!fs::exists(status)) return;
  if (!fs::is_regular_file(status)) throw StorageError(fmt::format("{}: is not a file", page.string()));
  if (!replace)
    throw StorageError(fmt::format("{}: exists already; report to another file, or say --replace", page.string()));
}

void check_folder(const fs::path& folder, bool replace) {
  const fs::file_status status = fs::symlink_status(folder);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw StorageError(fmt::format("{}: is not a folder", folder.string()));
  if (!replace)
    throw StorageError(
        fmt::format("{}: exists already; put the figures into another folder, or say --replace", folder.string()));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_symlink() || !entry.is_regular_file() || entry.path().extension() != ".svg")
      throw StorageError(
          fmt::format("{}: holds {}, which is not a figure; nothing was changed. Report to another place",
                      folder.string(), entry.path().filename().string()));
}

void write_file(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw failed(path, "is the disk full?");
}

// What is written before it is moved into place; removed again where that does not come.
class Draft {
 public:
  explicit Draft(const ReportFiles& files)
      : page(beside(files.page, "partial")),
        folder(beside(files.folder, "partial")),
        old(beside(files.folder, "old")) {}
  ~Draft() {
    std::error_code ignored;
    fs::remove(page, ignored);
    fs::remove_all(folder, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const fs::path page, folder, old;
};

void move_into_place(const ReportFiles& files, const Draft& draft) {
  const bool had_folder = fs::exists(files.folder);
  if (had_folder) fs::rename(files.folder, draft.old);
  try {
    if (!files.figures.empty()) fs::rename(draft.folder, files.folder);
    fs::rename(draft.page, files.page);
  } catch (const fs::filesystem_error&) {
    std::error_code ignored;
    if (!files.figures.empty()) fs::remove_all(files.folder, ignored);
    if (had_folder) fs::rename(draft.old, files.folder, ignored);
    throw;
  }
  if (had_folder) fs::remove_all(draft.old);
}

}  // namespace

void check_report_place(const fs::path& page, const fs::path& folder, bool replace) {
  try {
    if (plain_path(page) == plain_path(folder))
      throw StorageError(fmt::format("{}: the page and the folder of figures need two names", page.string()));
    check_page(plain_path(page), replace);
    check_folder(plain_path(folder), replace);
  } catch (const fs::filesystem_error& error) {
    throw failed(page, error.code().message());
  }
}

void write_report(const ReportFiles& wanted, bool replace) {
  check_report_place(wanted.page, wanted.folder, replace);
  ReportFiles files = wanted;
  try {
    files.page = plain_path(wanted.page);
    files.folder = plain_path(wanted.folder);
    fs::create_directories(files.page.parent_path());
    fs::create_directories(files.folder.parent_path());
    const Draft draft(files);
    write_file(draft.page, files.page_bytes);
    if (!files.figures.empty()) fs::create_directory(draft.folder);
    for (const auto& [name, bytes] : files.figures) write_file(draft.folder / name, bytes);
    check_report_place(files.page, files.folder, replace);
    move_into_place(files, draft);
  } catch (const fs::filesystem_error& error) {
    throw failed(files.page, error.code().message());
  }
}

}  // namespace jnd
