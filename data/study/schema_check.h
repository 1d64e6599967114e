// The tables, triggers and views of a file against those that its own version of a study has: nothing is missing,
// nothing is another, nothing was added.
#pragma once

#include <string>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "data/study/schema.h"

namespace jnd {

struct SchemaDifference {
  enum class Kind { missing, other, foreign };
  Kind kind = Kind::other;
  std::string type;  // "table", "index", "trigger", "view": as a study has it; of what is foreign, as the file has it
  std::string name;

  // A missing trigger, index or view changes nothing that was stored, and reading does without it. With anything else
  // the file may give other rows than were stored, or none.
  bool readable() const noexcept { return kind == Kind::missing && type != "table"; }
};

// In words: "its table event is another".
std::string to_string(const SchemaDifference& difference);

// By the file's user_version; one that no step makes is compared with the newest, because a newer program may bring the
// file up to date at any time. Reads nothing but the schema itself: no view is run, no column computed. What SQLite's
// ANALYZE keeps is no difference. Throws SQLite::Exception.
std::vector<SchemaDifference> schema_differences(SQLite::Database& database, SchemaSteps steps = schema_steps());

}  // namespace jnd
