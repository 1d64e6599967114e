// Where the shipped protocols, profiles and device specs are: in the source tree of a build, or under an install
// prefix.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace jnd {

enum class Resource { protocol, profile, device_spec, object, language };

// What has a '/' in it or ends in ".json" is a file of the user's. Anything else is a shipped name, and never a file
// that happens to be called so.
bool names_a_file(const std::string& name_or_path) noexcept;

// The file that is meant: the user's own, which exists (whatever it is), or the shipped one.
// Throws InputError that lists the shipped names.
std::filesystem::path find_resource(Resource resource, const std::string& name_or_path);

std::vector<std::string> shipped_names(Resource resource);  // sorted, without ".json"

// "; did you mean 'rrs3'?" of a name that none has, for messages; empty where no name is near.
std::string nearest_shipped(Resource resource, const std::string& name);

// Any other shipped file: under share/jnd of the running binary's install, of the configured prefix, or in the source
// tree, in this order; empty where it is in none.
std::filesystem::path shipped_file(const std::filesystem::path& installed_folder,
                                   const std::filesystem::path& source_folder, const std::string& name);

}  // namespace jnd
