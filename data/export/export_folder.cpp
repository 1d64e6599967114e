#include "data/export/export_folder.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "analysis/numerics/stop_request.h"
#include "data/log/storage_error.h"
#include "protocols/input/input_error.h"
#include "protocols/input/read_file.h"
#include "protocols/input/sha256.h"

namespace jnd {

namespace {

namespace fs = std::filesystem;

// As sha256sum(1) writes and checks it: a hash, two spaces and a name a line; lines with '#' are comments.
constexpr const char* kSums = "SHA256SUMS";
constexpr std::string_view kHeading = "# Written by jnd, which replaces this folder only while it is as listed here.\n";
constexpr std::size_t kHashLength = 64;
constexpr std::size_t kWaitingBytes = 1 << 18;  // of a growing file, before they are written
constexpr std::string_view kUnlisted = "is not listed in its SHA256SUMS";

StorageError unreadable(const fs::path& path) {
  return StorageError(fmt::format("{}: cannot be read; nothing was changed. Look at the disk, or choose another folder",
                                  path.string()));
}

std::string content_of(const fs::path& path) {
  try {
    return read_input_file(path, std::numeric_limits<std::size_t>::max());
  } catch (const InputError&) {
    throw unreadable(path);
  }
}

// The sum of a file of any length.
std::string sum_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  Sha256Stream sum;
  std::string piece(kWaitingBytes, '\0');
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0)
    sum.add(std::string_view(piece).substr(0, static_cast<std::size_t>(file.gcount())));
  if (!file.eof()) throw unreadable(path);
  return to_hex(sum.finish());
}

std::string text_of(const std::map<std::string, std::string>& sums, const std::map<std::string, std::int64_t>& lines) {
  std::string text(kHeading);
  for (const auto& [name, sum] : sums) {
    if (name.ends_with(".csv")) text += fmt::format("# {} rows: {}\n", lines.at(name) - 1, name);
    text += fmt::format("{}  {}\n", sum, name);
  }
  return text;
}

// Of whole lines of a table, whose cells may hold line feeds too.
std::int64_t count_lines(std::string_view csv) noexcept {
  std::int64_t lines = 0;
  bool quoted = false;
  for (const char c : csv) {
    if (c == '"') quoted = !quoted;
    if (c == '\n' && !quoted) ++lines;
  }
  return lines;
}

// Empty where there is no such list.
std::map<std::string, std::string> listed_in(const fs::path& folder) {
  std::map<std::string, std::string> sums;
  if (!fs::is_regular_file(fs::symlink_status(folder / kSums))) return sums;
  std::istringstream text(content_of(folder / kSums));
  for (std::string line; std::getline(text, line);)
    if (line.size() > kHashLength + 2 && !line.starts_with('#'))
      sums[line.substr(kHashLength + 2)] = line.substr(0, kHashLength);
  return sums;
}

// The folder may be replaced: it holds nothing but what was written into it. Files that were removed since are no loss.
void may_go(const fs::path& folder) {
  if (!fs::is_directory(fs::symlink_status(folder)))
    throw StorageError(fmt::format("{}: is not a folder", folder.string()));
  const auto refuse = [&](const fs::path& entry, std::string_view why) {
    throw StorageError(fmt::format("{}: holds {}, which {}; nothing was changed. Choose another folder",
                                   folder.string(), entry.lexically_relative(folder).string(), why));
  };
  const std::map<std::string, std::string> listed = listed_in(folder);
  if (listed.empty() && !fs::is_empty(folder))
    throw StorageError(fmt::format(
        "{}: has no SHA256SUMS that lists its files, by which a folder of jnd is known; nothing was changed. Choose "
        "another folder or remove it yourself",
        folder.string()));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_directory() && !entry.is_symlink()) {
      const auto within = listed.lower_bound(name + "/");
      if (within == listed.end() || !within->first.starts_with(name + "/")) refuse(entry.path(), kUnlisted);
      continue;
    }
    if (name == kSums) continue;
    const auto found = listed.find(name);
    if (found == listed.end()) refuse(entry.path(), kUnlisted);
    if (entry.is_symlink() || !entry.is_regular_file()) refuse(entry.path(), "is not the file that jnd wrote");
    if (sum_of(entry.path()) != found->second) refuse(entry.path(), "was changed since jnd wrote it");
  }
}

StorageError taken(const fs::path& folder) {
  return StorageError(fmt::format("{}: exists already; name another folder, or say --replace", folder.string()));
}

}  // namespace

ExportFolder::ExportFolder(const fs::path& folder, bool replace) : folder_(folder), replace_(replace) {
  try {
    folder_ = fs::absolute(folder).lexically_normal();
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "out/" is "out"
    const fs::file_status status = fs::symlink_status(folder_);
    if (fs::exists(status)) {
      if (fs::is_directory(status) && !replace) throw taken(folder_);
      may_go(folder_);
    }
    fs::create_directories(folder_.parent_path());
    draft_ = std::make_unique<Draft>(folder_, Draft::What::folder);
  } catch (const fs::filesystem_error& error) {
    throw cannot_write(folder_, error.code().value());
  }
}

fs::path ExportFolder::place_within(const std::string& relative) const {
  fs::path below(relative);
  if (below.is_absolute() || std::find(below.begin(), below.end(), "..") != below.end())
    throw StorageError(
        fmt::format("{}: {} would lie outside of the export; nothing was written to it", folder_.string(), relative));
  return below;
}

void ExportFolder::write(const std::string& relative, const std::string& bytes) {
  stop_if_requested();
  draft_->write_within(place_within(relative), bytes);
  lines_[relative] = count_lines(bytes);
  sums_[relative] = sha256_hex(bytes);
}

void ExportFolder::append(const std::string& relative, const std::string& bytes) {
  stop_if_requested();
  auto file = growing_.find(relative);
  if (file == growing_.end())
    file = growing_.emplace(relative, Growing{draft_->open_within(place_within(relative))}).first;
  file->second.waiting += bytes;
  lines_[relative] += count_lines(bytes);
  if (file->second.waiting.size() >= kWaitingBytes) file->second.flush();
}

void ExportFolder::Growing::flush() {
  part.write(waiting);
  sum.add(waiting);
  waiting.clear();
}

void ExportFolder::finish() {
  for (auto& [name, file] : growing_) {
    file.flush();
    file.part.close();
    sums_[name] = to_hex(file.sum.finish());
  }
  growing_.clear();
  draft_->write_within(kSums, text_of(sums_, lines_));
  finished_ = true;
}

std::vector<std::string> ExportFolder::names() const {
  std::vector<std::string> names;
  for (const auto& [name, sum] : sums_) names.push_back(name);
  for (const auto& [name, file] : growing_) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> ExportFolder::publish() {
  if (!finished_) finish();
  try {
    if (replace_)
      draft_->replace(may_go);
    else if (!draft_->publish())
      throw taken(folder_);
  } catch (const fs::filesystem_error& error) {
    throw cannot_write(folder_, error.code().value());
  }
  return names();
}

}  // namespace jnd
