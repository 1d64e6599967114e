// What `check` warns about, and how long a session takes.
#include <algorithm>

#include <fmt/format.h>

#include "protocols/course/duration.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

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

}  // namespace

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
