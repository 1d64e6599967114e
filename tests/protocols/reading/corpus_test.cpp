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
  const json expectations = json::parse(read_text(corpus_folder() / "expectations.json"));
  const auto files = json_files(corpus_folder() / "bad");
  REQUIRE(files.size() == expectations.size());
  REQUIRE(files.size() >= 70);
  for (const auto& file : files) {
    const std::string name = file.filename().string();
    const ProtocolCheck check = check_protocol(read_text(file), name);
    INFO(name << "\n" << all_text(check.errors));
    REQUIRE(expectations.contains(name));
    const json& expected = expectations.at(name).at("errors");
    CHECK_FALSE(check.protocol);
    CHECK(check.warnings.empty());
    REQUIRE(check.errors.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Diagnostic& found = check.errors[i];
      CHECK(found.file == name);
      CHECK(found.line == expected[i].at("line").get<int>());
      CHECK(found.column == expected[i].at("column").get<int>());
      CHECK(found.path == expected[i].at("path").get<std::string>());
      CHECK(found.message.find(expected[i].at("message").get<std::string>()) != std::string::npos);
      CHECK(all_text({found}).find("nlohmann") == std::string::npos);
    }
    REQUIRE_THROWS_AS(parse_protocol(read_text(file), name), InputError);
  }
}

TEST_CASE("the schema refuses every bad file that a schema can judge") {
  const json expectations = json::parse(read_text(corpus_folder() / "expectations.json"));
  std::map<std::string, int> kinds;
  for (const auto& [name, expected] : expectations.items()) {
    CAPTURE(name);
    const std::string verdict = expected.at("schema").get<std::string>();
    ++kinds[verdict];
    const json document = json::parse(read_text(corpus_folder() / "bad" / name), nullptr, false);
    if (verdict == "unreadable") continue;  // the grammar is wrong, or the parser refuses what others tolerate
    REQUIRE_FALSE(document.is_discarded());
    CHECK(schema_accepts(document) == (verdict == "accepts"));
  }
  CHECK(kinds["refuses"] >= 70);
  CHECK(kinds["unreadable"] >= 25);
  CHECK(kinds.size() == 3);
}
