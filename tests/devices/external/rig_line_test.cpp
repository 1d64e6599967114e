// Lines of an external rig: what is a message, and why others are none.
#include "devices/external/rig_line.h"

#include "tests/catch.h"

using namespace jnd;

namespace {

const std::string kHello =
    R"({"type":"hello","protocol":1,"name":"Rig","version":"2","serial":"7","model":false,"answers":true,)"
    R"("quantities":[{"name":"stiffness","unit":"N/m","min":100,"max":900}],)"
    R"("parameters":[{"name":"delay_ms","unit":"ms","min":0,"max":50},{"name":"hand","words":["left","right"]}],)"
    R"("measures":[{"name":"force","unit":"N"}]})";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

std::string refusal_of(std::string_view line) {
  const ReadRigLine read = read_rig_line(line);
  CHECK_FALSE(read.message);
  for (const char letter : read.refused) CHECK((letter >= ' ' && letter <= '~'));
  return read.refused;
}

bool is_refused_for(std::string_view line, std::string_view part) {
  const std::string why = refusal_of(line);
  INFO(why);
  const bool found = why.find(part) != std::string::npos;
  CHECK(found);
  return found;
}

}  // namespace

TEST_CASE("hello says what a rig is and can") {
  const ReadRigLine read = read_rig_line(kHello);
  INFO(read.refused);
  REQUIRE(read.message);
  const auto& hello = std::get<RigHello>(*read.message);
  CHECK(hello.name == "Rig");
  CHECK_FALSE(hello.model);
  CHECK(hello.answers);
  REQUIRE(hello.quantities.size() == 1);
  CHECK(hello.quantities.front().max == 900);
  REQUIRE(hello.parameters.size() == 2);
  CHECK(std::get<RigRange>(hello.parameters[0]).name == "delay_ms");
  CHECK(std::get<RigChoice>(hello.parameters[1]).words == std::vector<std::string>{"left", "right"});
  REQUIRE(hello.measures.size() == 1);
}

TEST_CASE("a hello that contradicts itself is refused with the place") {
  CHECK(is_refused_for(with(kHello, "\"protocol\":1", "\"protocol\":2"), "$.protocol"));
  CHECK(is_refused_for(with(kHello, "\"max\":900", "\"max\":9"), "below min"));
  CHECK(is_refused_for(with(kHello, "\"max\":900", "\"max\":NaN"), ""));
  CHECK(is_refused_for(with(kHello, "\"max\":900", "\"max\":1e999"), ""));
  CHECK(is_refused_for(with(kHello, "\"max\":900", "\"max\":1e300"), "$.quantities[0].max"));
  CHECK(is_refused_for(with(kHello, "\"right\"", "\"left\""), "twice"));
  CHECK(is_refused_for(with(kHello, "\"hand\"", "\"delay_ms\""), "twice"));
  CHECK(is_refused_for(with(kHello, "\"hand\"", "\"two hands\""), "no name"));
  CHECK(is_refused_for(with(kHello, "\"model\":false,", ""), "$.model"));
  CHECK(is_refused_for(with(kHello, "\"name\":\"Rig\"", "\"name\":\"\\u001b[2J\""), "$.name"));
  CHECK(is_refused_for(with(kHello, "\"serial\"", "\"serail\""), "serail"));
}

TEST_CASE("every kind of message is read") {
  CHECK(std::get<RigReady>(*read_rig_line(R"({"type":"ready","id":3})").message).id == 3);
  CHECK(std::get<RigContact>(*read_rig_line(R"({"type":"contact","id":3,"time_s":0.25})").message).time_s == 0.25);
  const auto read = read_rig_line(
      R"({"type":"done","id":3,"outcome":"complete","delivered":512.5,"first_contact_s":0.2,"duration_s":3.2,)"
      R"("contacts":4,"peaks":{"force":2.5},"channels":{"grip":1}})"
      "\r");
  INFO(read.refused);
  REQUIRE(read.message);
  const auto& done = std::get<RigDone>(*read.message);
  CHECK(done.outcome == RigOutcome::complete);
  CHECK(done.delivered == 512.5);
  CHECK(done.contacts == 4);
  CHECK(done.peaks == NamedNumbers{{"force", 2.5}});
  CHECK(done.channels == NamedNumbers{{"grip", 1}});
  CHECK_FALSE(std::get<RigTelemetry>(*read_rig_line(R"({"type":"telemetry","time_s":1,"values":{}})").message).id);
  CHECK(std::get<RigAnswer>(*read_rig_line(R"({"type":"answer","id":9,"answer":"first"})").message).answer == "first");
  CHECK(std::get<RigFault>(*read_rig_line(R"({"type":"fault","cause":"hot"})").message).cause == "hot");
  CHECK(std::get<RigAlive>(*read_rig_line(R"({"type":"alive","n":12})").message).n == 12);
}

TEST_CASE("lines that are no message are refused, and say why") {
  CHECK(is_refused_for("", ""));
  CHECK(is_refused_for("ready", ""));
  CHECK(is_refused_for("[]", ""));
  CHECK(is_refused_for("{}", "$.type"));
  CHECK(is_refused_for(R"({"type":"steady"})", "steady"));
  CHECK(is_refused_for(R"({"type":"ready"})", "$.id"));
  CHECK(is_refused_for(R"({"type":"ready","id":0})", "$.id"));
  CHECK(is_refused_for(R"({"type":"ready","id":1.5})", "whole"));
  CHECK(is_refused_for(R"({"type":"ready","id":-1})", "$.id"));
  CHECK(is_refused_for(R"({"type":"ready","id":1e30})", "$.id"));
  CHECK(is_refused_for(R"({"type":"ready","id":"1"})", "$.id"));
  CHECK(is_refused_for(R"({"type":"ready","id":1,"id":2})", "twice"));
  CHECK(is_refused_for(R"({"type":"ready","id":1,"more":2})", "more"));
  CHECK(is_refused_for(R"({"type":"contact","id":1,"time_s":-1})", "$.time_s"));
  CHECK(is_refused_for("{\"type\":\"fault\",\"cause\":\"\xff\"}", "UTF-8"));
  CHECK(is_refused_for(R"({"type":"fault","cause":"\u0007"})", "$.cause"));
  CHECK(is_refused_for(std::string(kLongestRigLine + 1, ' '), "longer"));
  CHECK(is_refused_for(std::string(1000, '['), ""));
  CHECK(is_refused_for(R"({"type":"telemetry","time_s":1,"values":{"force":1,"force":2}})", "twice"));
  CHECK(is_refused_for(R"({"type":"telemetry","time_s":1,"values":{"a b":1}})", "no name"));
  CHECK(is_refused_for(R"({"type":"telemetry","time_s":1,"values":{"force":null}})", "$.values.force"));
}

TEST_CASE("a done that contradicts itself is refused, and known to be one") {
  const ReadRigLine early =
      read_rig_line(R"({"type":"done","id":1,"outcome":"complete","first_contact_s":2,"duration_s":1,"contacts":1})");
  CHECK_FALSE(early.message);
  CHECK(early.type == "done");
  CHECK(is_refused_for(R"({"type":"done","id":1,"outcome":"complete","duration_s":1,"contacts":1})", "contradict"));
  CHECK(is_refused_for(
      R"({"type":"done","id":1,"outcome":"no_contact","first_contact_s":0.5,"duration_s":1,"contacts":1})",
      "no_contact"));
  CHECK(is_refused_for(R"({"type":"done","id":1,"outcome":"fine","duration_s":1,"contacts":0})", "$.outcome"));
}
