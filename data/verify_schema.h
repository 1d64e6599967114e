// The definitions of a study's tables, triggers and views against this program's own. Internal to jnd verify.
#pragma once

#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

namespace jnd {

// A changed view would show people other trials than the events hold. Files of older versions are not compared; nor are
// definitions that somebody added.
void check_schema(SQLite::Database& database, std::vector<std::string>& problems);

}  // namespace jnd
