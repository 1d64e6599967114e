// Knowing again what this program wrote, so that only that is replaced and never what was changed since.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace jnd {

// `text` with a last line more: a comment of HTML, SVG and Markdown that says which command wrote it ("report") and has
// the SHA-256 of all before it.
std::string sealed(std::string text, std::string_view command);

// Throws StorageError, which says why, unless the file is as `command` sealed it: where it is no file of its own (a
// link, a folder), was written by something else, was changed since, or cannot be read.
void require_sealed(const std::filesystem::path& path, std::string_view command);

}  // namespace jnd
