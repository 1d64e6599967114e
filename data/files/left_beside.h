// What SQLite leaves beside a database when a program is killed. SQLite takes it for part of whatever file has the name.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

namespace jnd {

inline constexpr std::array kBesideDatabase = {"-wal", "-journal", "-shm"};

// The first of them beside a name, whether or not a file has the name.
std::optional<std::filesystem::path> left_beside(const std::filesystem::path& name);
// Throws StorageError if there is one. Call it before a database gets the name.
void refuse_left_beside(const std::filesystem::path& name);

}  // namespace jnd
