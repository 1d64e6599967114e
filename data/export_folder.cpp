#include "data/export_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "data/export_telemetry.h"
#include "data/storage_error.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

// The only names that an export writes, and so the only ones that replacing one may remove.
constexpr std::array<std::string_view, 21> kTopFiles = {
    "group.csv",   "contrasts.csv",  "answers.csv", "sessions.csv",    "dictionary.csv", "methods.md",
    "tracks.csv",  "tests.csv",      "pairs.csv",   "sensitivity.csv", "behaviour.csv",  "ratings.csv",
    "models.csv",  "thresholds.csv", "cells.csv",   "monitoring.csv",  "coded.csv",      "items.csv",
    "choices.csv", "exposure.csv",   "log.csv"};
constexpr std::array<std::string_view, 3> kParticipantFiles = {"trials.csv", "cells.csv", "report.csv"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool plain(const fs::directory_entry& entry) {
  return entry.is_regular_file() && !entry.is_symlink();
}

// The first thing in a folder that is not an export's; empty where there is none.
fs::path foreign_entry(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (plain(entry) && among(kTopFiles, name)) continue;
    if (!entry.is_directory() || entry.is_symlink() || !name.starts_with("sub-")) return entry.path();
    for (const fs::directory_entry& inner : fs::directory_iterator(entry.path())) {
      if (plain(inner) && among(kParticipantFiles, inner.path().filename().string())) continue;
      if (!inner.is_directory() || inner.is_symlink() || inner.path().filename() != "telemetry") return inner.path();
      for (const fs::directory_entry& tick_file : fs::directory_iterator(inner.path()))
        if (!plain(tick_file) || !is_telemetry_file(tick_file.path().filename().string())) return tick_file.path();
    }
  }
  return {};
}

void refuse_foreign(const fs::path& folder) {
  const fs::path foreign = foreign_entry(folder);
  if (!foreign.empty())
    throw StorageError(
        fmt::format("{}: holds {}, which is not of an export; nothing was changed. Export to another folder",
                    folder.string(), foreign.lexically_relative(folder).string()));
}

StorageError failed(const fs::path& path, std::string_view what, const std::string& why) {
  return StorageError(fmt::format("{}: {}: {}", path.string(), what, why));
}

}  // namespace

ExportFolder::ExportFolder(const fs::path& folder, bool replace) : folder_(folder), replace_(replace) {
  try {
    folder_ = fs::absolute(folder).lexically_normal();
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "out/" is "out"
    const fs::file_status status = fs::symlink_status(folder_);
    if (fs::exists(status)) {
      if (!fs::is_directory(status)) throw StorageError(fmt::format("{}: is not a folder", folder_.string()));
      if (!replace)
        throw StorageError(fmt::format("{}: exists already; export to another folder, or say that it may be replaced",
                                       folder_.string()));
      refuse_foreign(folder_);
    }
    fs::create_directories(folder_.parent_path());
  } catch (const fs::filesystem_error& error) {
    throw failed(folder_, "cannot be used", error.code().message());
  }
  std::string name = folder_.string() + ".partial-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw failed(folder_, "cannot be written", std::strerror(errno));
  draft_ = name;
}

ExportFolder::~ExportFolder() {
  std::error_code ignored;
  if (!draft_.empty()) fs::remove_all(draft_, ignored);
}

void ExportFolder::write(const std::string& relative, const std::string& bytes) {
  const fs::path below(relative);
  if (below.is_absolute() || std::find(below.begin(), below.end(), "..") != below.end())
    throw StorageError(
        fmt::format("{}: {} would lie outside of the export; nothing was written to it", folder_.string(), relative));
  const fs::path path = draft_ / below;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (error || !file)
    throw StorageError(fmt::format("{}: could not be written (is the disk full?); the export was given up",
                                   (folder_ / relative).string()));
  files_.push_back(relative);
}

std::vector<std::string> ExportFolder::publish() {
  try {
    // mkdtemp makes private folders; results get the mode that any new folder would have.
    fs::path old;
    const fs::path twin = draft_.string() + ".new";
    fs::create_directory(twin);
    const fs::perms mode = fs::status(twin).permissions();
    fs::remove(twin);
    fs::permissions(draft_, mode);
    if (fs::exists(folder_)) {
      if (!replace_) throw StorageError(fmt::format("{}: exists already", folder_.string()));
      refuse_foreign(folder_);
      old = draft_.string() + ".old";
      fs::rename(folder_, old);
    }
    std::error_code error;
    fs::rename(draft_, folder_, error);
    if (error) {
      if (!old.empty()) fs::rename(old, folder_);
      throw failed(folder_, "the export could not be moved into place", error.message());
    }
    draft_ = old;  // the destructor removes it
  } catch (const fs::filesystem_error& error) {
    throw failed(folder_, "the export could not be moved into place", error.code().message());
  }
  std::sort(files_.begin(), files_.end());
  return files_;
}

}  // namespace jnd
