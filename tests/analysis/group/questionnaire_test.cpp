// Rating items: medians with distribution-free intervals, and families of paired tests.
#include "analysis/group/questionnaire.h"

#include <cmath>
#include <numeric>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

constexpr double kMissing = kNaN;

TEST_CASE("the interval of a median: places and coverage", "[analysis]") {
  for (const auto& one : group_reference().at("binomial_median")) {
    CAPTURE(one.dump());
    std::vector<double> values(one["n"].get<std::size_t>());
    std::iota(values.rbegin(), values.rend(), 1);
    const MedianInterval found = median_interval(values);
    const double r = one["r"], n = static_cast<double>(values.size());
    CHECK(found.n == one["n"].get<int>());
    CHECK(found.ci_low == r);
    CHECK(found.ci_high == n + 1 - r);
    CHECK(found.median == (n + 1) / 2);
    CHECK(std::abs(found.coverage - one["coverage"].get<double>()) <= 1e-13);
    CHECK(found.status == (found.coverage >= 0.95 ? StatisticStatus::ok : StatisticStatus::too_few));
  }
}

TEST_CASE("the interval of a median of few", "[analysis]") {
  CHECK(median_interval({}).status == StatisticStatus::too_few);
  CHECK(std::isnan(median_interval({}).median));
  CHECK(std::isnan(median_interval({}).coverage));
  const std::vector<double> one = {4}, five = {5, 1, 2, 2, 3};
  CHECK(median_interval(one).ci_low == 4);
  CHECK(median_interval(one).coverage == 0);
  CHECK(median_interval(five).coverage == 0.9375);
  CHECK(median_interval(five).status == StatisticStatus::too_few);
  CHECK(median_interval(five, 0.9).status == StatisticStatus::ok);
  CHECK(median_interval(five, 0.5).ci_low == 2);
}

TEST_CASE("the interval of a median contains it and shrinks with the confidence asked", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const auto ratings = *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 10)));
    const std::vector<double> values(ratings.begin(), ratings.end());
    const MedianInterval wide = median_interval(values, 0.99), narrow = median_interval(values, 0.6);
    RC_ASSERT(wide.ci_low <= narrow.ci_low);
    RC_ASSERT(narrow.ci_low <= narrow.median);
    RC_ASSERT(narrow.median <= narrow.ci_high);
    RC_ASSERT(narrow.ci_high <= wide.ci_high);
    RC_ASSERT(wide.coverage >= narrow.coverage);
  }));
}

TEST_CASE("paired items: exact p with ties, corrected over all pairs of all items", "[analysis]") {
  const auto& dataset = group_reference().at("datasets")[1];  // Likert ratings with ties and zeros
  const WithinTable ratings = table_of(dataset["data"]);
  WithinTable same{4, 3, std::vector<double>(12, 6.0)};
  const std::vector<PairedItem> items = {{"QB1", ratings}, {"QB2", same}};
  const PairedQuestionnaire found = paired_questionnaire(items);
  REQUIRE(found.items.size() == 2);
  CHECK(found.family == 3);  // an item without a difference is no test
  double smallest = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const ItemPair& pair = found.items[0].pairs[i];
    const auto& reference = dataset["wilcoxon"][i];
    CHECK(pair.exact);
    CHECK(std::abs(pair.p - reference["perm_exact_p_zeros_dropped"].get<double>()) <= 1e-15);
    CHECK(std::abs(pair.test.rank_biserial - reference["rank_biserial_matched"].get<double>()) <= 1e-14);
    smallest = std::min(smallest, pair.p);
  }
  CHECK(found.items[0].pairs[2].p == smallest);
  CHECK(found.items[0].pairs[2].p_holm == 3 * smallest);
  CHECK(found.items[0].pairs[2].p_bh == Approx(std::min(3 * smallest, 1.5 * found.items[0].pairs[0].p)));
  CHECK(relative(found.items[0].friedman.chi2, dataset["friedman"]["chi2"]) <= 1e-12);
  CHECK(found.items[0].conditions[0].median == 7);
  CHECK(found.items[0].pairs[0].median_difference == 3);
  for (const ItemPair& pair : found.items[1].pairs) {
    CHECK(pair.test.status == StatisticStatus::no_variance);
    CHECK(std::isnan(pair.p));
    CHECK(std::isnan(pair.p_holm));
    CHECK(pair.median_difference == 0);
  }
}

TEST_CASE("paired items: missing answers leave only their own pairs", "[analysis]") {
  const std::vector<PairedItem> items = {{"QB1", {4, 3, {7, 4, kMissing, 6, kMissing, 7, 8, 5, 8, 5, 4, 9}}},
                                         {"QB2", {3, 2, {7, 4, 6, 2, 8, kMissing}}}};
  const PairedQuestionnaire found = paired_questionnaire(items);
  const PairedItemResult& first = found.items[0];
  CHECK(first.conditions[0].n == 4);
  CHECK(first.conditions[1].n == 3);
  CHECK(first.conditions[2].n == 3);
  CHECK(first.pairs[0].test.n == 3);
  CHECK(first.pairs[2].test.n == 2);
  CHECK(first.friedman.n == 2);
  CHECK(found.items[1].friedman.status == StatisticStatus::not_applicable);
  CHECK(std::isnan(found.items[1].friedman.p));
  CHECK(found.items[1].pairs.size() == 1);
  CHECK(found.items[1].pairs[0].test.n == 2);
  CHECK(found.family == 4);
  CHECK(paired_questionnaire({}).items.empty());
  const std::vector<PairedItem> nobody = {{"QB3", {2, 2, {kMissing, 1, 2, kMissing}}}};
  CHECK(paired_questionnaire(nobody).items[0].pairs[0].test.status == StatisticStatus::too_few);
  CHECK(std::isnan(paired_questionnaire(nobody).items[0].pairs[0].median_difference));
}

TEST_CASE("a median of few ratings, with its true coverage", "[analysis]") {
  const MedianInterval found = median_interval(std::vector<double>{8, 7, 9, 8, 6, 9, 8});
  CHECK(found.n == 7);
  CHECK(found.median == 8);
  CHECK(found.ci_low == 6);
  CHECK(found.ci_high == 9);
  CHECK(found.coverage == 1 - 2.0 / 128);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(median_interval({}).n == 0);
  CHECK(median_interval({}).status == StatisticStatus::too_few);
}

}  // namespace
}  // namespace jnd
