// Version 4 of a study file: the order of events is that of their numbers alone, and how many there are is kept.
#pragma once

namespace SQLite {
class Database;
}

namespace jnd {

// From version 3. Call it inside a transaction. Throws SQLite::Exception.
void to_version_4(SQLite::Database& database);

}  // namespace jnd
