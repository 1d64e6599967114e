// Cues together against an optimal combination of them: against numbers computed by hand.
#include "data/results/cue_combination.h"

#include <cmath>
#include <utility>

#include "tests/catch.h"

namespace jnd {
namespace {

Protocol with_cues(const std::vector<Cues>& cues) {
  Protocol protocol;
  for (const Cues& one : cues) {
    Condition condition;
    condition.cues = one;
    protocol.conditions.push_back(condition);
  }
  return protocol;
}

TaskEstimateRow row(const std::string& participant, int condition, std::optional<double> jnd) {
  TaskEstimateRow result;
  result.participant = participant;
  result.condition = condition;
  result.estimates.values = {{.value = jnd}};
  return result;
}

TaskResults results(std::vector<TaskEstimateRow> rows = {}) {
  TaskResults all;
  all.outcomes = {{.key = "jnd", .title = "JND"}};
  all.estimates = std::move(rows);
  return all;
}

constexpr Cues kS{.force = true}, kV{.vibration = true}, kSV{.force = true, .vibration = true};

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-12 * std::abs(b);
}

TEST_CASE("JNDs of independent cues combine as a right angle's height") {
  CHECK(near(optimal_jnd(300, 400), 240));  // 1/300^2 + 1/400^2 = 1/240^2
  CHECK(near(optimal_jnd(200, 200), 200 / std::sqrt(2.0)));
  CHECK(near(optimal_jnd(1e-200, 1), 1e-200));
  CHECK(near(optimal_jnd(1e150, 1e150), 1e150 / std::sqrt(2.0)));
}

TEST_CASE("each participant's JND of both cues stands beside the combination of theirs alone") {
  const TaskResults jnds =
      results({row("P01", 0, 300), row("P01", 1, 400), row("P01", 2, 240), row("P02", 0, 300), row("P02", 1, 400),
               row("P02", 2, 480), row("P03", 0, 300), row("P03", 1, std::nullopt), row("P03", 2, 250),
               row("P04", 0, 300), row("P04", 1, 400), row("P04", 2, std::nullopt)});
  const std::vector<CueCombination> found = cue_combinations(jnds, with_cues({kS, kV, kSV}));
  REQUIRE(found.size() == 1);
  CHECK(found[0].a == 0);
  CHECK(found[0].b == 1);
  CHECK(found[0].both == 2);
  REQUIRE(found[0].participants.size() == 4);
  CHECK(near(*found[0].participants[0].predicted, 240));
  CHECK(near(*found[0].participants[1].observed, 480));
  CHECK_FALSE(found[0].participants[2].predicted.has_value());
  CHECK(found[0].participants[2].observed.has_value());
  CHECK_FALSE(found[0].participants[3].observed.has_value());
  // ln 1 and ln 2: mean .34657, sd .49013, t(1) = 12.7062.
  CHECK(found[0].log_ratio.n == 2);
  CHECK(std::abs(found[0].log_ratio.mean - 0.346574) < 1e-6);
  CHECK(std::abs(found[0].log_ratio.ci_high - (0.346574 + 12.706205 * 0.490129 / std::sqrt(2.0))) < 1e-4);
}

TEST_CASE("only conditions whose cues are those of two others together are combined") {
  CHECK(cue_combinations(results(), with_cues({kS, kV})).empty());
  CHECK(cue_combinations(results(), with_cues({kS, kSV, kSV})).empty());  // they share force
  CHECK(cue_combinations(results(), with_cues({Cues{}, kS, kS})).empty());
  CHECK(cue_combinations(results(), with_cues({kSV, kS, kV})).size() == 1);
  CHECK(cue_combinations(results(), with_cues({kS, kV, kSV, kSV})).size() == 2);
  CHECK(cue_combinations(results(),
                         with_cues({{.force = true}, {.kinaesthetic = true}, {.force = true, .kinaesthetic = true}}))
            .size() == 1);
}

}  // namespace
}  // namespace jnd
