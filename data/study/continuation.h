// Whether a study goes on in what lies beside it: SQLite takes any log of the study's name for its own.
#pragma once

#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

namespace jnd {

// Why `both`, the study with what lies beside it, does not continue `alone`, the study without that: an event of the
// study is missing, or one that was added does not follow from the event before it. Empty if it does. alone: null if it
// cannot be read, as after a checkpoint that was cut short; then every event must follow. Throws SQLite::Exception if
// `both` cannot be read to its end.
std::string why_no_continuation(SQLite::Database* alone, SQLite::Database& both);

}  // namespace jnd
