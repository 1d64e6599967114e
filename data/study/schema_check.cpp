#include "data/study/schema_check.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>

namespace jnd {

namespace {

struct Definition {
  std::string type, text;
};
// By name. Triggers have names of their own; tables, indexes and views share theirs, so that a view in a table's place
// is another thing of the same name.
using Definitions = std::map<std::pair<bool, std::string>, Definition>;

Definitions definitions_of(SQLite::Database& database) {
  Definitions definitions;
  SQLite::Statement query(database,
                          "SELECT type, name, sql FROM sqlite_schema WHERE sql IS NOT NULL AND NOT (type = 'table' AND "
                          "name IN ('sqlite_stat1', 'sqlite_stat4'))");
  while (query.executeStep()) {
    const std::string type = query.getColumn(0).getString();
    definitions[{type == "trigger", query.getColumn(1).getString()}] = {type, query.getColumn(2).getString()};
  }
  return definitions;
}

// Made once for each version that is met.
const Definitions& definitions_made_by(SchemaSteps steps) {
  static std::mutex mutex;
  static std::map<std::vector<const char*>, Definitions> made;
  const std::scoped_lock lock(mutex);
  const auto [found, is_new] = made.try_emplace({steps.begin(), steps.end()});
  if (is_new) {
    SQLite::Database fresh(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    migrate(fresh, 0, steps);
    found->second = definitions_of(fresh);
  }
  return found->second;
}

}  // namespace

std::string to_string(const SchemaDifference& difference) {
  switch (difference.kind) {
    case SchemaDifference::Kind::missing:
      return fmt::format("its {} {} is missing", difference.type, difference.name);
    case SchemaDifference::Kind::other:
      return fmt::format("its {} {} is another", difference.type, difference.name);
    case SchemaDifference::Kind::foreign:
      break;
  }
  return fmt::format("it has a {} {} that no study has", difference.type, difference.name);
}

std::vector<SchemaDifference> schema_differences(SQLite::Database& database, SchemaSteps steps) {
  const auto version = static_cast<std::size_t>(database.execAndGet("PRAGMA user_version").getInt());
  const Definitions& expected = definitions_made_by(steps.first(std::min(version, steps.size())));
  const Definitions found = definitions_of(database);
  std::vector<SchemaDifference> differences;
  for (const auto& [key, definition] : expected) {
    const auto same = found.find(key);
    if (same == found.end())
      differences.push_back({SchemaDifference::Kind::missing, definition.type, key.second});
    else if (same->second.type != definition.type || same->second.text != definition.text)
      differences.push_back({SchemaDifference::Kind::other, definition.type, key.second});
  }
  for (const auto& [key, definition] : found)
    if (!expected.contains(key)) differences.push_back({SchemaDifference::Kind::foreign, definition.type, key.second});
  // What matters most comes first.
  std::stable_partition(differences.begin(), differences.end(),
                        [](const SchemaDifference& one) { return !one.readable(); });
  return differences;
}

}  // namespace jnd
