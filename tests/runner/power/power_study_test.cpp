#include "runner/power/power_study.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <sys/stat.h>

#include "analysis/numerics/stop_request.h"
#include "analysis/precision/precision.h"
#include "data/results/study_comparisons.h"
#include "protocols/input/input_error.h"
#include "protocols/input/resources.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/reading/protocol_json.h"
#include "runner/keys/interrupt.h"
#include "runner/power/power_text.h"
#include "tests/catch.h"
#include "tests/runner/power/power_fixture.h"
#include "tests/temporary_folder.h"
#include "tests/wait_until.h"

using namespace jnd;

namespace {

Protocol shipped(const std::string& name) {
  return load_protocol(find_resource(Resource::protocol, name));
}

PowerQuestion question_of(const Protocol& protocol) {
  PowerQuestion question = testing::registered_question(protocol);
  question.participants = {6, 12};
  question.trials = {12};
  question.effects = {0, 1};
  question.analyses = {PowerAnalysis::registered};
  question.studies = 40;
  return question;
}

PowerResult result_of(const Protocol& protocol, const PowerQuestion& question, int threads = 1) {
  return {protocol, question, power_study(protocol, question, {0, question.studies}, threads)};
}

std::string everything(const PowerResult& result) {
  return power_text(result) + power_json(result).dump() + power_csv(result) + ademp_text(result);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

double slope_of(const DrawnPerson& person, std::size_t condition) {
  return person.estimates[condition].estimates.values[0].value.value();
}

}  // namespace

TEST_CASE("one test of every pair is that of the whole comparison", "[power]") {
  WithinTable table;
  table.n = 7;
  table.k = 3;
  for (std::size_t i = 0; i < table.n * table.k; ++i)
    table.values.push_back(std::sin(static_cast<double>(i * i)) + 0.1 * static_cast<double>(i % 3));
  const Comparison whole = compare(table);
  AnalysisPlan plan;
  plan.contrasts = {{0, 1}, {2, 0}, {1, 2}};
  const std::pair<PostHoc, PairTest> tests[] = {{PostHoc::holm_t, PairTest::paired_t},
                                                {PostHoc::games_howell, PairTest::games_howell},
                                                {PostHoc::tukey, PairTest::tukey},
                                                {PostHoc::wilcoxon, PairTest::wilcoxon}};
  for (const auto& [registered, test] : tests) {
    plan.tests.post_hoc = registered;
    CHECK(contrast_p(compare_pairs(table, test), plan) == contrast_p(whole, plan));
    for (std::size_t i = 0; i < whole.pairs.size(); ++i)
      CHECK(compare_pairs(table, test).pairs[i].mean_difference == whole.pairs[i].mean_difference);
  }
}

TEST_CASE("designs are compared on the same people", "[power]") {
  Protocol protocol = shipped("chinello2017");
  const PowerQuestion question = question_of(protocol);
  const auto source = people_source(protocol, question, 1);
  const std::vector<DrawnPerson> few = source->people(3, 4), many = source->people(3, 9);
  for (std::size_t p = 0; p < few.size(); ++p)
    for (std::size_t c = 0; c < few[p].estimates.size(); ++c) CHECK(slope_of(few[p], c) == slope_of(many[p], c));
  // More trials of the same people: the same hidden numbers, so the estimates of both go together.
  Protocol longer = protocol;
  longer.design.trials_per_cell = 48;
  const auto more = people_source(longer, question, 1);
  double both = 0, of_short = 0, of_long = 0;
  for (std::uint64_t study = 0; study < 60; ++study) {
    const DrawnPerson a = source->people(study, 1).front(), b = more->people(study, 1).front();
    const double x = slope_of(a, 0) - 1 / question.jnds[0], y = slope_of(b, 0) - 1 / question.jnds[0];
    both += x * y;
    of_short += x * x;
    of_long += y * y;
  }
  CHECK(both / std::sqrt(of_short * of_long) > 0.5);
}

TEST_CASE("drawn participants agree with the enumeration of every outcome", "[power]") {
  Protocol protocol = shipped("chinello2017");
  PowerQuestion question = question_of(protocol);
  question.people = {.between_cv = 0, .interaction_cv = 0, .criterion = 0.6, .criterion_sd = 0};
  for (const Sampling sampling : {Sampling::random, Sampling::balanced}) {
    protocol.design.sampling = sampling;
    const auto source = people_source(protocol, question, 1);
    constexpr int kStudies = 1500, kPeople = 8;
    std::vector<int> ok(3), below(3);
    PrecisionQuestion exact = precision_question(protocol);
    std::vector<ParticipantPrecision> told;
    for (const double jnd : exact.jnds) {
      // The criterion is one of the population's, in spreads: at the same value for every series.
      exact.design.criterion = {CriterionRule::Kind::common, question.people.criterion * jnd};
      told.push_back(participant_precision(exact, jnd));
      REQUIRE(told.back().method == PrecisionMethod::enumeration);
    }
    for (std::uint64_t study = 0; study < kStudies; ++study)
      for (const DrawnPerson& person : source->people(study, kPeople))
        for (std::size_t c = 0; c < 3; ++c) {
          const std::optional<double>& jnd = person.estimates[c].estimates.values[1].value;
          ok[c] += jnd ? 1 : 0;
          below[c] += jnd && *jnd <= told[c].q95 * (1 + 1e-12) ? 1 : 0;
        }
    for (std::size_t c = 0; c < 3; ++c) {
      const double n = kStudies * kPeople, p = told[c].status.ok;
      CHECK(std::abs(ok[c] / n - p) < 5 * std::sqrt(p * (1 - p) / n) + 1e-12);
      // The 95 % quantile, among those with information; ties of a discrete distribution may lie on it.
      if (std::isfinite(told[c].q95))
        CHECK(below[c] / n > 0.95 * (1 - told[c].status.no_information) - 5 * std::sqrt(0.05 / n) - 0.002);
    }
  }
}

TEST_CASE("an observer of independent observations says same the more, the further apart the others of a series are",
          "[power]") {
  Protocol protocol = shipped("chinello2017");
  protocol.analysis.model = "independent-observation";
  PowerQuestion question = question_of(protocol);
  question.people = {.between_cv = 0, .interaction_cv = 0, .criterion = 0.2, .criterion_sd = 0};
  const std::unique_ptr<PeopleSource> source = people_source(protocol, question, 1);
  std::map<double, AnswerTally> in_first;  // by level, of the first condition
  for (std::uint64_t study = 0; study < 40; ++study)
    for (const DrawnPerson& person : source->people(study, 12))
      for (const HierarchicalCell& cell : person.answers)
        if (cell.condition == 0) in_first[cell.level] += cell.counts();
  REQUIRE(in_first.size() == 6);  // every difference, and the equal stimuli of its series
  for (const auto& [level, counts] : in_first) {
    const double rate =
        std::exp(log_rates(ResponseModel::independent, level, std::log(question.jnds[0]), 0.2, 0).positive);
    const double error = std::sqrt(rate * (1 - rate) / counts.trials());
    CHECK(error < 0.02);
    CHECK(std::abs(counts.positive / counts.trials() - rate) < 5 * error);
  }
  CHECK(in_first.begin()->second.positive / in_first.begin()->second.trials() < 0.4);
}

TEST_CASE("the mean of a registered contrast is that of the enumeration", "[power]") {
  Protocol protocol = shipped("chinello2017");
  protocol.design.sampling = Sampling::balanced;
  PowerQuestion question = question_of(protocol);
  question.participants = {12};
  question.effects = {1};
  question.people = {.between_cv = 0, .interaction_cv = 0, .criterion = 0.6, .criterion_sd = 0};
  question.studies = 1500;
  std::vector<double> slopes;
  for (const double jnd : question.jnds)
    slopes.push_back(testing::enumerated_slope(protocol, question.people.criterion, jnd));
  for (const ContrastSummary& row : contrast_summaries(result_of(protocol, question, 2))) {
    const auto& [a, b] = question.contrasts[row.contrast];
    const double exact = slopes[static_cast<std::size_t>(a)] - slopes[static_cast<std::size_t>(b)];
    CHECK(std::abs(row.estimate.truth + row.estimate.bias.value - exact) < 5 * row.estimate.bias.error);
    // And that of the largest is not the truth: few trials and their correction make d' small.
    if (row.contrast == 2) CHECK(std::abs(row.estimate.bias.value) > 5 * row.estimate.bias.error);
  }
}

TEST_CASE("shards add up to the same bytes, however many they are", "[power][shards]") {
  const TemporaryFolder folder;
  for (const std::string name : {"chinello2017", "adaptive-staircase"}) {
    const Protocol protocol = shipped(name);
    PowerQuestion question = question_of(protocol);
    if (protocol.design.procedure) question.trials.clear();
    question.participants = {4};
    question.effects = {1};
    question.people.drop_out = 0.1;
    question.studies = 64;
    if (protocol.design.procedure) {
      question.analyses = {PowerAnalysis::registered, PowerAnalysis::log_ml, PowerAnalysis::hierarchical};
      question.studies = 8;
    }
    const std::string whole = everything(result_of(protocol, question, 2));
    CHECK(everything(result_of(protocol, question, 1)) == whole);
    for (const int shards : {1, 2, 7, 64}) {
      if (shards > question.studies) continue;
      std::vector<std::filesystem::path> files;
      for (int shard = shards; shard >= 1; --shard) {
        files.push_back(folder.path() / fmt::format("{}-{}-of-{}.json", name, shard, shards));
        CHECK(testing::make_power_shard(protocol, question, shard, shards, files.back()) == ShardEnd::made);
        CHECK(testing::make_power_shard(protocol, question, shard, shards, files.back()) == ShardEnd::was_there);
      }
      std::swap(files.front(), files[files.size() / 2]);
      CHECK(everything(combined_power(files)) == whole);
    }
  }
}

TEST_CASE("shards that do not go together are refused", "[power][shards]") {
  const TemporaryFolder folder;
  const Protocol protocol = shipped("chinello2017");
  PowerQuestion question = question_of(protocol);
  question.participants = {4};
  question.studies = 6;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  for (int shard = 1; shard <= 3; ++shard)
    testing::make_power_shard(protocol, question, shard, 3, file(std::to_string(shard)));
  PowerQuestion other = question;
  other.people.lapse = 0.01;
  testing::make_power_shard(protocol, other, 2, 3, file("other"));
  testing::make_power_shard(protocol, question, 1, 2, file("of_two"));
  std::string edited = text_of(file("2"));
  edited.replace(edited.find("\"tested\""), 8, "\"Tested\"");
  std::ofstream(file("edited")) << edited;
  const std::string older = text_of(file("2"));
  StudyShard shard = read_shard(file("2"));
  shard.program = "0.0.1";
  std::ofstream(file("older")) << shard_text(shard);
  shard = read_shard(file("2"));
  shard.range.last -= 1;
  std::ofstream(file("unfinished")) << shard_text(shard);
  std::ofstream(file("cut")) << older.substr(0, older.size() / 2);
  std::ofstream(file("no_shard")) << "{\"format\": 3}";
  const std::string deep(300'000, '[');
  std::ofstream(file("deep")) << R"({"format": "jnd shard 2", "sha256": "", "question": )" << deep
                              << std::string(deep.size(), ']') << "}";
  REQUIRE(::mkfifo(file("pipe").c_str(), 0600) == 0);
  shard = read_shard(file("2"));
  shard.of = 2'000'000'000;
  std::ofstream(file("of_many")) << shard_text(shard);
  testing::make_power_shard(protocol, question, 1, 1, file("whole"));
  shard = read_shard(file("whole"));
  shard.question["contrasts"][0] = {0, 9};
  std::ofstream(file("no_such_condition")) << shard_text(shard);

  const auto refusal = [&](const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(file(name));
    try {
      combined_power(files);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  CHECK(refusal({"3", "1", "2"}) == "taken");
  CHECK_THAT(refusal({"1", "3"}), Catch::Contains("shard 2 of 3 is missing"));
  CHECK_THAT(refusal({"3"}), Catch::Contains("shards 1, 2 of 3 are missing"));
  CHECK_THAT(refusal({"1", "2", "2", "3"}), Catch::Contains("is shard 2, and so is"));
  CHECK_THAT(refusal({"1", "other", "3"}), Catch::Contains("lapse is 0.01 and not 0.0"));
  CHECK_THAT(refusal({"1", "of_two"}), Catch::Contains("one of 2 shards"));
  CHECK_THAT(refusal({"1", "edited", "3"}), Catch::Contains("not as it was written"));
  CHECK_THAT(refusal({"1", "older", "3"}), Catch::Contains("version 0.0.1"));
  CHECK_THAT(refusal({"1", "unfinished", "3"}), Catch::Contains("not a finished shard"));
  CHECK_THAT(refusal({"1", "cut", "3"}), Catch::Contains("is not a shard of simulated studies"));
  CHECK_THAT(refusal({"no_shard"}), Catch::Contains("is not a shard of simulated studies"));
  CHECK_THAT(refusal({"deep"}), Catch::Contains("is not a shard of simulated studies"));
  CHECK_THAT(refusal({"of_many"}), Catch::Contains("is not a shard of simulated studies"));
  CHECK_THAT(refusal({"no_such_condition"}), Catch::Contains("is not one of a power study"));
  CHECK_THAT(refusal({"1", "pipe"}), Catch::Contains("is a named pipe"));
  CHECK_THAT(refusal({"1", "/dev/zero"}), Catch::Contains("is a device"));
  CHECK_THAT(refusal({"1", "nowhere"}), Catch::Contains("cannot be opened"));
  // A name that something else has is left alone.
  CHECK_THROWS_AS(testing::make_power_shard(protocol, question, 1, 3, file("2")), InputError);
  CHECK_THROWS_AS(testing::make_power_shard(protocol, question, 2, 3, file("other")), InputError);
}

TEST_CASE("a shard goes on from what was done of it", "[power][shards]") {
  const TemporaryFolder folder;
  const Protocol protocol = shipped("chinello2017");
  PowerQuestion question = question_of(protocol);
  question.participants = {4};
  question.studies = 30;
  const std::filesystem::path whole = folder.path() / "whole", cut = folder.path() / "cut";
  testing::make_power_shard(protocol, question, 1, 1, whole);
  // As if killed after 11 studies.
  StudyShard part = power_shard(protocol, question, 1, 1);
  part.range.last = 11;
  part.result = to_json(power_study(protocol, question, part.range, 1));
  std::ofstream(cut.string() + ".part") << shard_text(part);
  std::int64_t first_told = 0;
  testing::make_power_shard(protocol, question, 1, 1, cut, [&](std::int64_t done) {
    if (first_told == 0) first_told = done;
  });
  CHECK(first_told == 12);
  CHECK(text_of(cut) == text_of(whole));
  CHECK_FALSE(std::filesystem::exists(cut.string() + ".part"));
  // A half-written one is no reason to fail.
  const std::filesystem::path anew = folder.path() / "anew";
  std::ofstream(anew.string() + ".part") << shard_text(part).substr(0, 200);
  testing::make_power_shard(protocol, question, 1, 1, anew);
  CHECK(text_of(anew) == text_of(whole));
}

TEST_CASE("a study through the rig that is interrupted does not count", "[power]") {
  const Protocol protocol = shipped("chinello2017");
  PowerQuestion question = question_of(protocol);
  question.participants = {200};
  question.effects = {1};
  question.profile = "chinello2017";
  // The last one of its range: nobody looks at the request after it. 20 ms of work are a small part of it.
  const std::clock_t worked = std::clock() + CLOCKS_PER_SEC / 50;
  std::jthread later([worked] {
    CHECK(wait_until([worked] { return std::clock() >= worked; }));
    request_interrupt();
  });
  CHECK_THROWS_AS(power_study(protocol, question, {0, 1}, 1), Stopped);
  later.join();
  interrupts().end = false;
  stop_requested() = false;
}

TEST_CASE("tasks with estimates of their own have the power of their response model", "[power][long]") {
  for (const std::string name : {"lee2007-delay", "zoeller2020"}) {
    Protocol protocol = shipped(name);
    CAPTURE(name, to_string(protocol.task.kind));
    protocol.conditions.resize(2);
    protocol.series.resize(1);
    protocol.analysis.contrasts = {{0, 1}};
    protocol.design.trials_per_cell = 20;
    const double scale = std::abs(protocol.series.front().levels.back() - protocol.series.front().standard) / 3;
    PowerQuestion question;
    question.participants = {8};
    question.trials = {20};
    question.effects = {0, 1};
    question.jnds = {scale, 1.8 * scale};
    question.contrasts = {{0, 1}};
    question.people.criterion = usual_criterion(response_model_of(protocol).value());
    question.analyses = {PowerAnalysis::registered, PowerAnalysis::log_ml, PowerAnalysis::hierarchical};
    question.studies = 24;
    const PowerResult result = result_of(protocol, question, 2);
    for (const GroupSummary& row : group_summaries(result)) {
      if (row.analysis != PowerAnalysis::hierarchical) continue;
      CHECK(row.estimate.undefined.value < 0.1);
      CHECK(std::abs(row.estimate.bias.value) < 5 * row.estimate.bias.error + 0.03);
      CHECK(row.estimate.coverage.value > 0.75);
    }
    const std::vector<ContrastSummary> rows = contrast_summaries(result);
    REQUIRE(rows.size() == 6);
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(rows[a].design.effect == 0);
      CHECK(rows[3 + a].power.value > rows[a].power.value + 0.2);
    }
    CHECK(everything(result).find("nan") == std::string::npos);

    // What is compared need not be a JND: then its truth is not known, and its test is there all the same.
    if (protocol.task.kind != TaskKind::yes_no) continue;
    protocol.analysis.outcome = "dprime";
    question.analyses = {PowerAnalysis::registered};
    const ContrastSummary of_dprime = contrast_summaries(result_of(protocol, question, 2)).back();
    CHECK(std::isnan(of_dprime.estimate.truth));
    CHECK(of_dprime.untested.value == 0);
    CHECK(of_dprime.power.value > 0.3);
    protocol.analysis.outcome = "criterion";
    CHECK_FALSE(power_refusal(PowerAnalysis::registered, protocol).empty());
  }
}

TEST_CASE("the analyses of a drawn study", "[power][long]") {
  const Protocol protocol = shipped("chinello2017");
  PowerQuestion question = question_of(protocol);
  question.participants = {12};
  question.effects = {0, 1};
  question.analyses = {PowerAnalysis::registered, PowerAnalysis::median, PowerAnalysis::log_ml,
                       PowerAnalysis::hierarchical};
  question.studies = 60;
  const PowerResult result = result_of(protocol, question, 2);
  for (const GroupSummary& row : group_summaries(result))
    if (row.analysis == PowerAnalysis::hierarchical) {
      CHECK(row.estimate.undefined.value == 0);
      CHECK(std::abs(row.estimate.bias.value) < 5 * row.estimate.bias.error + 0.02);
      CHECK(row.estimate.coverage.value > 0.85);
    }
  // With a difference it is found more often than without.
  const std::vector<ContrastSummary> rows = contrast_summaries(result);
  for (const ContrastSummary& row : rows)
    for (const ContrastSummary& other : rows)
      if (row.analysis == other.analysis && row.contrast == 2 && other.contrast == 2 && row.design.effect == 0 &&
          other.design.effect == 1) {
        CHECK(row.ratio == Approx(1));
        CHECK(other.ratio == Approx(351 / 208.5));
        CHECK(other.power.value > row.power.value + 0.2);
      }
  // Nobody left: nothing is defined, and nothing is significant.
  question.people.drop_out = 0.999999;
  question.studies = 2;
  for (const ContrastSummary& row : contrast_summaries(result_of(protocol, question))) {
    CHECK(row.power.value == 0);
    CHECK(row.untested.value == 1);
    CHECK(row.estimate.undefined.value == 1);
  }
}
