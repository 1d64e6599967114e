#include "protocols/input/resources.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"

namespace jnd {

namespace fs = std::filesystem;

namespace {

struct Place {
  const char* noun;
  const char* in_source_tree;
  const char* in_prefix;
};

Place place_of(Resource resource) {
  switch (resource) {
    case Resource::protocol:
      return {"protocol", "protocols", "protocols"};
    case Resource::profile:
      return {"profile", "devices/profiles", "profiles"};
    case Resource::device_spec:
      return {"device", "devices/specs", "specs"};
    case Resource::object:
      return {"object", "devices/objects", "objects"};
    case Resource::language:
      return {"language", "runner/words/languages", "languages"};
  }
  return {"", "", ""};
}

// Beside a folder's own files: the protocols of published studies by others.
constexpr const char* kStudies = "studies";

// In this order: what the user says, beside the running binary (an install that was moved), the configured install
// prefix, the source tree it was built from.
fs::path folder_of(Resource resource) {
  const Place place = place_of(resource);
  std::vector<fs::path> candidates;
  if (const char* chosen = std::getenv("JND_DATA_DIR")) candidates.emplace_back(fs::path(chosen) / place.in_prefix);
  std::error_code error;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  if (!error) candidates.push_back(binary.parent_path().parent_path() / "share/jnd" / place.in_prefix);
  // A binary in its build tree belongs to the sources, even where another version is installed.
  const fs::path installed = fs::path(JND_DATA_DIR) / place.in_prefix;
  const fs::path source = fs::path(JND_SOURCE_DIR) / place.in_source_tree;
  const bool in_build_tree = binary.string().starts_with(fs::path(JND_SOURCE_DIR).string() + "/");
  candidates.push_back(in_build_tree ? source : installed);
  candidates.push_back(in_build_tree ? installed : source);
  for (const fs::path& candidate : candidates)
    if (fs::is_directory(candidate, error)) return candidate;
  return {};
}

std::vector<fs::path> folders_of(Resource resource) {
  std::vector<fs::path> folders;
  const fs::path folder = folder_of(resource);
  std::error_code error;
  for (const fs::path& one : {folder, folder / kStudies})
    if (fs::is_directory(one, error)) folders.push_back(one);
  return folders;
}

}  // namespace

std::vector<std::string> shipped_names(Resource resource) {
  std::vector<std::string> names;
  for (const fs::path& folder : folders_of(resource))
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string file = entry.path().filename().string();
      if (file.ends_with(".json") && !file.ends_with(".schema.json")) names.push_back(entry.path().stem().string());
    }
  std::sort(names.begin(), names.end());
  return names;
}

std::string nearest_shipped(Resource resource, const std::string& name) {
  return did_you_mean(name, shipped_names(resource));
}

bool names_a_file(const std::string& name_or_path) noexcept {
  return name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".json");
}

fs::path find_resource(Resource resource, const std::string& name_or_path) {
  const char* noun = place_of(resource).noun;
  std::error_code error;
  if (names_a_file(name_or_path)) {
    if (fs::exists(name_or_path, error)) return name_or_path;
    throw InputError(fmt::format("there is no {} file '{}' (shipped, and named without .json: {})", noun, name_or_path,
                                 fmt::join(shipped_names(resource), ", ")));
  }
  for (const fs::path& folder : folders_of(resource)) {
    fs::path shipped = folder / (name_or_path + ".json");
    if (fs::is_regular_file(shipped, error)) return shipped;
  }
  const std::string hint =
      fs::exists(name_or_path, error) ? fmt::format("; for the file write ./{}", name_or_path) : "";
  throw InputError(fmt::format("no {} called '{}' is shipped{} (shipped: {}){}", noun, name_or_path,
                               nearest_shipped(resource, name_or_path), fmt::join(shipped_names(resource), ", "),
                               hint));
}

fs::path shipped_file(const fs::path& installed_folder, const fs::path& source_folder, const std::string& name) {
  std::error_code error;
  std::vector<fs::path> folders;
  const fs::path binary = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(binary.parent_path().parent_path() / "share/jnd" / installed_folder);
  folders.push_back(fs::path(JND_DATA_DIR) / installed_folder);
  folders.push_back(fs::path(JND_SOURCE_DIR) / source_folder);
  for (const fs::path& folder : folders)
    if (fs::is_regular_file(folder / name, error)) return folder / name;
  return {};
}

}  // namespace jnd
