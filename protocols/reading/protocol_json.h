// Reads a protocol from its JSON form. All mistakes of a file are found in one pass.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "protocols/input/input_error.h"
#include "protocols/protocol.h"

namespace jnd {

struct ProtocolCheck {
  std::optional<Protocol> protocol;  // none where errors is not empty
  std::vector<Diagnostic> errors;
  std::vector<Diagnostic> warnings;
};

// file: only for messages and Protocol::name. Never throws for bad content.
ProtocolCheck check_protocol(std::string bytes, const std::string& file);

// Throws InputError with every mistake, or where the file cannot be read.
Protocol load_protocol(const std::filesystem::path& path);
// The same from bytes that a study kept.
Protocol parse_protocol(std::string bytes, const std::string& file);

}  // namespace jnd
