// Power of registered tests between groups of participants.
#include <cmath>

#include "protocols/input/resources.h"
#include "protocols/planning/allotment.h"
#include "protocols/reading/protocol_json.h"
#include "runner/power/power_study.h"
#include "runner/power/power_text.h"
#include "tests/catch.h"
#include "tests/runner/power/power_fixture.h"
#include "tests/temporary_folder.h"

using namespace jnd;

namespace {

// The published design in two groups.
Protocol in_groups(BetweenTest between) {
  Protocol protocol = load_protocol(find_resource(Resource::protocol, "chinello2017-balanced"));
  protocol.groups = {{"patients", "patients", {0, 1, 2}}, {"controls", "controls", {0, 1, 2}}};
  protocol.analysis.tests.between = between;
  return protocol;
}

PowerQuestion asked_of(const Protocol& protocol, double factor) {
  PowerQuestion question = testing::registered_question(protocol);
  question.participants = {16};
  question.trials = {24};
  question.effects = {0, 1};
  question.group_factors = {std::vector<double>(3, factor), std::vector<double>(3, 1)};
  question.analyses = {PowerAnalysis::registered, PowerAnalysis::median, PowerAnalysis::log_ml};
  question.studies = 100;
  return question;
}

std::vector<ContrastSummary> group_rows(const Protocol& protocol, const PowerQuestion& question) {
  const PowerResult result{protocol, question, power_study(protocol, question, {0, question.studies}, 2)};
  std::vector<ContrastSummary> rows = contrast_summaries(result);
  std::erase_if(rows, [&](const ContrastSummary& row) { return row.contrast < question.contrasts.size(); });
  return rows;
}

}  // namespace

TEST_CASE("a difference between groups is found where there is one", "[power][groups]") {
  for (const BetweenTest between : {BetweenTest::welch, BetweenTest::mann_whitney}) {
    const Protocol protocol = in_groups(between);
    const PowerQuestion question = asked_of(protocol, 1.7);
    REQUIRE(question.group_tests.size() == 1);
    const std::vector<ContrastSummary> rows = group_rows(protocol, question);
    REQUIRE(rows.size() == 6);
    for (std::size_t a = 0; a < 3; ++a) {
      const ContrastSummary &none = rows[a], &some = rows[3 + a];
      CHECK(none.ratio == Approx(1));
      CHECK(some.ratio == Approx(1.7));
      CHECK(none.untested.value == 0);
      // At most 4.5 standard errors above 5 % false findings.
      CHECK(none.power.value < 0.05 + 4.5 * std::sqrt(0.05 * 0.95 / question.studies));
      CHECK(some.power.value > 0.6);
      if (some.analysis != PowerAnalysis::log_ml) continue;
      CHECK(std::abs(none.estimate.bias.value) < 5 * none.estimate.bias.error);
      CHECK(std::abs(some.estimate.bias.value) < 5 * some.estimate.bias.error + 0.02);
      CHECK(some.estimate.truth == Approx(std::log(1.7)));
      CHECK(some.estimate.coverage.value > 0.85);
    }
  }
}

TEST_CASE("the mean of a registered difference between groups is that of the enumeration", "[power][groups]") {
  const Protocol protocol = in_groups(BetweenTest::welch);
  PowerQuestion question = asked_of(protocol, 1.5);
  question.effects = {1};
  question.analyses = {PowerAnalysis::registered};
  question.people = {.between_cv = 0, .interaction_cv = 0, .criterion = 0.6, .criterion_sd = 0};
  question.studies = 600;
  // A person's value is the mean of their least-squares slopes, which are linear in d'.
  Protocol designed = protocol;
  designed.design.trials_per_cell = 24;
  const auto mean_of_group = [&](double factor) {
    // JNDs of an effect of 1 are the planned ones.
    double mean = 0;
    for (const double planned : question.jnds)
      mean += testing::enumerated_slope(designed, question.people.criterion, factor * planned) /
              static_cast<double>(question.jnds.size());
    return mean;
  };
  const ContrastSummary row = group_rows(protocol, question).front();
  const double exact = mean_of_group(1.5) - mean_of_group(1);
  CHECK(exact < 0);
  CHECK(std::abs(row.estimate.truth + row.estimate.bias.value - exact) < 5 * row.estimate.bias.error);
  CHECK(row.estimate.bias.error < 0.05 * std::abs(exact));  // else the check above could not fail
}

TEST_CASE("an analysis of variance tells groups, and what differs between their conditions", "[power][groups]") {
  const Protocol protocol = in_groups(BetweenTest::mixed_anova);
  PowerQuestion question = asked_of(protocol, 1);
  question.group_factors = {{2.2, 1, 1}, {1, 1, 1}};
  question.effects = {1};
  question.analyses = {PowerAnalysis::registered, PowerAnalysis::log_ml, PowerAnalysis::median,
                       PowerAnalysis::hierarchical};
  question.studies = 24;
  const std::vector<ContrastSummary> rows = group_rows(protocol, question);
  REQUIRE(rows.size() == 8);
  for (const ContrastSummary& row : rows) {
    const bool interaction = row.contrast == question.contrasts.size() + 1;
    const bool offered = row.analysis == PowerAnalysis::registered || row.analysis == PowerAnalysis::log_ml;
    CHECK(std::isnan(row.power.value) != offered);
    CHECK(std::isnan(row.estimate.undefined.value));  // an effect of several groups has no one number
    if (offered && interaction) CHECK(row.power.value > 0.5);
    if (offered) CHECK(row.untested.value == 0);
  }
  const PowerResult result{protocol, question, power_study(protocol, question, {0, 4}, 1)};
  CHECK_THAT(power_text(result), Catch::Contains("groups x conditions"));
  CHECK_THAT(power_text(result), Catch::Contains("hierarchical has no test of groups"));
  CHECK_THAT(power_text(result), Catch::Contains("times 2.2 in patients/S"));
  CHECK((power_text(result) + power_json(result).dump() + power_csv(result)).find("nan") == std::string::npos);
}

TEST_CASE("groups that get different conditions, in shards", "[power][groups][shards]") {
  Protocol protocol = in_groups(BetweenTest::welch);
  protocol.groups[0].conditions = {0, 1};
  protocol.groups[1].conditions = {0, 1, 2};
  PowerQuestion question = asked_of(protocol, 1.4);
  question.analyses.push_back(PowerAnalysis::hierarchical);
  question.studies = 6;
  question.people.drop_out = 0.2;
  // Half of the participants are of each group, and leave what their group gets.
  const std::vector<DrawnPerson> people = people_source(protocol, question, 1)->people(2, 16);
  std::array<int, 2> sizes{};
  for (const DrawnPerson& person : people) {
    ++sizes[static_cast<std::size_t>(person.group.value())];
    if (!person.dropped) CHECK(person.estimates.size() == conditions_of(protocol, person.group).size());
  }
  CHECK(sizes == std::array<int, 2>{8, 8});
  const auto everything = [](const PowerResult& result) {
    return power_text(result) + power_json(result).dump() + power_csv(result) + ademp_text(result);
  };
  const PowerTally whole = power_study(protocol, question, {0, 6}, 2);
  PowerTally parts = power_study(protocol, question, {4, 6}, 1);
  parts += power_study(protocol, question, {0, 4}, 1);
  CHECK(everything({protocol, question, parts}) == everything({protocol, question, whole}));
  // As a file has it.
  CHECK(to_json(power_question_from(to_json(question))) == to_json(question));
  CHECK(to_json(power_tally_from(to_json(whole), question)) == to_json(whole));
  for (const ContrastSummary& row : contrast_summaries({protocol, question, whole}))
    if (row.contrast < question.contrasts.size()) CHECK(row.untested.value == 0);
}
