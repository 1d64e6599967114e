// What people are told and asked around the trials, as the loader reads it; and files that mean harm.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;
using nlohmann::json;

namespace {

json complete_document() {
  return json::parse(read_text(corpus_folder() / "good/complete.json"));
}

// The messages at that path of a changed document.
std::string errors_at(const json& document, const std::string& path) {
  std::string text;
  for (const Diagnostic& error : check_protocol(document.dump(), "p.json").errors)
    if (error.path == path) text += error.message + "\n";
  return text;
}

}  // namespace

TEST_CASE("checklist, pages, language, resume policy and blinding are read") {
  const Protocol protocol = load_protocol(corpus_folder() / "good/complete.json");
  REQUIRE(protocol.checklist.size() == 4);
  CHECK(protocol.checklist[0].kind == Question::Kind::confirm);
  CHECK(protocol.checklist[0].required);
  CHECK(protocol.checklist[0].when == Question::When::before_session);
  CHECK(protocol.checklist[1].kind == Question::Kind::choice);
  CHECK(protocol.checklist[1].options == std::vector<std::string>{"A", "B"});
  CHECK_FALSE(protocol.checklist[1].required);
  CHECK(protocol.checklist[2].kind == Question::Kind::number);
  CHECK(protocol.checklist[2].max == 40);
  CHECK(protocol.checklist[3].kind == Question::Kind::text);
  REQUIRE(protocol.instructions.size() == 3);
  CHECK(protocol.instructions[0].text == "Welcome.\nPlease sit down.");
  CHECK(protocol.instructions[1].when == Instruction::When::before_practice);
  CHECK(protocol.instructions[2].id == "begin");
  CHECK(protocol.consent == "I take part.\n\nI may stop.");
  CHECK(protocol.language == "en-GB");
  CHECK(protocol.translations.size() == 2);
  CHECK(protocol.resume.longest_gap_s == 1800.0);
  CHECK(protocol.resume.practice_after_s == 0.0);
  CHECK(protocol.resume.redo_block);
  CHECK_FALSE(protocol.blinded);
  CHECK(protocol.design.sessions == 2);
  CHECK(protocol.questions[2].group == "QA");
}

TEST_CASE("practice that should come again without being there is warned about") {
  const auto warned = [](const json& document) {
    const ProtocolCheck check = check_protocol(document.dump(), "p.json");
    CHECK(check.errors.empty());
    return std::count_if(check.warnings.begin(), check.warnings.end(),
                         [](const Diagnostic& warning) { return warning.path == "$.resume.practice_after_min"; });
  };
  json document = json::parse(read_text(corpus_folder() / "good/minimal.json"));
  REQUIRE_FALSE(document.contains("practice"));
  CHECK(warned(document) == 0);
  document["resume"] = {{"practice_after_min", 5}};
  CHECK(warned(document) == 1);
  CHECK(warned(complete_document()) == 0);
}

TEST_CASE("a protocol that says nothing of people has today's defaults") {
  const Protocol protocol = load_protocol(corpus_folder() / "good/minimal.json");
  CHECK(protocol.checklist.empty());
  CHECK(protocol.instructions.empty());
  CHECK(protocol.consent.empty());
  CHECK(protocol.language == "en");
  CHECK(protocol.translations.empty());
  CHECK_FALSE(protocol.resume.longest_gap_s);
  CHECK_FALSE(protocol.resume.practice_after_s);
  CHECK_FALSE(protocol.resume.redo_block);
  CHECK(protocol.blinded);
  CHECK(protocol.design.sessions == 1);
  CHECK(protocol.conditions[0].devices);
}

TEST_CASE("pages may have lines, but no other control characters; single lines have none") {
  for (const char* const bad : {"a\tb", "a\rb", "\x1b[2J", "a\x7f",
                                "\xC2\x9B"
                                "1m",
                                "\xE2\x80\xAE"
                                "abc"}) {
    json document = complete_document();
    document["consent"] = bad;
    document["instructions"][1]["text"] = bad;
    json translated = complete_document();
    translated["translations"]["de"]["$.consent"] = bad;
    CHECK(errors_at(document, "$.consent").find("control character U+") != std::string::npos);
    CHECK(errors_at(document, "$.instructions[1].text").find("control character U+") != std::string::npos);
    CHECK(errors_at(translated, "$.translations.de[\"$.consent\"]").find("control character U+") != std::string::npos);
  }
  json document = complete_document();
  document["checklist"][0]["text"] = "two\nlines";
  document["translations"]["de"]["$.trial.cues.first.say"] = "two\nlines";
  CHECK(errors_at(document, "$.checklist[0].text").find("U+000A") != std::string::npos);
  CHECK(errors_at(document, "$.translations.de[\"$.trial.cues.first.say\"]").find("U+000A") != std::string::npos);
  document["consent"] = "\n \n";
  CHECK(errors_at(document, "$.consent") == "is blank\n");
}

TEST_CASE("names of objects and devices cannot leave their folders") {
  json document = json::parse(read_text(corpus_folder() / "good/explore.json"));
  for (const std::string bad : {"../sphere", "a/b", "..", "/etc/passwd", "a\\b", "", "Baseball", "a.json"}) {
    CAPTURE(bad);
    document["explore"]["objects"][0] = bad;
    CHECK(errors_at(document, "$.explore.objects[0]") != "");
  }
  document["explore"]["objects"][0] = std::string("a\0b", 3);
  CHECK(errors_at(document, "$.explore.objects[0]") != "");
  json object = json::parse(read_text(corpus_folder() / "good/object.json"));
  object["rig"]["object"] = "../../etc/passwd";
  CHECK(errors_at(object, "$.rig.object").find("cannot be the name of an object") != std::string::npos);
  object["rig"]["device"] = "../rrs3";
  CHECK(errors_at(object, "$.rig.device").find("is not known") != std::string::npos);
}

TEST_CASE("files out of all proportion are refused at their place, quickly") {
  const auto first_error = [](const std::string& bytes) {
    const ProtocolCheck check = check_protocol(bytes, "p.json");
    REQUIRE_FALSE(check.errors.empty());
    return to_text(check.errors.front());
  };
  const auto repeated = [](const std::string& part, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += part;
    return text;
  };
  CHECK(first_error("{\"" + std::string(257, 'k') + "\": 1}").find("a key of 257 bytes") != std::string::npos);
  CHECK(first_error("[" + repeated("1,", 20000) + "1]").find("more than 20000 values") != std::string::npos);
  std::string members;
  for (int i = 0; i < 2001; ++i) members += fmt::format("{}\"k{}\": 1", i == 0 ? "" : ", ", i);
  CHECK(first_error("{" + members + "}").find("more than 2000 members") != std::string::npos);

  // Each bound nearly reached, with errors whose suggestions look for the nearest of many words.
  json document = complete_document();
  for (int i = 0; i < 1900; ++i) document["translations"]["de"][fmt::format("$.questionz[{}].text", i)] = "x";
  for (int i = 0; i < 190; ++i)
    document["assumed"].push_back({{"path", fmt::format("$.trail.gap_{}", i)}, {"why", "x"}});
  document["more"] = json::array();
  for (int i = 0; i < 12000; ++i) document["more"].push_back(i);
  CHECK(check_protocol(document.dump(), "p.json").errors.size() > 2000);
}

TEST_CASE("messages show what a hostile file says without obeying it") {
  json document = complete_document();
  document["\x1b]0;owned\x07"] = 1;
  document["rig"]["device"] = "\x1b[31mred\xE2\x80\xAE";
  document["questions"][0]["id"] = "a\x1b[0m";
  document["translations"]["de"]["\x1b[2J"] = "x";
  document["assumed"][0]["path"] = "\x9b";
  for (const Diagnostic& error :
       check_protocol(document.dump(-1, ' ', false, json::error_handler_t::replace), "p").errors) {
    const std::string text = to_text(error);
    CAPTURE(text);
    CHECK(std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
    CHECK(text.find("\xE2\x80\xAE") == std::string::npos);
  }
}
