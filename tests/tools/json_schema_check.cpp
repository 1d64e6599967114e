// Usage: json_schema_check SCHEMA FILES...
// Says of each JSON file what the schema (draft 7) finds wrong in it; ends with 1 where that is anything.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

json read(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file);
}

bool is_valid(const valijson::Schema& schema, const std::string& path) {
  const json document = read(path);
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(schema, Adapter(document), &results)) return true;
  for (const valijson::ValidationResults::Error& error : results) {
    std::cout << path << ": ";
    for (const std::string& part : error.context) std::cout << part;
    std::cout << ": " << error.description << '\n';
  }
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> paths(arguments + 1, arguments + count);
  if (paths.size() < 2) return 2;
  const json text = read(paths[0]);
  valijson::Schema schema;
  valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(Adapter(text), schema);
  bool all = true;
  for (std::size_t i = 1; i < paths.size(); ++i) all = is_valid(schema, paths[i]) && all;
  return all ? 0 : 1;
}
