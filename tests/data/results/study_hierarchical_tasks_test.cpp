// The hierarchical model of studies of other tasks, and of those in which answers set the levels.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/choice/two_interval.h"
#include "data/results/study_hierarchical.h"
#include "protocols/planning/track_threshold.h"
#include "protocols/random_stream.h"
#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// A task of the corpus with two conditions and one standard, and its levels as given.
Protocol task_protocol(const std::string& task, double standard, const std::vector<double>& levels) {
  Protocol protocol =
      load_protocol(std::string(JND_SOURCE_DIR) + "/tests/protocols/corpus/good/task-" + task + ".json");
  protocol.conditions.resize(2);
  protocol.series = {{.name = "one", .standard = standard, .levels = levels}};
  protocol.task.standard_first = false;
  protocol.task.sureness_levels = 0;
  protocol.analysis.lapse_free = false;
  protocol.analysis.outcome = task == "which" ? "jnd" : "threshold";
  protocol.analysis.contrasts = {{1, 0}};
  return protocol;
}

// Six people, a pattern of positive answers that rises with the level.
TaskResults patterned_task(const Protocol& protocol, const std::vector<std::vector<double>>& levels) {
  TaskResults results;
  results.outcomes = measured_outcomes(protocol);
  for (int person = 0; person < 6; ++person)
    for (int condition = 0; condition < 2; ++condition)
      for (int series = 0; series < static_cast<int>(levels.size()); ++series) {
        TaskEstimateRow& row = results.estimates.emplace_back();
        row.participant = "P" + std::to_string(10 + person);
        row.condition = condition;
        row.standard = series;
        row.estimates.values.resize(results.outcomes.size());
        const auto& of_series = levels[static_cast<std::size_t>(series)];
        for (std::size_t i = 0; i < of_series.size(); ++i) {
          const int steps = static_cast<int>(8 * (i + 1) / (of_series.size() + 1));
          const int positive =
              std::clamp(steps + (person + static_cast<int>(i)) % 3 - 1 + (condition == 1 && i < 2), 0, 8);
          row.answers.push_back({of_series[i], positive, 8 - positive});
        }
      }
  return results;
}

std::vector<HierarchicalCell> cells_of(const TaskResults& results) {
  std::vector<HierarchicalCell> cells;
  for (std::size_t i = 0; i < results.estimates.size(); ++i)
    for (const LevelCount& one : results.estimates[i].answers)
      cells.push_back({static_cast<int>(i / 2), results.estimates[i].condition, one.level,
                       static_cast<double>(one.positive), static_cast<double>(one.negative)});
  return cells;
}

TEST_CASE("the model of choices is that of their counts, its JND as registered, its criterion the bias",
          "[data][long]") {
  Protocol protocol = task_protocol("which", 500, {300, 400, 450, 500, 550, 600, 700});
  TaskResults results = patterned_task(protocol, {{-200, -100, -50, 0, 50, 100, 200}});
  HierarchicalModel of;
  of.response = ResponseModel::choice;
  of.shared.lapse = 0.02;
  HierarchicalAnalysis fitted(cells_of(results), of);
  const HierarchicalFit& fit = fitted.add_intervals();
  const std::vector<PersonEstimate> people = fitted.people();
  protocol.analysis.lapse = 0.02;
  results.estimates[1].estimates.values[0].value = 61.5;
  results.estimates[2].estimates.status = "separated";
  for (const auto& [convention, factor] :
       {std::pair("84 %", 1.0), std::pair("75 %", 0.6744897501960817), std::pair("d'=1", std::sqrt(0.5))}) {
    protocol.analysis.jnd_convention = convention;
    const StudyHierarchical model = study_hierarchical(results, protocol);
    REQUIRE(model.status == HierarchicalStatus::ok);
    CHECK(model.response == ResponseModel::choice);
    CHECK(model.lapse == 0.02);
    CHECK(model.trials == 6 * 2 * 7 * 8);
    REQUIRE(model.conditions.size() == 2);
    for (std::size_t c = 0; c < 2; ++c) {
      const HierarchicalCondition& one = model.conditions[c];
      CHECK(one.jnd == Approx(factor * std::exp(fit.conditions[c].mu)).epsilon(1e-9));
      CHECK(one.ci_high == Approx(factor * std::exp(fit.conditions[c].ends.high)).epsilon(1e-9));
      CHECK(one.weber == Approx(one.jnd / 500));
      CHECK(one.criterion == Approx(fit.conditions[c].criterion).epsilon(1e-9));
      CHECK(one.pse == Approx(500 + fit.conditions[c].criterion));
      CHECK(one.pse_low == Approx(500 + fit.conditions[c].criterion_ends.low));
      CHECK(one.pse_high == Approx(500 + fit.conditions[c].criterion_ends.high));
      CHECK(one.pse_low < one.pse);
      CHECK(one.pse < one.pse_high);
    }
    for (std::size_t i = 0; i < people.size(); ++i) {
      if (!model.alike()) CHECK(model.people[i].jnd == Approx(factor * std::exp(people[i].mean)).epsilon(1e-6));
      CHECK(model.people[i].criterion == Approx(people[i].criterion).epsilon(1e-6));
    }
    CHECK(model.people[1].separate == 61.5);
    CHECK(model.people[2].separate_status == JndStatus::ceiling);
    CHECK(model.people[3].separate_status == JndStatus::no_information);
    REQUIRE(model.ratios.size() == 1);
    CHECK(model.ratios.front().ratio == Approx(model.conditions[0].jnd / model.conditions[1].jnd));
    CHECK(model.ratios.front().participants == 6);
    CHECK(model.equal_df == 1);
    CHECK(model.equal_p == Approx(model.ratios.front().p).epsilon(1e-3));
  }
}

TEST_CASE("of several standards every one has its JND, on the scale of its own", "[data][long]") {
  Protocol protocol = task_protocol("which", 100, {50, 75, 90, 110, 125, 150});
  protocol.series.push_back({.name = "ten times", .standard = 1000, .levels = {500, 750, 900, 1100, 1250, 1500}});
  const std::vector<double> shares = {-0.5, -0.25, -0.1, 0.1, 0.25, 0.5};
  std::vector<std::vector<double>> levels;
  for (const double standard : {100.0, 1000.0}) {
    levels.emplace_back();
    for (const double share : shares) levels.back().push_back(standard * share);
  }
  const StudyHierarchical model = study_hierarchical(patterned_task(protocol, levels), protocol);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.several_standards);
  REQUIRE(model.conditions.size() == 4);
  for (const std::size_t c : {0, 2}) {
    CHECK(model.conditions[c].standard == 0);
    CHECK(model.conditions[c + 1].standard == 1);
    CHECK(model.conditions[c + 1].jnd == Approx(10 * model.conditions[c].jnd).epsilon(1e-4));
    CHECK(model.conditions[c].weber == Approx(model.conditions[c].jnd / 100));
    CHECK(model.conditions[c + 1].pse == Approx(10 * model.conditions[c].pse).epsilon(1e-4));
  }
  REQUIRE(model.ratios.size() == 2);  // at each standard, not across
  CHECK(model.ratios[0].standard == 0);
  CHECK(model.ratios[1].standard == 1);
  CHECK(model.ratios[1].ratio == Approx(model.conditions[1].jnd / model.conditions[3].jnd));
  CHECK(model.equal_df == 0);
  CHECK(model.people.size() == 24);
  for (const HierarchicalPerson& one : model.people) CHECK(one.status == ShrunkenStatus::ok);
}

TEST_CASE("comparisons on one side of the standard leave the PSE there, and the JND is that of the study", "[data]") {
  const Protocol protocol = task_protocol("which", 500, {520, 550, 600, 700});
  TaskResults results = patterned_task(protocol, {{20, 50, 100, 200}});
  results.estimates.resize(1);  // one person in one condition: the fit of anybody's answers
  std::vector<ChoiceRow> rows;
  for (LevelCount& one : results.estimates.front().answers) {
    one.positive = 4 + one.positive / 2;
    one.negative = 8 - one.positive;
    ChoiceRow& row = rows.emplace_back();
    row.level = 500 + one.level;
    row.n = 8;
    row.chosen = one.positive;
  }
  const TwoIntervalFit alone = fit_two_interval(rows, {.pse = 500});
  REQUIRE(alone.status == TwoIntervalStatus::ok);
  const StudyHierarchical model = study_hierarchical(results, protocol);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.pse_at_standard);
  CHECK(model.conditions[0].jnd == Approx(*alone.s).epsilon(1e-5));  // 84 %
  CHECK(std::isnan(model.conditions[0].pse));
  CHECK(std::isnan(model.conditions[0].criterion));
  CHECK(std::isnan(model.people[0].criterion));
  CHECK(model.people[0].alone == Approx(*alone.s).epsilon(2e-3));  // where a search begins
  CHECK(model.criteria.status == SpreadStatus::not_asked);
  CHECK(model.trials == 32);
  CHECK(status_word(model, model.conditions[1]) == "missing");

  for (LevelCount& one : results.estimates.front().answers) one.positive = one.negative = 4;
  const StudyHierarchical blind = study_hierarchical(results, protocol);
  CHECK(status_word(blind, blind.conditions[0]) == "no_sensitivity");
}

TEST_CASE("the model of yes and no is of the distance from the noise, and its JND the threshold", "[data]") {
  const Protocol protocol = task_protocol("yes-no", 0, {15, 30, 60, 90, 120});
  TaskResults results = patterned_task(protocol, {{0, 15, 30, 60, 90, 120}});
  HierarchicalAnalysis fitted(cells_of(results), {});
  const HierarchicalFit& fit = fitted.add_intervals();
  const StudyHierarchical model = study_hierarchical(results, protocol);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.response == ResponseModel::yes_no);
  for (std::size_t c = 0; c < 2; ++c) {
    CHECK(model.conditions[c].jnd == Approx(std::exp(fit.conditions[c].mu)).epsilon(1e-9));
    CHECK(model.conditions[c].criterion == Approx(fit.conditions[c].criterion).epsilon(1e-9));
    CHECK(std::isnan(model.conditions[c].weber));  // of no delay nothing is a share
    CHECK(std::isnan(model.conditions[c].pse));
  }
  CHECK(jnd_title(protocol) == "threshold");

  for (TaskEstimateRow& row : results.estimates) row.answers.clear();
  const StudyHierarchical nobody = study_hierarchical(results, protocol);
  CHECK(nobody.status == HierarchicalStatus::no_answers);
  CHECK(nobody.reason == "no trial counts whose level is not the standard");
}

TEST_CASE("levels that answers set count like given ones; a threshold that is no JND stands for none", "[data]") {
  const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/adaptive-staircase.json");
  TaskResults results = empty_task_results(protocol);
  std::vector<HierarchicalCell> cells;
  for (int person = 0; person < 4; ++person)
    for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
      TaskEstimateRow& all = results.estimates.emplace_back();
      all.participant = "P" + std::to_string(10 + person);
      all.condition = condition;
      all.estimates.values.resize(results.outcomes.size());
      all.estimates.values.front().value = 500;  // of the staircase: another point
      all.answers = {{0, 2, 10}, {100, 3 + person % 2, 5}, {217.5, 6, 4 - condition % 2}, {400, 9, 1}};
      for (const LevelCount& one : all.answers)
        cells.push_back(
            {person, condition, one.level, static_cast<double>(one.positive), static_cast<double>(one.negative)});
    }
  const StudyHierarchical model = study_hierarchical(results, protocol);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK_FALSE(model.gathered);
  HierarchicalAnalysis fitted(cells, {.response = *model.response});
  for (std::size_t c = 0; c < protocol.conditions.size(); ++c)
    CHECK(model.conditions[c].jnd == Approx(std::exp(fitted.fit().conditions[c].mu)).epsilon(1e-9));
  REQUIRE(model.people.size() == 4 * protocol.conditions.size());
  for (const HierarchicalPerson& one : model.people) {
    CHECK(one.separate_status == JndStatus::ok);
    CHECK(one.separate == one.alone);
    CHECK(one.separate != 500);
  }
}

// Levels about each person's own threshold, no two alike, and answers as a yes-no observer gives them.
TaskResults tracked_results(const Protocol& protocol, int people, int trials) {
  TaskResults results = empty_task_results(protocol);
  for (int person = 0; person < people; ++person) {
    RandomStream random(7, static_cast<std::uint64_t>(person) + 1, "tracks");
    const double of_person = 0.25 * random.normal();
    for (int condition = 0; condition < static_cast<int>(protocol.conditions.size()); ++condition) {
      TaskEstimateRow& row = results.estimates.emplace_back();
      row.participant = "P" + std::to_string(10 + person);
      row.condition = condition;
      const double s = 200 * std::exp(of_person + 0.15 * condition);
      std::map<double, LevelCount> by_level;
      for (int trial = 0; trial < trials; ++trial) {
        const double level = trial % 4 == 0 ? 0 : 1.5 * s * std::exp(0.35 * random.normal());
        LevelCount& one = by_level[level];
        one.level = level;
        ++(random.normal() < level / s - 0.9 ? one.positive : one.negative);
      }
      for (const auto& [level, one] : by_level) row.answers.push_back(one);
    }
  }
  return results;
}

TEST_CASE("levels that answers set, hardly two alike, count in steps, and estimates stay where they are",
          "[data][long]") {
  const Protocol protocol = load_protocol(std::string(JND_SOURCE_DIR) + "/protocols/adaptive-quest.json");
  const TaskResults results = tracked_results(protocol, 4, 24);
  const StudyHierarchical model = study_hierarchical(results, protocol);
  REQUIRE(model.status == HierarchicalStatus::ok);
  CHECK(model.gathered);
  CHECK(model.trials == 4 * 24 * static_cast<std::int64_t>(protocol.conditions.size()));

  std::vector<HierarchicalCell> cells;
  for (std::size_t i = 0; i < results.estimates.size(); ++i)
    for (const LevelCount& one : results.estimates[i].answers)
      cells.push_back({static_cast<int>(i / protocol.conditions.size()), results.estimates[i].condition, one.level,
                       static_cast<double>(one.positive), static_cast<double>(one.negative)});
  HierarchicalAnalysis exact(cells, {.response = *model.response});
  for (const HierarchicalCondition& row : model.conditions) {
    const ConditionMean& mean = exact.fit().conditions[static_cast<std::size_t>(row.condition)];
    REQUIRE(row.status == SlopeStatus::ok);
    const double error = (std::log(row.ci_high) - std::log(row.ci_low)) / (2 * 1.96);
    CHECK(std::abs(std::log(row.jnd) - mean.mu) < 0.1 * error);
    CHECK(row.criterion == Approx(mean.criterion).margin(0.03));
  }
  CHECK(model.persons.sd == Approx(exact.fit().maximum.place.tu).margin(0.02));
}

}  // namespace
}  // namespace jnd
