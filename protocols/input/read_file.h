// Reads a whole input file that a user named.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace jnd {

// Of protocols, descriptions and what else people write by hand.
inline constexpr std::size_t kMostInputBytes = std::size_t{1} << 20U;

// The bytes as they are, at most `limit` of them. Throws InputError, which says what to do, where the file is missing,
// a folder, a device, a named pipe, unreadable or larger. Waits only for the program behind a shell's <(...).
std::string read_input_file(const std::filesystem::path& path, std::size_t limit = kMostInputBytes);
// The same of standard input, which may be anything that ends within the limit.
std::string read_standard_input(std::size_t limit = kMostInputBytes);

}  // namespace jnd
