#include "data/export/data_package.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include "data/export/export_tables.h"
#include "protocols/version.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPackageProfile = "https://datapackage.org/profiles/2.0/datapackage.json";
constexpr const char* kResourceProfile = "https://datapackage.org/profiles/2.0/dataresource.json";
constexpr const char* kSchemaProfile = "https://datapackage.org/profiles/2.0/tableschema.json";
constexpr const char* kName = "datapackage.json";

// What names a row, and which rows of other files it belongs to. A key holds where the file has all of its columns.
// Files of which what names a row may be an empty cell (items, choices and behaviour: of no condition) have none.
struct Keys {
  std::string_view file;
  std::vector<std::string_view> primary;
  bool of_participant = false, of_session = false, of_trial = false;
};

const std::vector<Keys>& keys() {
  static const std::vector<Keys> kKeys = {
      {"participants.csv", {"participant"}},
      {"sessions.csv", {"session"}, true},
      {"trials.csv", {"session", "trial"}, true, true},
      {"intervals.csv", {"session", "seq", "interval", "finger", "channel"}, true, true, true},
      {"voided.csv", {"session", "seq"}, true, true},
      {"answers.csv", {}, true, true},
      {"log.csv", {}, true, true},
      {"cells.csv", {"participant", "condition", "series"}, true},
      {"sub-*/report.csv", {"participant", "condition", "standard"}, true},
      {"estimates.csv", {"participant", "condition", "standard"}, true},
      {"counts.csv", {}, true},
      {"tracks.csv", {}, true},
      {"sureness.csv", {"participant", "condition"}, true},
      {"models.csv", {"participant", "condition", "model", "correction", "method"}, true},
      {"monitoring.csv", {"participant"}, true},
      {"coded.csv", {"condition_code"}},
      {"group.csv", {"condition", "standard", "outcome"}},
      {"contrasts.csv", {"a", "b", "outcome"}},
      {"conditions.csv", {"outcome", "condition"}},
      {"tests.csv", {"outcome"}},
      {"pairs.csv", {"outcome", "a", "b"}},
      {"values.csv", {"outcome", "participant", "condition"}, true},
      {"between.csv", {"effect"}},
      {"condition_by_series.csv", {"effect"}},
      {"sensitivity.csv", {"number", "condition"}},
      {"hierarchical.csv", {"condition", "standard"}},
      {"hierarchical_ratios.csv", {"a", "b", "standard"}},
      {"hierarchical_check.csv", {"condition", "check_level"}},
      {"hierarchical_variants.csv", {"parameter"}},
      {"hierarchical_variant_jnds.csv", {"variant", "condition", "standard"}},
      {"hierarchical_people.csv", {"participant", "condition", "standard"}, true},
      {"proportion.csv", {"condition"}},
      {"ratings.csv", {"item", "a", "b"}},
      {"exposure.csv", {"condition", "object"}},
      {"dictionary.csv", {"file", "column"}}};
  return kKeys;
}

// Separated by blanks; what stands in quotes is one.
std::vector<std::string> words_of(const std::string& levels) {
  std::vector<std::string> words;
  std::string word;
  bool quoted = false;
  for (const char character : levels + " ") {
    if (character == '"') {
      quoted = !quoted;
    } else if (character != ' ' || quoted) {
      word += character;
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, {}));
    }
  }
  return words;
}

Json field_json(const DictionaryRow& row) {
  std::string title = row.column;
  std::replace(title.begin(), title.end(), '_', ' ');
  Json field = {{"name", row.column}, {"title", title}, {"type", to_string(row.type)}, {"description", row.meaning}};
  if (!row.unit.empty()) field["unit"] = row.unit;
  if (row.type == CellType::flag) {
    field["trueValues"] = {"1"};
    field["falseValues"] = {"0"};
  } else if (row.type == CellType::text && !row.levels.empty()) {
    if (row.several)
      field["levels"] = words_of(row.levels);  // a cell may hold several of them
    else
      field["constraints"]["enum"] = words_of(row.levels);
  }
  return field;
}

using Rows = std::vector<DictionaryRow>;

// Of one file, in the order of its columns.
Rows rows_of_file(const Rows& dictionary, std::string_view file) {
  Rows rows;
  for (const DictionaryRow& row : dictionary)
    if (row.file == file) rows.push_back(row);
  return rows;
}

bool has_all(const Rows& rows, const std::vector<std::string_view>& columns) {
  return std::all_of(columns.begin(), columns.end(), [&](std::string_view column) {
    return std::any_of(rows.begin(), rows.end(), [&](const DictionaryRow& row) { return row.column == column; });
  });
}

void add_reference(Json& schema, const Rows& dictionary, const Rows& rows, const char* resource,
                   const std::vector<std::string_view>& columns) {
  const Rows referred = rows_of_file(dictionary, std::string(resource) + ".csv");
  if (!has_all(rows, columns) || !has_all(referred, columns)) return;
  schema["foreignKeys"].push_back({{"fields", columns}, {"reference", {{"resource", resource}, {"fields", columns}}}});
}

// A key's cells are never empty: the columns of a device are, in an interval without one.
std::vector<std::string_view> primary_of(const Keys& key, const Rows& rows) {
  if (has_all(rows, key.primary)) return key.primary;
  if (key.file == "intervals.csv") return {"session", "seq", "interval"};
  return {};
}

void add_keys(Json& schema, const Rows& dictionary, const Rows& rows) {
  const auto key =
      std::find_if(keys().begin(), keys().end(), [&](const Keys& one) { return one.file == rows.front().file; });
  if (key == keys().end()) return;
  if (const auto primary = primary_of(*key, rows); !primary.empty()) schema["primaryKey"] = primary;
  if (key->of_participant) add_reference(schema, dictionary, rows, "participants", {"participant"});
  if (key->of_session) add_reference(schema, dictionary, rows, "sessions", {"session"});
  if (key->of_trial) add_reference(schema, dictionary, rows, "trials", {"session", "trial"});
}

Json schema_json(const Rows& dictionary, const Rows& rows) {
  Json schema = {{"$schema", kSchemaProfile}, {"fields", Json::array()}, {"missingValues", {""}}};
  for (const DictionaryRow& row : rows) schema["fields"].push_back(field_json(row));
  add_keys(schema, dictionary, rows);
  return schema;
}

// "sub-P01/report.csv" is "sub-P01-report".
Json resource_json(const std::string& file, Json schema) {
  std::string name = file.substr(0, file.rfind('.'));
  std::replace(name.begin(), name.end(), '/', '-');
  return {{"$schema", kResourceProfile},
          {"name", name},
          {"path", file},
          {"type", "table"},
          {"format", "csv"},
          {"mediatype", "text/csv"},
          {"encoding", "utf-8"},
          {"schema", std::move(schema)}};
}

// "sub-*/telemetry/*-trace.csv" is "schema/trace.json".
std::string schema_file(std::string pattern) {
  pattern.resize(pattern.rfind('.'));
  if (pattern.ends_with("/*")) pattern.resize(pattern.size() - 2);
  const std::size_t begin = pattern.find_last_of("/-");
  return "schema/" + pattern.substr(begin + 1) + ".json";
}

bool is_pattern(const std::string& file) {
  return file.find('*') != std::string::npos;
}

// In the order of the dictionary.
std::vector<std::string> files_in(const Rows& dictionary) {
  std::vector<std::string> files;
  for (const DictionaryRow& row : dictionary)
    if (files.empty() || files.back() != row.file) files.push_back(row.file);
  return files;
}

// The last pattern that a name has: traces are telemetry of a closer kind. Empty where it has none.
std::string pattern_of(const std::vector<std::string>& patterns, const std::string& name) {
  const auto found = std::find_if(patterns.rbegin(), patterns.rend(), [&](const std::string& pattern) {
    return is_pattern(pattern) && ::fnmatch(pattern.c_str(), name.c_str(), FNM_PATHNAME) == 0;
  });
  return found == patterns.rend() ? std::string() : *found;
}

std::string text_of(const Json& json) {
  return json.dump(1) + "\n";
}

}  // namespace

void write_descriptions(ExportFolder& files, const Protocol& protocol, const std::string& holds,
                        std::vector<DictionaryRow> dictionary) {
  describe("dictionary.csv", dictionary_columns(), dictionary);
  files.write("dictionary.csv", csv_table(dictionary_columns(), dictionary));
  Json package = {{"$schema", kPackageProfile},
                  {"name", protocol.name},
                  {"title", protocol.title},
                  {"description",
                   fmt::format("{} of a study by the protocol {}, written by jnd {}", holds, protocol.name, kVersion)},
                  {"resources", Json::array()}};
  const std::vector<std::string> described = files_in(dictionary);
  for (const std::string& file : described) {
    const Json schema = schema_json(dictionary, rows_of_file(dictionary, file));
    if (is_pattern(file))
      files.write(schema_file(file), text_of(schema));
    else
      package["resources"].push_back(resource_json(file, schema));
  }
  for (const std::string& name : files.names())
    if (const std::string pattern = pattern_of(described, name); !pattern.empty())
      package["resources"].push_back(resource_json(name, schema_file(pattern)));
  files.write(kName, text_of(package));
}

}  // namespace jnd
