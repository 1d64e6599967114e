// The tables, triggers and views of a study file, and how files of an older version become current ones.
#pragma once

#include <span>

namespace SQLite {
class Database;
}

namespace jnd {

inline constexpr int kApplicationId = 0x4A4E4453;               // "JNDS" in the header of the file
inline constexpr int kApplicationIdBeforeRelease = 0x6A6E6473;  // "jnds": files of programs that were never released
inline constexpr int kSchemaVersion = 1;                        // PRAGMA user_version of a current file
inline constexpr const char* kStudyChain = "study";  // session name of the events that belong to the whole study

// SQL. Step i makes a file of version i one of version i + 1; the first one makes an empty file one of version 1.
using SchemaSteps = std::span<const char* const>;
// Of this program, as many as kSchemaVersion. A step that was released is never edited.
SchemaSteps schema_steps() noexcept;

// Applies the steps behind version `from` (0: an empty file), and sets both numbers. Call it inside a transaction.
// Throws SQLite::Exception.
void migrate(SQLite::Database& database, int from, SchemaSteps steps = schema_steps());

}  // namespace jnd
