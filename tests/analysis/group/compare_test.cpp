// The whole comparison against R, and what it says where parts of it are undefined.
#include "analysis/group/compare.h"

#include <cmath>

#include <rapidcheck.h>

#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

TEST_CASE("a comparison agrees with R in every part", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const Comparison found = compare(table_of(dataset["data"]));
    CHECK(found.status == StatisticStatus::ok);
    REQUIRE(found.conditions.size() == 3);
    for (std::size_t j = 0; j < 3; ++j) {
      const ConditionSummary& of = found.conditions[j];
      CHECK(of.status == StatisticStatus::ok);
      CHECK(of.n == static_cast<int>(dataset["data"].size()));
      CHECK(relative(of.mean, dataset["mean"][j]) <= 1e-13);
      CHECK(relative(of.sd, dataset["sd"][j]) <= 1e-13);
      CHECK(relative(of.mean - of.ci_low, dataset["ci95_halfwidth_t"][j]) <= 1e-12);
      CHECK(relative(of.ci_high - of.mean, dataset["ci95_halfwidth_t"][j]) <= 1e-12);
      CHECK(relative(of.mean - of.ci_within_low, dataset["ci95_within_morey"][j]) <= 1e-12);
      CHECK(relative(of.ci_within_high - of.mean, dataset["ci95_within_morey"][j]) <= 1e-12);
      CHECK(std::abs(of.shapiro.w - dataset["shapiro"][j]["W"].get<double>()) <= 1e-12);
      CHECK(std::abs(of.shapiro.p - dataset["shapiro"][j]["p"].get<double>()) <= 1e-10);
    }
    CHECK(std::abs(found.residuals.w - dataset["shapiro_residuals"]["W"].get<double>()) <= 1e-12);
    CHECK(std::abs(found.residuals.p - dataset["shapiro_residuals"]["p"].get<double>()) <= 1e-10);
    CHECK(relative(found.anova.effect.f, dataset["rm_anova"]["F"]) <= 1e-11);
    CHECK(relative(found.friedman.chi2, dataset["friedman"]["chi2"]) <= 1e-12);

    REQUIRE(found.pairs.size() == 3);
    std::vector<double> wilcoxon;
    for (std::size_t i = 0; i < 3; ++i) {
      const PairComparison& pair = found.pairs[i];
      const auto& t = dataset["paired_t"][i];
      CHECK(pair.a == (i == 2 ? 1U : 0U));
      CHECK(pair.b == (i == 0 ? 1U : 2U));
      CHECK(relative(pair.mean_difference, t["diff"]) <= 1e-12);
      CHECK(relative(pair.t.t, t["t"]) <= 1e-12);
      CHECK(std::abs(pair.t_p_holm - t["p_holm"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.t_p_bh - t["p_BH"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.t_p_bonferroni - t["p_bonferroni"].get<double>()) <= 1e-13);
      CHECK(std::abs(pair.games_howell.p - dataset["games_howell"][i]["p"].get<double>()) <= 1e-11);
      CHECK(std::abs(pair.tukey.p - dataset["tukey_rm"][i]["p"].get<double>()) <= 1e-11);
      CHECK(pair.wilcoxon.v == dataset["wilcoxon"][i]["V"].get<double>());
      CHECK(std::abs(pair.wilcoxon.p - dataset["wilcoxon"][i]["R_default_p"].get<double>()) <= 1e-12);
      CHECK(pair.wilcoxon_p_holm >= pair.wilcoxon.p);
      CHECK(pair.wilcoxon_p_bh <= pair.wilcoxon_p_holm);
    }
  }
}

TEST_CASE("the median of a condition", "[analysis]") {
  const Comparison odd = compare({3, 2, {1, 9, 5, 7, 2, 8}}), even = compare({2, 2, {1, 9, 4, 7}});
  CHECK(odd.conditions[0].median == 2);
  CHECK(odd.conditions[1].median == 8);
  CHECK(even.conditions[0].median == 2.5);
}

TEST_CASE("with two conditions the within-subject interval is the paired t's", "[analysis]") {
  // Two Cousineau-Morey intervals of half width w: the difference's has half width w sqrt 2.
  const Comparison found = compare({4, 2, {3, 5, 4, 9, 6, 6, 8, 11}});
  const double within = found.conditions[0].ci_within_high - found.conditions[0].mean;
  CHECK(within * std::sqrt(2.0) == Approx((found.pairs[0].t.ci_high - found.pairs[0].t.ci_low) / 2).epsilon(1e-12));
  CHECK(found.anova.effect.mauchly.status == StatisticStatus::not_applicable);
  CHECK(found.anova.effect.p == Approx(found.pairs[0].t.p).epsilon(1e-12));
  CHECK(found.pairs[0].tukey.p == Approx(found.pairs[0].t.p).epsilon(1e-12));
  CHECK(found.pairs[0].t_p_holm == found.pairs[0].t.p);
}

TEST_CASE("a comparison of too little", "[analysis]") {
  for (const WithinTable& table : {WithinTable{0, 3, {}}, WithinTable{1, 3, {1, 2, 3}}, WithinTable{3, 1, {1, 2, 3}}}) {
    const Comparison found = compare(table);
    CHECK(found.status == StatisticStatus::too_few);
    CHECK(found.conditions.size() == table.k);
    CHECK(found.pairs.size() == table.k * (table.k - 1) / 2);
    CHECK(std::isnan(found.anova.effect.f));
    CHECK(std::isnan(found.friedman.p));
    for (const PairComparison& pair : found.pairs) {
      CHECK(pair.t.status == StatisticStatus::too_few);
      CHECK(std::isnan(pair.t_p_holm));
      CHECK(pair.tukey.status != StatisticStatus::ok);
    }
  }
  const ConditionSummary single = compare({1, 3, {1, 2, 3}}).conditions[1];
  CHECK(single.mean == 2);
  CHECK(single.median == 2);
  CHECK(std::isnan(single.sd));
  CHECK(std::isnan(single.ci_within_low));
  CHECK(single.status == StatisticStatus::too_few);
}

TEST_CASE("a comparison of constants", "[analysis]") {
  const Comparison found = compare({4, 3, std::vector<double>(12, 7.3)});
  CHECK(found.conditions[0].mean == 7.3);
  CHECK(found.conditions[0].sd == 0);
  CHECK(found.conditions[0].shapiro.status == StatisticStatus::no_variance);
  CHECK(found.residuals.status == StatisticStatus::no_variance);
  CHECK(found.anova.status == StatisticStatus::no_variance);
  CHECK(found.friedman.status == StatisticStatus::no_variance);
  for (const PairComparison& pair : found.pairs) {
    CHECK(pair.mean_difference == 0);
    CHECK(pair.t.status == StatisticStatus::no_variance);
    CHECK(pair.games_howell.status == StatisticStatus::no_variance);
    CHECK(pair.tukey.status == StatisticStatus::no_variance);
    CHECK(pair.wilcoxon.status == StatisticStatus::no_variance);
    CHECK(std::isnan(pair.wilcoxon_p_holm));
  }
}

TEST_CASE("every undefined number of a comparison has a status", "[analysis]") {
  REQUIRE(rc::check("whatever the table", [] {
    WithinTable table = random_table(1, 1, *rc::gen::inRange(0, 4));
    const Comparison found = compare(table);
    const auto agrees = [](StatisticStatus status, double value) {
      return (status == StatisticStatus::ok) == !std::isnan(value);
    };
    for (const ConditionSummary& of : found.conditions) {
      RC_ASSERT(agrees(of.status, of.sd));
      RC_ASSERT(agrees(of.shapiro.status, of.shapiro.p));
    }
    const WithinEffect& effect = found.anova.effect;
    RC_ASSERT(agrees(found.anova.status, effect.f));
    RC_ASSERT(agrees(found.anova.status, effect.p));
    RC_ASSERT(agrees(found.anova.status, effect.p_gg));
    RC_ASSERT(agrees(effect.mauchly.status, effect.mauchly.p));
    RC_ASSERT(agrees(effect.hotelling_status, effect.hotelling_p));
    RC_ASSERT(agrees(found.friedman.status, found.friedman.p));
    RC_ASSERT(agrees(found.residuals.status, found.residuals.p));
    for (const PairComparison& pair : found.pairs) {
      RC_ASSERT(agrees(pair.t.status, pair.t_p_holm));
      RC_ASSERT(agrees(pair.games_howell.status, pair.games_howell.p));
      RC_ASSERT(agrees(pair.tukey.status, pair.tukey.p));
      RC_ASSERT(agrees(pair.wilcoxon.status, pair.wilcoxon_p_holm));
    }
  }));
}

}  // namespace
}  // namespace jnd
