// devices/external/external.schema.json against what the program says, what it reads, and the page's transcript.
// GCC 12 with sanitizers finds fault with its own <regex>, which the validator uses.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "devices/external/rig_exchange.h"
#include "devices/external/rig_line.h"
#include "tests/catch.h"

using namespace jnd;

namespace {

std::string page_text(const std::string& name) {
  std::ifstream file(std::string(JND_SOURCE_DIR) + "/devices/external/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// One side of the schema: "from_program" or "from_rig".
class SideSchema {
 public:
  explicit SideSchema(const std::string& side) {
    document_ = nlohmann::json::parse(page_text("external.schema.json"));
    document_.erase("oneOf");
    document_["allOf"] = {{{"$ref", "#/definitions/" + side}}};
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    const valijson::adapters::NlohmannJsonAdapter adapter(document_);
    parser.populateSchema(adapter, schema_);
  }
  bool accepts(const std::string& line) {
    const nlohmann::json message = nlohmann::json::parse(line, nullptr, false);
    if (message.is_discarded()) return false;
    valijson::Validator validator;
    const valijson::adapters::NlohmannJsonAdapter adapter(message);
    return validator.validate(schema_, adapter, nullptr);
  }

 private:
  nlohmann::json document_;
  valijson::Schema schema_;
};

// The lines of the page's transcript, with their side in front.
std::vector<std::string> transcript() {
  std::istringstream page(page_text("PROTOCOL.md"));
  std::vector<std::string> lines;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("```")) inside = line == "```jsonl";
    if (inside && (line.starts_with("> ") || line.starts_with("< "))) lines.push_back(line);
  }
  return lines;
}

}  // namespace

TEST_CASE("every line that the program says is the schema's") {
  SideSchema program("from_program");
  RenderRequest request;
  request.quantity = "viscosity";
  request.unit = "N s/m";
  request.value = 4.5;
  request.parameters = {{"gain", 0.25}, {"hand", std::string("left")}};
  request.exploration.duration_s = 3;
  CHECK(program.accepts(hello_line("0.1.0")));
  CHECK(program.accepts(prepare_line(1, request)));
  CHECK(program.accepts(present_line(1, request)));
  request.exploration.from_contact = false;
  request.exploration.no_contact_s = 5;
  request.exploration.pace_hz = 1.5;
  request.exploration.limits = {{"peak_force", {1, 4}}};
  request.beside = 5;
  request.beside_parameters = {{"gain", 0.5}};
  CHECK(program.accepts(present_line(2, request)));
  for (const auto& [word, ends] : kRigExplorationEndWords) {
    request.exploration.ends = ends;
    request.exploration.contacts = 3;
    CHECK(program.accepts(present_line(3, request)));
  }
  CHECK(program.accepts(ask_line(4, {"first", "second"})));
  for (const auto& [word, reason] : kRigStopWords) {
    CHECK(program.accepts(stop_line(0, reason)));
    CHECK(program.accepts(stop_line(5, reason)));
  }
  CHECK(program.accepts(alive_line(6)));
  CHECK(program.accepts(bye_line()));
}

TEST_CASE("the schema and the reader agree about what a rig may say") {
  SideSchema rig("from_rig");
  const std::vector<std::string> good = {
      R"({"type":"hello","protocol":1,"name":"Rig","version":"2","serial":"7","model":false,"answers":true,"quantities":[{"name":"a","unit":"N","min":1,"max":1}],"parameters":[{"name":"b","words":["x"]}],"measures":[]})",
      R"({"type":"hello","protocol":1,"name":"Rig","version":"2","serial":"7","model":false,"answers":true,"ready_s":0.4,"holds":false,"token":"x","quantities":[{"name":"a","unit":"N","min":1,"max":1}],"parameters":[],"measures":[]})",
      R"({"type":"ready","id":3})",
      R"({"type":"contact","id":3,"time_s":0.25})",
      R"({"type":"done","id":3,"outcome":"stopped","duration_s":3.2,"contacts":0})",
      R"({"type":"done","id":3,"outcome":"complete","delivered":-5,"first_contact_s":0.2,"duration_s":3.2,"contacts":4,"peaks":{"f":2.5},"channels":{}})",
      R"({"type":"telemetry","id":1,"time_s":1,"values":{"force":1}})",
      R"({"type":"answer","id":9,"answer":"first","after_s":0.5})",
      R"({"type":"fault","id":2,"cause":"hot"})",
      R"({"type":"alive","n":0})"};
  for (const std::string& line : good) {
    INFO(line);
    CHECK(rig.accepts(line));
    CHECK(read_rig_line(line).message);
  }
  const std::vector<std::string> bad = {
      R"([])",
      R"({"type":"steady"})",
      R"({"type":"ready"})",
      R"({"type":"ready","id":0})",
      R"({"type":"ready","id":1.5})",
      R"({"type":"ready","id":"1"})",
      R"({"type":"ready","id":1,"more":2})",
      R"({"type":"contact","id":1,"time_s":-1})",
      R"({"type":"contact","id":1,"time_s":1e300})",
      R"({"type":"fault","cause":""})",
      R"({"type":"hello","protocol":1,"name":"Rig","version":"2","serial":"7","model":false,"answers":true,"ready_s":-1,"quantities":[{"name":"a","unit":"N","min":1,"max":1}],"parameters":[],"measures":[]})",
      R"({"type":"hello","protocol":1,"name":"Rig","version":"2","serial":"7","model":false,"answers":true,"holds":"yes","quantities":[{"name":"a","unit":"N","min":1,"max":1}],"parameters":[],"measures":[]})",
      R"({"type":"done","id":1,"outcome":"fine","duration_s":1,"contacts":0})",
      R"({"type":"done","id":1,"outcome":"complete","duration_s":1,"contacts":-1})",
      R"({"type":"telemetry","time_s":1,"values":{"a b":1}})",
      R"({"type":"telemetry","time_s":1,"values":{"force":"1"}})",
      R"({"type":"hello","protocol":2,"name":"R","version":"2","serial":"7","model":false,"answers":true,"quantities":[{"name":"a","unit":"N","min":1,"max":1}],"parameters":[],"measures":[]})",
      R"({"type":"hello","protocol":1,"name":"R","version":"2","serial":"7","model":false,"answers":true,"quantities":[],"parameters":[],"measures":[]})"};
  for (const std::string& line : bad) {
    INFO(line);
    CHECK_FALSE(rig.accepts(line));
    CHECK_FALSE(read_rig_line(line).message);
  }
}

TEST_CASE("the page's transcript is the protocol") {
  SideSchema program("from_program"), rig("from_rig");
  const std::vector<std::string> lines = transcript();
  REQUIRE(lines.size() >= 10);
  // What the rig says there makes a conversation without a refusal.
  RigExchange exchange("0.1.0", {});
  std::int64_t now_ns = 1;
  exchange.begin(now_ns);
  exchange.hear(lines.at(1).substr(2), now_ns);
  CHECK(exchange.idle());
  for (const std::string& line : lines) {
    INFO(line);
    const std::string message = line.substr(2);
    CHECK((line.front() == '>' ? program : rig).accepts(message));
    if (line.front() == '<') CHECK(read_rig_line(message).message);
  }
}
