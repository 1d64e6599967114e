// What `jnd new` and `jnd init` share: the file, and the writing of it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/vocabulary.h"

namespace jnd {

// The name with ".json" behind it, where it has none.
std::filesystem::path protocol_file(const std::string& name);
// Writes a protocol that is new, and its schema beside it, and says so. what: "a copy of tutorial". Throws UsageError
// where the file exists, StorageError where it cannot be written.
void write_new_protocol(const std::filesystem::path& file, const std::string& bytes, const std::string& what);

// JSON as a person writes it. Objects and lists that fit on one line with what stands before them do; the document itself is spread. Ends with a
// line feed.
std::string readable_json(const nlohmann::ordered_json& document);

}  // namespace jnd
