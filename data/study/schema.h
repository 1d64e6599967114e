// The tables, triggers and views of a study file, and how older files become current ones.
#pragma once

namespace SQLite {
class Database;
}

namespace jnd {

inline constexpr int kApplicationId = 0x6A6E6473;    // "jnds" in the header of the file
inline constexpr int kSchemaVersion = 4;             // PRAGMA user_version of a current file
inline constexpr const char* kStudyChain = "study";  // session name of the events that belong to the whole study

// Applies the steps from version `from` (0: an empty file) up to version `to`, and sets both numbers. Call it inside a
// transaction. Throws SQLite::Exception.
void migrate(SQLite::Database& database, int from, int to = kSchemaVersion);

}  // namespace jnd
