// Participants of simulated studies who go through the simulated rig: they leave what jnd analyze makes of the same
// sessions, and answer as the response model of their profile says.
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "data/results/study_results.h"
#include "protocols/input/resources.h"
#include "protocols/reading/protocol_json.h"
#include "runner/opening/rig_limits.h"
#include "runner/opening/study_access.h"
#include "runner/power/drawn_people.h"
#include "runner/power/power_study.h"
#include "runner/power/power_text.h"
#include "runner/session/simulate.h"
#include "tests/catch.h"
#include "tests/runner/power/power_fixture.h"
#include "tests/runner/rigged_fixture.h"
#include "tests/temporary_folder.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
