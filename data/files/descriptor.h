// Open files: whether a name is that of an open one, and writing through it.
#pragma once

#include <filesystem>
#include <string_view>

#include <sys/stat.h>

namespace jnd {

// Whether both are one file, whatever its names are.
bool same_file(const struct stat& one, const struct stat& other) noexcept;

enum class Links { followed, refused };
// Whether `path` names the file of this descriptor. Links refused: it must do so itself, not through a symbolic link.
bool is_at(const std::filesystem::path& path, int descriptor, Links links = Links::refused) noexcept;

// Writes all of `bytes`. 0 or errno.
int write_all(int descriptor, std::string_view bytes) noexcept;

}  // namespace jnd
