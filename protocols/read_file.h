// Reads a whole input file that a user named.
#pragma once

#include <filesystem>
#include <string>

namespace jnd {

// The bytes as they are. Throws InputError where the file is missing, a folder, unreadable or larger than 1 MiB.
std::string read_input_file(const std::filesystem::path& path);

}  // namespace jnd
