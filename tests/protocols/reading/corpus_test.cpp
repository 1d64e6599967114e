// The corpus holds the loader and the JSON schema together: good files pass both, bad files are told with their places.
// GCC 12 with sanitizers finds fault with its own <regex>, which the validator uses.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <map>
#include <memory>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/bad_cases.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;
using nlohmann::json;

namespace {

bool schema_accepts(const json& document) {
  static const json schema_json = json::parse(read_text(protocols_folder() / "protocol.schema.json"));
  static const auto schema = [] {
    auto parsed = std::make_unique<valijson::Schema>();
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    const valijson::adapters::NlohmannJsonAdapter adapter(schema_json);
    parser.populateSchema(adapter, *parsed);
    return parsed;
  }();
  valijson::Validator validator;
  const valijson::adapters::NlohmannJsonAdapter adapter(document);
  return validator.validate(*schema, adapter, nullptr);
}

std::string all_text(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) text += to_text(diagnostic) + "\n";
  return text;
}

}  // namespace

TEST_CASE("shipped protocols and the good corpus pass the loader and the schema") {
  std::vector<std::filesystem::path> files = shipped_files();
  REQUIRE(files.size() >= 3);
  const auto corpus = json_files(corpus_folder() / "good");
  REQUIRE(corpus.size() >= 5);
  files.insert(files.end(), corpus.begin(), corpus.end());
  for (const auto& file : files) {
    CAPTURE(file.string());
    const std::string bytes = read_text(file);
    const ProtocolCheck check = check_protocol(bytes, file.string());
    CHECK(all_text(check.errors) == "");
    REQUIRE(check.protocol);
    CHECK(check.protocol->bytes == bytes);
    CHECK(check.protocol->name == file.stem().string());
    CHECK(schema_accepts(json::parse(bytes)));
  }
}

TEST_CASE("every bad file is told with exactly its mistakes, their places and paths") {
  const std::map<std::string, BadCase> cases = bad_cases();
  REQUIRE(cases.size() >= 342);
  for (const auto& [stem, bad] : cases) {
    const std::string name = stem + ".json";
    const ProtocolCheck check = check_protocol(bad.text, name);
    INFO(name << "\n" << all_text(check.errors));
    CHECK_FALSE(check.protocol);
    CHECK(check.warnings.empty());
    REQUIRE(check.errors.size() == bad.errors.size());
    for (std::size_t i = 0; i < bad.errors.size(); ++i) {
      const Diagnostic& found = check.errors[i];
      CHECK(found.file == name);
      CHECK(found.line == bad.errors[i].line);
      CHECK(found.column == bad.errors[i].column);
      CHECK(found.path == bad.errors[i].path);
      CHECK(found.message.find(bad.errors[i].message) != std::string::npos);
      CHECK(all_text({found}).find("nlohmann") == std::string::npos);
    }
    REQUIRE_THROWS_AS(parse_protocol(bad.text, name), InputError);
  }
}

TEST_CASE("the schema refuses every bad file that a schema can judge") {
  std::map<std::string, int> kinds;
  for (const auto& [name, bad] : bad_cases()) {
    CAPTURE(name);
    ++kinds[bad.schema];
    const json document = json::parse(bad.text, nullptr, false);
    if (bad.schema == "unreadable") continue;  // the grammar is wrong, or the parser refuses what others tolerate
    REQUIRE_FALSE(document.is_discarded());
    CHECK(schema_accepts(document) == (bad.schema == "accepts"));
  }
  CHECK(kinds["refuses"] >= 70);
  CHECK(kinds["unreadable"] >= 25);
  CHECK(kinds.size() == 3);
}
