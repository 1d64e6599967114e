// Where the shipped protocols, profiles and device specs are: in the source tree of a build, or under an install
// prefix.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace jnd {

enum class Resource { protocol, profile, device_spec, object };

// A path that exists is taken as it is; otherwise a shipped file of that name, with or without ".json".
// Throws InputError that lists the shipped names.
std::filesystem::path find_resource(Resource resource, const std::string& name_or_path);

std::vector<std::string> shipped_names(Resource resource);  // sorted, without ".json"

}  // namespace jnd
