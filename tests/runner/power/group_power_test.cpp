// Power between groups, and people who go through the simulated rig.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "data/results/study_results.h"
#include "protocols/input/resources.h"
#include "protocols/planning/allotment.h"
#include "protocols/reading/protocol_json.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "runner/power/drawn_people.h"
#include "runner/power/exact_sum.h"
#include "runner/power/power_study.h"
#include "runner/power/power_text.h"
#include "runner/session/simulate.h"
#include "tests/catch.h"
#include "tests/runner/power/power_fixture.h"
#include "tests/runner/rigged_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

// Power of registered tests between groups of participants.

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

// Participants of simulated studies who go through the simulated rig: they leave what jnd analyze makes of the same
// sessions, and answer as the response model of their profile says.

PowerQuestion rigged(const Protocol& protocol, int participants) {
  PowerQuestion question;
  question.participants = {participants};
  if (!protocol.design.procedure) question.trials = {protocol.design.trials_per_cell};
  question.effects = {1};
  question.jnds.assign(protocol.conditions.size(), 200);
  for (const Contrast& contrast : protocol.analysis.contrasts) question.contrasts.push_back({contrast.a, contrast.b});
  question.analyses = {PowerAnalysis::registered};
  question.studies = 2;
  question.profile = "chinello2017";
  return question;
}

std::string words(const TaskEstimates& estimates) {
  std::string all = estimates.status;
  for (const TaskEstimate& one : estimates.values) all += fmt::format(" {}", one.value.value_or(-1e300));
  return all;
}

// By participant and condition.
std::vector<std::string> left_by(const std::vector<DrawnPerson>& people) {
  std::vector<std::string> all;
  for (const DrawnPerson& person : people)
    for (const TaskEstimateRow& row : person.estimates) all.push_back(words(row.estimates));
  return all;
}

// The same of a study in a file, by what jnd analyze computes of it.
std::vector<std::string> left_in_study(const Protocol& protocol, std::uint64_t seed, int participants) {
  const TemporaryFolder folder;
  const auto study =
      Study::create(folder.path() / "s.sqlite", protocol.name, protocol.bytes, seed, {simulated_epoch_ns(1), 0});
  const RigDescription rig = rig_of(protocol);
  const ParticipantProfile profile = load_profile(find_resource(Resource::profile, "chinello2017"));
  Simulation simulation{protocol, rig, profile};
  simulation.participants = participants;
  simulation.seed = seed;
  simulation.record = RecordPolicy::off;
  REQUIRE(simulate_study(simulation, *study).completed == participants);
  const StudyResults results = results_of(*study, protocol, SessionKind::simulated);
  std::vector<std::string> all;
  for (const TaskEstimateRow& row : results.task.estimates) all.push_back(words(row.estimates));
  return all;
}

TEST_CASE("what participants leave through the rig is what jnd analyze makes of the same sessions", "[power][rig]") {
  const std::vector<Protocol> protocols = {
      testing::few_trials(TaskKind::same_different, 4), testing::short_staircases(TaskKind::same_different),
      testing::few_trials(TaskKind::which, 2), testing::short_staircases(TaskKind::which),
      testing::few_trials(TaskKind::yes_no, 8), testing::short_staircases(TaskKind::yes_no),
      // Every answer of the profile takes longer than that: nothing is left to analyse.
      testing::of_task(
          TaskKind::same_different, "constant",
          {{"design", {{"trials_per_cell", 4}}}, {"analysis", {{"exclude", {{"response_time_above_s", 0.001}}}}}})};
  constexpr int kPeople = 2;
  for (const Protocol& protocol : protocols) {
    CAPTURE(to_string(protocol.task.kind), protocol.design.procedure.has_value());
    const PowerQuestion question = rigged(protocol, kPeople);
    const std::vector<DrawnPerson> people = people_source(protocol, question, 1)->people(1, kPeople);
    CHECK(left_by(people) == left_in_study(protocol, seed_of_study(question.seed, 1), kPeople));
    CHECK(left_by(people).size() == kPeople * protocol.conditions.size());
    // More people are the same people first.
    CHECK(left_by(people_source(protocol, question, 1)->people(1, 1)).front() == left_by(people).front());
  }
}

TEST_CASE("answers through the rig are as likely as the response model of the profile says", "[power][rig][long]") {
  struct Case {
    Protocol protocol;
    double of_noise;   // s of the model for a noise of 1 of the difference of two intervals
    double criterion;  // N/m; of choices none
  };
  // Who judges one interval has the noise of one alone, and compares with the middle between the two.
  const std::vector<Case> cases = {{testing::few_trials(TaskKind::same_different, 20), 1, 150},
                                   {testing::short_staircases(TaskKind::same_different), 1, 150},
                                   {testing::few_trials(TaskKind::which, 8), 1, 0},
                                   {testing::short_staircases(TaskKind::which), 1, 0},
                                   {testing::few_trials(TaskKind::yes_no, 40), std::sqrt(0.5), 90}};
  const std::vector<double> noise = {283.5, 351.0};  // of force, of vibration
  for (const Case& one : cases) {
    CAPTURE(to_string(one.protocol.task.kind), one.protocol.design.procedure.has_value());
    const ResponseModel model = response_model_of(one.protocol).value();
    // At this study's standard, noise and criterion are the same fractions of it as where they were measured.
    const double scale = one.protocol.stimulus.reference / 900;
    std::vector<double> said(2), expected(2), variance(2);
    const auto source = people_source(one.protocol, rigged(one.protocol, 4), 1);
    for (std::uint64_t study = 0; study < 3; ++study)
      for (const DrawnPerson& person : source->people(study, 4))
        for (const HierarchicalCell& cell : person.answers) {
          const auto c = static_cast<std::size_t>(cell.condition);
          const double s = scale * one.of_noise * noise[c];
          const double criterion = one.protocol.task.kind == TaskKind::yes_no ? one.criterion : scale * one.criterion;
          const double p = std::exp(log_rates(model, cell.level, std::log(s), criterion / s, 0).positive);
          const double n = cell.positive + cell.negative;
          said[c] += cell.positive;
          expected[c] += n * p;
          variance[c] += n * p * (1 - p);
        }
    for (std::size_t c = 0; c < 2; ++c) {
      CAPTURE(c, said[c], expected[c], std::sqrt(variance[c]));
      CHECK(variance[c] > 10);
      CHECK(std::abs(said[c] - expected[c]) < 4.5 * std::sqrt(variance[c]));
    }
  }
}

TEST_CASE("shards of studies through the rig add up to the same bytes", "[power][rig][shards]") {
  const TemporaryFolder folder;
  const Protocol protocol = testing::short_staircases(TaskKind::which);
  PowerQuestion question = rigged(protocol, 2);
  question.studies = 3;
  question.analyses = {PowerAnalysis::registered, PowerAnalysis::log_ml};
  const auto everything = [](const PowerResult& result) {
    return power_text(result) + power_json(result).dump() + power_csv(result);
  };
  const std::string whole = everything({protocol, question, power_study(protocol, question, {0, 3}, 2)});
  for (const int shards : {1, 2, 3}) {
    std::vector<std::filesystem::path> files;
    for (int shard = 1; shard <= shards; ++shard) {
      files.push_back(folder.path() / fmt::format("{}-of-{}.json", shard, shards));
      testing::make_power_shard(protocol, question, shard, shards, files.back());
    }
    CHECK(everything(combined_power(files)) == whole);
  }
}

ExactSum sum_of(const std::vector<double>& values) {
  ExactSum sum;
  for (const double value : values) sum.add(value);
  return sum;
}

// Of every size and sign, subnormal ones too.
std::vector<double> all_sizes(std::uint64_t seed, int count) {
  std::mt19937_64 generator(seed);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const auto exponent = static_cast<int>(generator() % 2000) - 1060;
    const double mantissa = 1 + static_cast<double>(generator() >> 12U) * 0x1p-52;
    values.push_back(std::ldexp((generator() & 1U) != 0 ? mantissa : -mantissa, exponent));
  }
  return values;
}

TEST_CASE("an exact sum does not depend on its order or its parts", "[exact_sum]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> values = all_sizes(seed, 300);
    const std::string whole = sum_of(values).text();
    std::shuffle(values.begin(), values.end(), std::mt19937_64(seed));
    REQUIRE(sum_of(values).text() == whole);
    ExactSum parts;
    for (std::size_t begin = 0; begin < values.size(); begin += 7) {
      const std::size_t end = std::min(values.size(), begin + 7);
      parts += sum_of(
          {values.begin() + static_cast<std::ptrdiff_t>(begin), values.begin() + static_cast<std::ptrdiff_t>(end)});
    }
    REQUIRE(parts.text() == whole);
    REQUIRE(ExactSum::from_text(whole).text() == whole);
    REQUIRE(ExactSum::from_text(whole).value() == sum_of(values).value());
    // What is taken away again leaves nothing at all.
    ExactSum rest = sum_of(values);
    for (const double value : values) rest.add(-value);
    REQUIRE(rest.text().empty());
    REQUIRE(rest.value() == 0);
  }
}

TEST_CASE("an exact sum is right where a plain one is not", "[exact_sum]") {
  CHECK(sum_of({1e100, 1, -1e100}).value() == 1);
  CHECK(sum_of({0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}).value() ==
        1);  // ten times the double next to 0.1, rounded
  CHECK(sum_of({}).value() == 0);
  CHECK(sum_of({0.0, -0.0}).text().empty());
  CHECK(sum_of({std::numeric_limits<double>::max(), -std::numeric_limits<double>::max(), -3.5}).value() == -3.5);
  const double least = std::numeric_limits<double>::denorm_min();
  CHECK(sum_of({least, least, least}).value() == 3 * least);
  CHECK(sum_of({-least}).value() == -least);
  // Sums of one size and sign, where a sum of 80 bits errs by less than the last bit of 53.
  std::mt19937_64 generator(5);
  for (int round = 0; round < 50; ++round) {
    long double plain = 0;
    ExactSum sum;
    for (int i = 0; i < 100; ++i) {
      const double value = std::ldexp(static_cast<double>(generator() >> 11U), -53) + 0.5;
      plain += value;
      sum.add(value);
    }
    REQUIRE(std::abs(sum.value() - static_cast<double>(plain)) <= 0x1p-45);
    REQUIRE(ExactSum::from_text(sum.text()).value() == sum.value());
  }
}

TEST_CASE("what is no exact sum is refused", "[exact_sum]") {
  for (const char* const text : {"x", "+", "+3", "+3:123", "+3:1234567g", "+70:00000001", "+-1:00000001", "3:00000001"})
    CHECK_THROWS_AS(ExactSum::from_text(text), std::invalid_argument);
}

}  // namespace
}  // namespace jnd
