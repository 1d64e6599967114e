// Groups and conditions together: a second computation by regression on dummy variables, and the tests that it must agree
// with where there are two groups or two conditions.
#include "analysis/group/mixed_anova.h"

#include <cmath>
#include <vector>

#include "analysis/group/between_groups.h"
#include "analysis/group/repeated_measures.h"
#include "analysis/numerics/special_values.h"
#include "protocols/random_stream.h"
#include "tests/catch.h"

namespace jnd {
namespace {

GroupedTable random_groups(const std::vector<int>& sizes, std::size_t k, std::uint64_t seed) {
  GroupedTable table;
  RandomStream stream(seed, 1, "mixed");
  table.groups = sizes.size();
  table.values.k = k;
  for (std::size_t g = 0; g < sizes.size(); ++g)
    for (int i = 0; i < sizes[g]; ++i) {
      const double own = 40 * stream.normal();
      table.group.push_back(g);
      ++table.values.n;
      for (std::size_t j = 0; j < k; ++j)
        table.values.values.push_back(300 + own + 15 * static_cast<double>(g * j) + 20 * static_cast<double>(j) +
                                      (20 + 5 * static_cast<double>(j)) * stream.normal());
    }
  return table;
}

// Type I sums of squares as a regression has them: columns of dummies one after the other, each taken off what is left.
class Regression {
 public:
  explicit Regression(std::vector<double> y) : y_(std::move(y)) {}
  // The sum of squares that the columns take off, and their rank.
  double take_off(const std::vector<std::vector<double>>& columns, int& rank) {
    double taken = 0;
    for (std::vector<double> column : columns) {
      const double length = dot(column, column);
      for (int twice = 0; twice < 2; ++twice)
        for (const auto& unit : basis_) subtract(column, unit, dot(column, unit));
      const double left = dot(column, column);
      if (left < 1e-16 * (1 + length)) continue;
      for (double& value : column) value /= std::sqrt(left);
      const double along = dot(y_, column);
      subtract(y_, column, along);
      taken += along * along;
      basis_.push_back(column);
      ++rank;
    }
    return taken;
  }
  double rest() const { return dot(y_, y_); }

 private:
  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  static void subtract(std::vector<double>& a, const std::vector<double>& b, double times) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= times * b[i];
  }
  std::vector<double> y_;
  std::vector<std::vector<double>> basis_;
};

template <typename Is>
std::vector<double> dummy(const GroupedTable& table, Is is) {
  std::vector<double> column;
  for (std::size_t i = 0; i < table.values.n; ++i)
    for (std::size_t j = 0; j < table.values.k; ++j) column.push_back(is(i, j) ? 1 : 0);
  return column;
}

void check_by_regression(const GroupedTable& table) {
  const MixedAnova found = mixed_anova(table);
  std::vector<std::vector<double>> one{dummy(table, [](auto, auto) { return true; })}, groups, people, conditions, both;
  for (std::size_t g = 0; g < table.groups; ++g) {
    groups.push_back(dummy(table, [&](std::size_t i, auto) { return table.group[i] == g; }));
    for (std::size_t c = 0; c < table.values.k; ++c)
      both.push_back(dummy(table, [&](std::size_t i, std::size_t j) { return table.group[i] == g && j == c; }));
  }
  for (std::size_t p = 0; p < table.values.n; ++p)
    people.push_back(dummy(table, [&](std::size_t i, auto) { return i == p; }));
  for (std::size_t c = 0; c < table.values.k; ++c)
    conditions.push_back(dummy(table, [&](auto, std::size_t j) { return j == c; }));
  Regression regression(table.values.values);
  int rank[5] = {};
  regression.take_off(one, rank[0]);
  const double ss_group = regression.take_off(groups, rank[1]), ss_people = regression.take_off(people, rank[2]);
  const double ss_condition = regression.take_off(conditions, rank[3]), ss_both = regression.take_off(both, rank[4]);
  CHECK(found.group.ss == Approx(ss_group).epsilon(1e-9));
  CHECK(found.group.ss_error == Approx(ss_people).epsilon(1e-9));
  CHECK(found.condition.ss == Approx(ss_condition).epsilon(1e-9));
  CHECK(found.interaction.ss == Approx(ss_both).epsilon(1e-9));
  CHECK(found.interaction.ss_error == Approx(regression.rest()).epsilon(1e-9));
  CHECK((found.group.df1 == rank[1] && found.group.df2 == rank[2]));
  CHECK((found.condition.df1 == rank[3] && found.interaction.df1 == rank[4]));
  CHECK(found.condition.df2 ==
        static_cast<double>(table.values.n * table.values.k) - 1 - rank[1] - rank[2] - rank[3] - rank[4]);
  CHECK(found.interaction.f == Approx(ss_both / rank[4] / (regression.rest() / found.interaction.df2)).epsilon(1e-9));
}

TEST_CASE("sums of squares are those of a regression on dummies, equal groups and unequal", "[analysis][mixed]") {
  check_by_regression(random_groups({6, 6}, 3, 1));
  check_by_regression(random_groups({5, 8, 3}, 4, 2));
  check_by_regression(random_groups({2, 7}, 2, 3));
}

TEST_CASE("two groups under two conditions: the tests are pooled t tests", "[analysis][mixed]") {
  const GroupedTable table = random_groups({6, 6}, 2, 4);
  const MixedAnova found = mixed_anova(table);
  CHECK_FALSE(found.unequal);
  std::vector<double> mean[2], difference[2];
  for (std::size_t i = 0; i < table.values.n; ++i) {
    mean[table.group[i]].push_back((table.values.at(i, 0) + table.values.at(i, 1)) / 2);
    difference[table.group[i]].push_back(table.values.at(i, 0) - table.values.at(i, 1));
  }
  // Of groups of equal size Welch's t is the pooled one; its degrees of freedom differ.
  CHECK(found.group.f == Approx(std::pow(welch_t(mean[0], mean[1]).t, 2)).epsilon(1e-11));
  CHECK(found.interaction.f == Approx(std::pow(welch_t(difference[0], difference[1]).t, 2)).epsilon(1e-11));
  CHECK((found.epsilon_gg == 1 && found.epsilon_hf == 1));
  CHECK(found.interaction.p_gg == found.interaction.p);
}

TEST_CASE("the epsilons of identical groups are those of one group of the same covariance", "[analysis][mixed]") {
  const GroupedTable table = random_groups({9, 9}, 4, 5);
  GroupedTable twice = table;
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 0; j < 4; ++j) twice.values.values[(9 + i) * 4 + j] = table.values.at(i, j) + 50;
  WithinTable first{9, 4, {}};
  first.values.assign(table.values.values.begin(), table.values.values.begin() + 36);
  const MixedAnova found = mixed_anova(twice);
  const RepeatedMeasures alone = repeated_measures(first);
  CHECK(found.epsilon_gg == Approx(alone.effect.epsilon_gg).epsilon(1e-11));
  CHECK(found.condition.f == Approx(2 * alone.effect.f).epsilon(1e-11));
  CHECK(found.interaction.ss == Approx(0).margin(1e-9));
  CHECK(found.epsilon_hf == Approx((17 * 3 * found.epsilon_gg - 2) / (3 * (16 - 3 * found.epsilon_gg))).epsilon(1e-12));
  CHECK(found.condition.eta2_generalised ==
        Approx(found.condition.ss / (found.condition.ss + found.condition.ss_error + found.group.ss_error))
            .epsilon(1e-12));
}

TEST_CASE("a large offset costs no digits of the mixed analysis", "[analysis][mixed]") {
  GroupedTable table = random_groups({5, 4}, 3, 6);
  for (double& value : table.values.values) value = std::round(value * 16) / 16;
  const MixedAnova near = mixed_anova(table);
  for (double& value : table.values.values) value += 1e9;
  const MixedAnova far = mixed_anova(table);
  CHECK(far.unequal);
  CHECK(far.interaction.f == Approx(near.interaction.f).epsilon(1e-11));
  CHECK(far.group.f == Approx(near.group.f).epsilon(1e-11));
}

TEST_CASE("one value for each participant is a one-way analysis", "[analysis][mixed]") {
  GroupedTable table;  // means 2, 5, 8; squares within 2 each, between 54
  table.groups = 3;
  table.values = {9, 1, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  table.group = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  const MixedAnova found = mixed_anova(table);
  CHECK(found.group.f == Approx(27).epsilon(1e-13));
  CHECK((found.group.df1 == 2 && found.group.df2 == 6));
  CHECK(found.group.p == Approx(1e-3).epsilon(1e-12));  // (1 + F df1/df2)^(-df2/2) for df1 = 2
  CHECK(found.group.eta2_partial == Approx(0.9).epsilon(1e-13));
  CHECK(found.condition.status == StatisticStatus::too_few);
  CHECK(std::isnan(found.group.eta2_generalised));
}

TEST_CASE("what is undefined of groups and conditions has a status", "[analysis][mixed]") {
  CHECK(mixed_anova(random_groups({5}, 3, 7)).status == StatisticStatus::too_few);
  const MixedAnova single = mixed_anova(random_groups({1, 1}, 3, 8));
  CHECK((single.group.status == StatisticStatus::too_few && single.interaction.status == StatisticStatus::too_few));
  CHECK(std::isnan(single.condition.p));
  GroupedTable additive = random_groups({2, 2}, 2, 9);
  additive.values.values = {1, 2, 4, 5, 3, 9, 6, 12};
  const MixedAnova found = mixed_anova(additive);
  CHECK(found.interaction.status == StatisticStatus::no_variance);
  CHECK((std::isnan(found.interaction.f) && std::isnan(found.condition.p_gg) && std::isnan(found.epsilon_gg)));
  CHECK(found.group.status == StatisticStatus::ok);
}

}  // namespace
}  // namespace jnd
