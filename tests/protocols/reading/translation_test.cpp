// A protocol in the participant's language.
#include "protocols/reading/translation.h"

#include <algorithm>

#include "protocols/input/input_error.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

Protocol tutorial() {
  return load_protocol(protocols_folder() / "tutorial.json");
}

Protocol complete() {
  return load_protocol(corpus_folder() / "good/complete.json");
}

}  // namespace

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
