// What people are told and asked, in their language, and what check warns about.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/course/duration.h"
#include "protocols/input/input_error.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/reading/protocol_difference.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/reading/translation.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;
using nlohmann::json;

namespace {

// What people are told and asked around the trials, as the loader reads it; and files that mean harm.

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

// A protocol in the participant's language.

Protocol tutorial() {
  return load_protocol(protocols_folder() / "tutorial.json");
}

Protocol complete() {
  return load_protocol(corpus_folder() / "good/complete.json");
}

TEST_CASE("texts are replaced, and what is logged, planned and identified stays") {
  const Protocol english = tutorial();
  const Protocol german = in_language(english, "de");
  CHECK(german.bytes == english.bytes);
  CHECK(german.sha256 == english.sha256);
  CHECK(german.consent.find("freiwillig") != std::string::npos);
  CHECK(german.instructions[0].text.find("\n") != std::string::npos);
  CHECK(german.instructions[0].id == english.instructions[0].id);
  CHECK(german.timeline.interval_cues[0].say == "Erste Kugel.");
  CHECK(german.breaks[0].say != english.breaks[0].say);
  CHECK(german.questions[0].text == "Händigkeit");
  CHECK(german.questions[0].options == std::vector<std::string>{"right", "left", "both"});
  CHECK(german.questions[0].shown == std::vector<std::string>{"rechts", "links", "beide"});
  CHECK(german.questions[1].low_label == "gar nicht wirksam");
  CHECK(german.questions[1].high_label == "sehr wirksam");
  CHECK(german.checklist[0].text == english.checklist[0].text);  // the operator's, not translated here
  CHECK(make_plan(german, 1, 1).trials == make_plan(english, 1, 1).trials);
  CHECK(left_out_of(english, "de").empty());
}

TEST_CASE("the own language changes nothing; case does not matter; others are refused with a list") {
  const Protocol protocol = complete();
  CHECK(languages_of(protocol) == std::vector<std::string>{"en-GB", "de", "pt-BR"});
  const Protocol same = in_language(protocol, "EN-gb");
  CHECK(same.consent == protocol.consent);
  CHECK(same.questions[1].shown.empty());
  CHECK(in_language(protocol, "PT-br").title == "Um protocolo");
  CHECK(in_language(protocol, "pt-BR").checklist[0].text == "Ruído");
  CHECK_THROWS_WITH(in_language(protocol, "it"), Catch::Contains("\"it\"") && Catch::Contains("en-GB, de, pt-BR"));
  CHECK_THROWS_AS(in_language(protocol, ""), InputError);
}

TEST_CASE("labels of conditions are the participant's where a question shows them") {
  const auto left_out = [](const Protocol& protocol) {
    const std::vector<std::string> missing = left_out_of(protocol, "DE");
    return std::count(missing.begin(), missing.end(), "$.conditions[0].label") == 1;
  };
  Protocol protocol = tutorial();
  protocol.translations.at("de").erase("$.conditions[0].label");
  CHECK(left_out(protocol));  // "How effective was the feedback of this condition?", of each
  CHECK(left_out_text(protocol, "de") == "leaves out 1 text of the participant's: $.conditions[0].label");
  for (Question& question : protocol.questions) question.per_condition = false;
  CHECK_FALSE(left_out(protocol));
  protocol.questions[1].when = Question::When::after_condition;
  CHECK_FALSE(left_out(protocol));  // blinded: it would say what the letter stands for
  protocol.blinded = false;
  CHECK(left_out(protocol));
  CHECK(left_out_of(protocol, "en").empty());
  CHECK(left_out_text(protocol, "it").empty());
}

TEST_CASE("what a translation leaves out stays as it is, and is warned about") {
  const Protocol german = in_language(complete(), "de");
  CHECK(german.questions[1].shown == std::vector<std::string>{"links", "right"});
  CHECK(german.timeline.interval_cues[1].say == "Two.");
  const std::vector<std::string> missing = left_out_of(complete(), "de");
  const auto leaves_out = [&](const std::string& path) {
    return std::find(missing.begin(), missing.end(), path) != missing.end();
  };
  CHECK(leaves_out("$.trial.cues.second.say"));
  CHECK(leaves_out("$.questions[1].options[1]"));
  CHECK(leaves_out("$.instructions[2].text"));
  CHECK_FALSE(leaves_out("$.consent"));
  CHECK_FALSE(leaves_out("$.title"));              // these are not translated:
  CHECK_FALSE(leaves_out("$.checklist[0].text"));  // they are the operator's
  const ProtocolCheck check = check_protocol(complete().bytes, "p.json");
  const auto warned = std::count_if(check.warnings.begin(), check.warnings.end(), [](const Diagnostic& warning) {
    return warning.path == "$.translations.de" && warning.message.find("leaves out") != std::string::npos &&
           warning.message.find("and ") != std::string::npos;
  });
  CHECK(warned == 1);
  for (const Diagnostic& warning : check_protocol(tutorial().bytes, "t.json").warnings)
    CHECK(warning.path.find("translations") == std::string::npos);
}

// What `check` warns about, and how long a session takes.

std::string base() {
  return read_text(corpus_folder() / "good/complete.json");
}

int warnings_with(const std::string& bytes, const std::string& path, const std::string& part) {
  const ProtocolCheck check = check_protocol(bytes, "p.json");
  REQUIRE(check.errors.empty());
  return static_cast<int>(std::count_if(check.warnings.begin(), check.warnings.end(), [&](const Diagnostic& warning) {
    return warning.path == path && warning.message.find(part) != std::string::npos;
  }));
}

TEST_CASE("keys that Caps Lock turns into each other are told") {
  const auto told = [](const std::string& same, const std::string& different) {
    const std::string bytes = replaced(base(), R"("keys": {"same": "s", "different": "d"})",
                                       fmt::format(R"("keys": {{"same": "{}", "different": "{}"}})", same, different));
    return warnings_with(bytes, "$.trial.keys.same", "Caps Lock") +
           warnings_with(bytes, "$.trial.keys.different", "Caps Lock");
  };
  CHECK(told("s", "d") == 0);
  CHECK(told("s", "D") == 0);
  CHECK(told("D", "d") == 1);
  CHECK(told("P", "Q") == 2);  // p pauses, q ends the session
  CHECK(told("1", "2") == 0);
}

TEST_CASE("few trials per class are told until there are ten") {
  CHECK(warnings_with(base(), "$.design.trials_per_cell", "8 trials per cell give about 4") == 1);
  const std::string more = replaced(base(), "\"trials_per_cell\": 8", "\"trials_per_cell\": 20");
  CHECK(warnings_with(more, "$.design.trials_per_cell", "trials per cell give") == 0);
}

TEST_CASE("extreme rates, d' of 0 and scatter of the published design") {
  const std::string bytes = read_text(protocols_folder() / "chinello2017.json");
  // Independent simulations of counts at the published JNDs, criterion at half the difference.
  const std::string path = "$.design.trials_per_cell";
  CHECK(warnings_with(bytes, path, "rate of 0 or 1 in some series is expected for S 65 %, V 56 %, SV 82 %") == 1);
  CHECK(warnings_with(bytes, path, "d' of 0 or less in some series is expected for S 30 %, V 41 %, SV 15 %") == 1);
  CHECK(warnings_with(bytes, path, "coefficient of variation of S 41 %, V 49 %, SV 32 %") == 1);
  const std::string many = replaced(base(), "\"trials_per_cell\": 8", "\"trials_per_cell\": 200");
  CHECK(warnings_with(many, path, "rate of 0 or 1") == 0);
  CHECK(warnings_with(many, path, "d' of 0 or less") == 0);
  CHECK(warnings_with(many, path, "coefficient of variation") == 0);
}

TEST_CASE("letters that follow the file are told") {
  const std::string path = "$.design.order.conditions", part = "the letters of a coded study";
  CHECK(warnings_with(base(), path, part) == 0);
  const std::string fixed =
      replaced(base(), R"("series": "fixed", "conditions": "permuted")", R"("series": "fixed", "conditions": "fixed")");
  CHECK(warnings_with(replaced(fixed, R"("blinding": "open")", R"("blinding": "coded")"), path, part) == 1);
  CHECK(warnings_with(fixed, path, part) == 0);  // open
  CHECK(warnings_with(read_text(corpus_folder() / "good/mixed.json"), path, part) == 0);
}

TEST_CASE("groups that participants do not fill, and groups that tell their conditions, are told") {
  const std::string given = read_text(corpus_folder() / "good/groups.json");
  const std::string path = "$.design.participants", part = "do not fill 3 groups equally";
  const std::string balanced = replaced(given, R"("allotment": "given")", R"("allotment": "balanced")");
  CHECK(warnings_with(balanced, path, part) == 0);
  CHECK(warnings_with(replaced(balanced, "\"participants\": 12", "\"participants\": 13"), path, part) == 1);
  CHECK(warnings_with(replaced(given, "\"participants\": 12", "\"participants\": 13"), path, part) == 0);
  const std::string says = "who says the group knows its conditions";
  CHECK(warnings_with(given, "$.design.allotment", says) == 1);
  CHECK(warnings_with(balanced, "$.design.allotment", says) == 0);
}

TEST_CASE("following the advice about scatter ends the warning") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  const std::string bytes = protocol.bytes;
  const auto of_trials = [&](int trials) {
    return replaced(bytes, "\"trials_per_cell\": 12", "\"trials_per_cell\": " + std::to_string(trials));
  };
  int most = 0;
  for (const Condition& condition : protocol.conditions)
    most = std::max(
        most, trials_for_cv(counts_design(protocol), planned_jnd(protocol, condition.name).value, 0.2).value_or(0));
  CHECK(most == 74);
  CHECK(warnings_with(of_trials(most), "$.design.trials_per_cell", "coefficient of variation") == 0);
  CHECK(warnings_with(of_trials(most - 1), "$.design.trials_per_cell", "coefficient of variation") == 1);
}

TEST_CASE("independent draws, missing practice, uneven cohorts, run limits of one and long sessions are told") {
  const std::string published = read_text(protocols_folder() / "chinello2017.json");
  CHECK(warnings_with(published, "$.design.sampling", "independent draws") == 1);
  CHECK(warnings_with(published, "$.practice", "no practice") == 1);
  CHECK(warnings_with(published, "$.design.participants", "") == 0);
  CHECK(warnings_with(base(), "$.design.sampling", "independent draws") == 0);
  CHECK(warnings_with(base(), "$.practice", "no practice") == 0);

  const std::string uneven = replaced(published, "\"participants\": 18", "\"participants\": 20");
  const ProtocolCheck check = check_protocol(uneven, "p.json");
  const auto found = std::find_if(check.warnings.begin(), check.warnings.end(),
                                  [](const Diagnostic& warning) { return warning.path == "$.design.participants"; });
  REQUIRE(found != check.warnings.end());
  CHECK(found->suggestion == "18 or 24 would");
  CHECK(found->line > 1);

  CHECK(warnings_with(replaced(base(), "\"run_limit\": 4", "\"run_limit\": 1"), "$.design.run_limit", "alternate") ==
        1);
  CHECK(warnings_with(replaced(base(), "\"trials_per_cell\": 8", "\"trials_per_cell\": 200"), "$.design",
                      "a session takes") == 1);
  CHECK(warnings_with(base(), "$.design", "a session takes") == 0);
}

TEST_CASE("expected duration adds up") {
  Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
  // A trial: 2 (0.7 + 3) + 1 + 1.5 + 1 = 10.9 s; 24 of them.
  CHECK(expected_trial_s(protocol) == Approx(10.9));
  CHECK(expected_presented_s(protocol) == Approx(7.4));
  CHECK(expected_duration_s(protocol) == Approx(24 * 10.9));
  protocol.practice = Practice{6, 0, {0}, 0.5, 3, Feedback::none};
  CHECK(expected_duration_s(protocol) == Approx(30 * 10.9));
  protocol.practice.reset();
  using After = Break::After;
  protocol.breaks = {{After::block, 0, 10, ""}};
  CHECK(expected_duration_s(protocol) == Approx(24 * 10.9 + 5 * 10));
  protocol.breaks = {{After::series, 0, 10, ""}};
  CHECK(expected_duration_s(protocol) == Approx(24 * 10.9 + 10));
  protocol.breaks = {{After::trials, 8, 10, ""}};
  CHECK(expected_duration_s(protocol) == Approx(24 * 10.9 + 2 * 10));
  protocol.breaks.clear();
  using When = Question::When;
  const std::vector<std::pair<When, int>> times = {
      {When::before_session, 1}, {When::after_condition, 6}, {When::after_series, 2}, {When::after_session, 1}};
  for (const auto& [when, count] : times) {
    Question question;
    question.when = when;
    protocol.questions = {question};
    CHECK(expected_duration_s(protocol) == Approx(24 * 10.9 + 10 * count));
  }
  protocol.questions[0].per_condition = true;
  CHECK(expected_duration_s(protocol) == Approx(24 * 10.9 + 30));
}

TEST_CASE("shipped protocols take the time that their notes say") {
  CHECK(expected_duration_s(load_protocol(protocols_folder() / "tutorial.json")) < 5 * 60);
  CHECK(expected_duration_s(load_protocol(protocols_folder() / "chinello2017.json")) < 35 * 60);
  CHECK(expected_duration_s(load_protocol(protocols_folder() / "chinello2017-balanced.json")) ==
        Approx(50 * 60).epsilon(0.1));
}

TEST_CASE("other bytes of the same meaning: blanks, order of members, spelling of numbers, the schema's place") {
  const std::string one = R"({"a": 1, "b": [0.5, true, null], "c": "x"})";
  CHECK(difference_of(one, one).same_meaning);
  const ProtocolDifference same =
      difference_of(one, "{\"$schema\": \"s.json\",\n  \"c\": \"\\u0078\",\n  \"b\": [5e-1, true, null], \"a\": 1.0}");
  CHECK(same.same_meaning);
  CHECK(same.lines.empty());
}

TEST_CASE("each difference has its path, the old value and the new one") {
  const ProtocolDifference found =
      difference_of(R"({"a": {"n": 18, "t": "old"}, "list": [1, 2, 3], "gone": {"x": [1]}, "kind": 1, "on": true})",
                    R"({"a": {"n": 24, "t": "new"}, "list": [1, 5], "kind": "1", "on": false, "new key": null})");
  CHECK_FALSE(found.same_meaning);
  CHECK(found.lines == std::vector<std::string>{"$.a.n: 18 -> 24", "$.a.t: \"old\" -> \"new\"", "$.list[1]: 2 -> 5",
                                                "$.list[2]: removed 3", "$.gone: removed {\"x\": [1]}",
                                                "$.kind: 1 -> \"1\"", "$.on: true -> false",
                                                "$[\"new key\"]: added null"});
}

TEST_CASE("named things are compared by their names: one that is inserted in front is one difference") {
  const std::string s = R"({"name": "S", "cues": ["skin"]})", v = R"({"name": "V", "cues": []})";
  const auto lines = [](const std::string& before, const std::string& after) {
    return difference_of(R"({"l": [)" + before + "]}", R"({"l": [)" + after + "]}").lines;
  };
  using Lines = std::vector<std::string>;
  CHECK(lines(s + ", " + v, R"({"name": "N"}, )" + s + ", " + v) == Lines{R"($.l[0]: added {"name": "N"})"});
  CHECK(lines(s + ", " + v, v) == Lines{R"($.l[0]: removed {"name": "S", "cues": ["skin"]})"});
  CHECK(lines(s + ", " + v, R"({"name": "N"}, {"name": "S", "cues": []}, )" + v) ==
        Lines{R"($.l[0].cues[0]: removed "skin")", R"($.l[0]: added {"name": "N"})"});
  // The order is part of the meaning.
  CHECK(lines(s + ", " + v, v + ", " + s) == Lines{R"($.l: the order "S", "V" -> "V", "S")"});
  const ProtocolDifference order = difference_of("[" + s + ", " + v + "]", "[" + v + ", " + s + "]");
  REQUIRE(order.changes.size() == 1);
  CHECK_FALSE(order.same_meaning);
  CHECK(order.changes.front().path == "$");
  CHECK(order.changes.front().after == "[" + v + ", " + s + "]");
  // "id" before "name"; names that stand twice are none.
  CHECK(lines(R"({"id": "a", "name": "x"})", R"({"id": "b", "name": "x"}, {"id": "a", "name": "y"})") ==
        Lines{R"($.l[0].name: "x" -> "y")", R"($.l[0]: added {"id": "b", "name": "x"})"});
  CHECK(lines(s + ", " + s, v + ", " + s + ", " + s) == Lines{R"($.l[0]: added {"name": "V", "cues": []})"});
}

TEST_CASE("lists without names are compared by what they have in common") {
  using Lines = std::vector<std::string>;
  const auto lines = [](const std::string& before, const std::string& after) {
    return difference_of(before, after).lines;
  };
  CHECK(lines("[1, 2, 3, 4]", "[0, 1, 2, 3, 4]") == Lines{"$[0]: added 0"});
  CHECK(lines("[1, 2, 3, 4]", "[1, 2, 2.5, 3, 4]") == Lines{"$[2]: added 2.5"});
  CHECK(lines("[1, 2, 3, 4]", "[1, 3, 4]") == Lines{"$[1]: removed 2"});
  CHECK(lines("[1, 2, 3, 4]", "[2, 3, 9, 4, 5]") == Lines{"$[0]: removed 1", "$[2]: added 9", "$[4]: added 5"});
  CHECK(lines(R"([{"after": 1}, {"after": 2}])", R"([{"after": 3}, {"after": 1}, {"after": 2}])") ==
        Lines{R"($[0]: added {"after": 3})"});
  CHECK(lines(R"([{"after": 1}, {"after": 2, "s": 1}])", R"([{"after": 1}, {"s": 5, "after": 2}])") ==
        Lines{"$[1].s: 1 -> 5"});
  CHECK(lines("[]", "[[1], [1]]") == Lines{"$[0]: added [1]", "$[1]: added [1]"});
  CHECK(lines("[1, 2]", "[2, 1]").size() == 2);
  // Too long for the table of common subsequences: by place.
  std::string one = "[0", other = "[1";
  for (int i = 2; i < 3000; ++i) {
    one += fmt::format(", {}", i);
    other += fmt::format(", {}", -i);
  }
  CHECK(difference_of(one + "]", other + "]").changes.size() == 2999);
}

TEST_CASE("lines are bounded in number and length, and hold no control characters") {
  std::string before = "{", after = "{";
  for (int i = 0; i < 50; ++i) {
    before += (i == 0 ? "" : ", ") + ("\"k" + std::to_string(i)) + "\": 1";
    after += (i == 0 ? "" : ", ") + ("\"k" + std::to_string(i)) + "\": 2";
  }
  const ProtocolDifference many = difference_of(before + "}", after + "}", 5);
  REQUIRE(many.lines.size() == 6);
  CHECK(many.lines[4] == "$.k4: 1 -> 2");
  CHECK(many.lines[5] == "and 45 more");
  CHECK(difference_of(before + "}", after + "}", 50).lines.size() == 50);

  const std::string start(300, 'a');
  const ProtocolDifference longer = difference_of(
      "{\"t\": \"" + start + "b\"}", "{\"t\": \"" + start + "c\", \"l\": [" + start.substr(0, 0) +
                                         "1111111111, 2222222222, 3333333333, 4444444444, 5555555555, 6]}");
  REQUIRE(longer.lines.size() == 2);
  CHECK(longer.lines[0].size() < 120);
  CHECK(longer.lines[0].find("ab\" -> ") != std::string::npos);  // from where they part
  CHECK(longer.lines[1].size() < 90);
  CHECK(longer.lines[1].find("...") != std::string::npos);

  const ProtocolDifference hostile = difference_of(R"({"\u001b[2J": "\u001b]0;x\u0007"})", R"({"a": "\u009b1m"})");
  for (const std::string& line : hostile.lines)
    for (const char c : line) CHECK(static_cast<unsigned char>(c) >= 0x20);
  CHECK_THROWS_AS(difference_of("{", "{}"), InputError);
  CHECK_THROWS_AS(difference_of("{}", "nonsense"), InputError);
}

TEST_CASE("every change has the whole values as JSON, also beyond the lines that are shown") {
  const std::string words(100, 'w');
  const ProtocolDifference found = difference_of(R"({"a": 1.50, "b": {"c": [true, null]}, "t": "x"})",
                                                 R"({"a": 2, "t": ")" + words + R"(\"\n", "d": {"e": [1e3, "f"]}})", 1);
  REQUIRE(found.changes.size() == 4);
  CHECK(found.lines.size() == 2);
  const auto is = [&found](std::size_t i, const std::string& path, const std::string& before,
                           const std::string& after) {
    CHECK(found.changes[i].path == path);
    CHECK(found.changes[i].before == before);
    CHECK(found.changes[i].after == after);
  };
  is(0, "$.a", "1.50", "2");
  is(1, "$.b", R"({"c": [true, null]})", "");
  is(2, "$.t", R"("x")", '"' + words + R"(\"\n")");
  is(3, "$.d", "", R"({"e": [1e3, "f"]})");
}

TEST_CASE("a shipped protocol and a changed copy") {
  const std::string bytes = read_text(protocols_folder() / "tutorial.json");
  const ProtocolDifference found =
      difference_of(bytes, replaced(bytes, "\"trials_per_cell\": 8", "\"trials_per_cell\": 12"));
  CHECK(found.lines == std::vector<std::string>{"$.design.trials_per_cell: 8 -> 12"});
}

}  // namespace
