// Version 3 of a study file: answers that were taken back, participants that were left out, several sessions of each,
// and what the operator did.
#pragma once

namespace SQLite {
class Database;
}

namespace jnd {

// From version 2. Call it inside a transaction. Throws SQLite::Exception.
void to_version_3(SQLite::Database& database);

}  // namespace jnd
