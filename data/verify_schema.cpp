#include "data/verify_schema.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "data/schema.h"

namespace jnd {

namespace {

using Definitions = std::map<std::pair<std::string, std::string>, std::string>;  // (type, name) -> text

Definitions definitions_of(SQLite::Database& database) {
  Definitions definitions;
  SQLite::Statement query(database, "SELECT type, name, sql FROM sqlite_schema WHERE sql IS NOT NULL");
  while (query.executeStep())
    definitions[{query.getColumn(0).getString(), query.getColumn(1).getString()}] = query.getColumn(2).getString();
  return definitions;
}

}  // namespace

void check_schema(SQLite::Database& database, std::vector<std::string>& problems) {
  if (database.execAndGet("PRAGMA user_version").getInt() != kSchemaVersion) return;
  SQLite::Database fresh(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  migrate(fresh, 0);
  const Definitions found = definitions_of(database);
  for (const auto& [key, text] : definitions_of(fresh)) {
    const auto& [type, name] = key;
    const auto same = found.find(key);
    // What a missing table held is missed elsewhere; a missing trigger changes nothing that was stored.
    if (same == found.end() && type == "view")
      problems.push_back(fmt::format("The view {} is missing.", name));
    else if (same != found.end() && same->second != text)
      problems.push_back(fmt::format(
          "The {} {} is not defined as this program defines it: what it shows cannot be relied on.", type, name));
  }
}

}  // namespace jnd
