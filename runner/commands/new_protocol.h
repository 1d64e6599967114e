// What `jnd new` and `jnd init` share: the writing of the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/vocabulary.h"

namespace jnd {

// The name with ".json" behind it, where it has none.
std::filesystem::path protocol_file(const std::string& name);
// Writes a protocol that is new, and its schema beside it, and says so. what: "a copy of tutorial". Throws UsageError
// where the file exists, StorageError where it cannot be written.
void write_new_protocol(const std::filesystem::path& file, const std::string& bytes, const std::string& what);

}  // namespace jnd
