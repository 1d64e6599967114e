// Groups of participants in the results: who has rows, what is compared, and what is refused.
#include <cmath>

#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"
#include "data/blocks/result_blocks.h"
#include "data/results/study_results.h"
#include "protocols/planning/allotment.h"
#include "tests/catch.h"
#include "tests/data/pair_results.h"
#include "tests/data/study_fixture.h"

namespace jnd {
namespace {

Protocol grouped(std::vector<int> of_old, BetweenTest between) {
  Protocol protocol = chinello();
  protocol.groups = {{"young", "under 30", {0, 1, 2}}, {"old", "over 60", std::move(of_old)}};
  protocol.analysis.tests.between = between;
  protocol.analysis.contrasts = {{0, 1}, {2, 0}};
  return protocol;
}

// So many participants of each group in turn; hits differ from one to the next, and the old have fewer.
std::vector<CellCounts> grouped_counts(const Protocol& protocol, int each) {
  std::vector<CellCounts> cells;
  for (int i = 0; i < 2 * each; ++i) {
    const int group = i % 2;
    for (const int condition : conditions_of(protocol, group))
      for (int series = 0; series < 3; ++series)
        cells.push_back({"P0" + std::to_string(i + 1),
                         condition,
                         series,
                         {20, 18 - 3 * group - (i * (condition + 3)) % 5 - 2 * series, 20, 3 + (i + condition) % 2},
                         group});
  }
  return cells;
}

StudyResults results_for(const Protocol& protocol, int each = 4) {
  return results_of(grouped_counts(protocol, each), protocol);
}

double mean_slope(const StudyResults& results, const std::string& participant) {
  double sum = 0;
  int n = 0;
  for (const TaskEstimateRow& row : results.task.estimates) {
    if (row.participant != participant) continue;
    sum += value_of(row, kSlope);
    ++n;
  }
  return sum / n;
}

TEST_CASE("nobody has a row of a condition that the group does not get", "[groups]") {
  const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const StudyResults results = results_for(protocol);
  const TaskResults& task = results.task;
  CHECK(task.estimates.size() == 4 * 3 + 4 * 2);
  CHECK(task.cells.size() == 3 * task.estimates.size());
  for (const TaskEstimateRow& row : task.estimates) CHECK(has_condition(protocol, row.group, row.condition));
  CHECK(group_of(task, 0, kJnd).participants == 8);
  CHECK(group_of(task, 2, kJnd).participants == 4);
  const OutcomeComparison& outcome = results.comparisons.front();
  CHECK_FALSE(outcome.crossed);
  CHECK(outcome.everyone.size() == 8);
  CHECK(outcome.table.n == 4);  // the young, who get them all
  CHECK(outcome.left_out.empty());
  CHECK(results.by_series.n == 4);
}

TEST_CASE("welch and mann-whitney compare participants' means over their conditions", "[groups]") {
  for (const BetweenTest test : {BetweenTest::welch, BetweenTest::mann_whitney}) {
    const Protocol protocol = grouped({0, 1}, test);
    const StudyResults results = results_for(protocol);
    std::vector<double> young, old;
    for (int i = 1; i <= 8; ++i) (i % 2 == 1 ? young : old).push_back(mean_slope(results, "P0" + std::to_string(i)));
    const GroupsCompared& groups = results.groups.value();
    REQUIRE(groups.tested());
    REQUIRE(groups.comparison.pairs.size() == 1);
    CHECK(groups.comparison.pairs[0].welch.p == Approx(welch_t(young, old).p).epsilon(1e-12));
    CHECK(groups.comparison.pairs[0].welch.p < 0.05);
    CHECK(groups.comparison.pairs[0].ranks.p == Approx(mann_whitney(young, old).p).epsilon(1e-12));
    // By group: each of its conditions, then their mean.
    REQUIRE(groups.means.size() == 4 + 3);
    CHECK(groups.means[3].condition == -1);
    CHECK(groups.means[3].mean.mean == Approx(mean_with_ci(young).mean).epsilon(1e-12));
    CHECK(groups.means[6].mean.mean == Approx(mean_with_ci(old).mean).epsilon(1e-12));
    CHECK(groups.means[6].participants == 4);
  }
}

TEST_CASE("mixed-anova has every condition of both groups", "[groups]") {
  const StudyResults results = results_for(grouped({0, 1, 2}, BetweenTest::mixed_anova));
  const GroupsCompared& groups = results.groups.value();
  REQUIRE(groups.tested());
  CHECK(results.comparisons.front().crossed);
  CHECK(groups.table.values.k == 3);
  CHECK(groups.table.values.values == results.comparisons.front().table.values);
  const MixedAnova expected = mixed_anova(groups.table);
  CHECK(groups.comparison.anova.group.p == expected.group.p);
  CHECK(groups.comparison.anova.interaction.df1 == 2);
  CHECK(groups.comparison.anova.interaction.df2 == 12);
}

TEST_CASE("a contrast rests on those who get both conditions, corrected over the contrasts", "[groups]") {
  Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const StudyResults results = results_for(protocol);
  const OutcomeComparison& outcome = results.comparisons.front();
  std::vector<double> p;
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    std::vector<double> a, b;
    for (const ParticipantValues& one : outcome.everyone) {
      if (!has_condition(protocol, one.group, contrast.a) || !has_condition(protocol, one.group, contrast.b)) continue;
      a.push_back(one.values[static_cast<std::size_t>(contrast.a)]);
      b.push_back(one.values[static_cast<std::size_t>(contrast.b)]);
    }
    p.push_back(paired_t(a, b).p);
  }
  const std::vector<ContrastRow>& rows = results.contrasts;
  REQUIRE(rows.size() == 4);  // each on the slope, and the JND beside it
  CHECK(rows[0].participants == 8);
  CHECK(rows[0].difference.n == 8);
  CHECK(rows[2].participants == 4);
  CHECK(rows[2].difference.n == 4);
  CHECK(rows[0].p_registered == Approx(holm(p)[0]).epsilon(1e-12));
  CHECK(rows[2].p_registered == Approx(holm(p)[1]).epsilon(1e-12));
  protocol.analysis.tests.post_hoc = PostHoc::tukey;
  CHECK(contrasts_within(outcome, protocol)[0].refused.find("Tukey") == 0);
  CHECK(std::isnan(contrasts_within(outcome, protocol)[0].p));
}

TEST_CASE("what cannot be compared says why", "[groups]") {
  SECTION("a JND of everyone is needed, and the means say who has one") {
    Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    protocol.analysis.tests.outcome = Outcome::jnd;
    std::vector<CellCounts> cells = grouped_counts(protocol, 4);
    for (CellCounts& cell : cells)
      if (cell.participant == "P02" && cell.condition == 0) cell.counts = {20, 2, 20, 10};
    const StudyResults results = results_of(cells, protocol);
    const GroupsCompared& groups = results.groups.value();
    CHECK_FALSE(groups.tested());
    CHECK(groups.refused.find("P02 (S: no_sensitivity)") != std::string::npos);
    CHECK(groups.means[4].mean.n == 3);
    CHECK(groups.means[4].participants == 4);
    CHECK(results.deviations.back().find("groups was refused") != std::string::npos);
  }
  SECTION("one group alone") {
    const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    std::vector<CellCounts> cells = grouped_counts(protocol, 4);
    std::erase_if(cells, [](const CellCounts& cell) { return cell.group == 1; });
    const StudyResults results = results_of(cells, protocol);
    CHECK(results.groups->refused == "fewer than two groups have a participant");
    CHECK(std::isnan(results.groups->means.back().mean.mean));
  }
  SECTION("one participant in each group has no variance, which the test's status says") {
    const StudyResults results = results_for(grouped({0, 1}, BetweenTest::welch), 1);
    REQUIRE(results.groups->tested());
    CHECK(results.groups->comparison.pairs[0].welch.status == StatisticStatus::too_few);
    CHECK(std::isnan(results.groups->comparison.pairs[0].welch.p));
  }
  SECTION("nobody gets every condition") {
    Protocol protocol = grouped({0, 1}, BetweenTest::welch);
    protocol.groups[0].conditions = {0, 2};
    const StudyResults results = results_for(protocol);
    CHECK(results.comparisons.front().refused.find("groups of participants get different conditions") == 0);
    CHECK(results.groups->tested());
    CHECK(std::isfinite(results.contrasts[0].p_registered));  // of the old
  }
}

TEST_CASE("files have the group and its test where there are groups, and nothing of them elsewhere", "[groups]") {
  const auto names = [](const StudyResults& results, const Protocol& protocol) {
    std::vector<std::string> found;
    for (const Block& block : result_blocks(results, protocol)) found.push_back(block.file());
    return found;
  };
  const Protocol protocol = grouped({0, 1}, BetweenTest::welch);
  const auto with = names(results_for(protocol), protocol);
  CHECK(std::count(with.begin(), with.end(), "groups.csv") == 1);
  CHECK(std::count(with.begin(), with.end(), "group_pairs.csv") == 1);
  const Protocol mixed = grouped({0, 1, 2}, BetweenTest::mixed_anova);
  const auto effects = names(results_for(mixed), mixed);
  CHECK(std::count(effects.begin(), effects.end(), "between.csv") == 1);
  Protocol none = protocol;
  none.groups.clear();
  std::vector<CellCounts> cells = grouped_counts(grouped({0, 1, 2}, BetweenTest::welch), 4);
  for (CellCounts& cell : cells) cell.group.reset();
  const auto without = names(results_of(cells, none), none);
  CHECK(std::count(without.begin(), without.end(), "groups.csv") == 0);
}

}  // namespace
}  // namespace jnd
