// Tables of people and conditions: one and two factors within subjects, groups and conditions together, Friedman's ranks.
#include "analysis/group/repeated_measures.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <rapidcheck.h>

#include "analysis/group/between_groups.h"
#include "analysis/group/mixed_anova.h"
#include "analysis/group/post_hoc.h"
#include "analysis/group/rank_tests.h"
#include "analysis/numerics/special_values.h"
#include "protocols/random_stream.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Repeated measures against R (car, afex), arbitrary precision at four conditions, and what must not matter.

constexpr double kRelative = 1e-11, kAbsoluteP = 1e-12;

TEST_CASE("repeated measures agree with R", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const RepeatedMeasures found = repeated_measures(table_of(dataset["data"]));
    const WithinEffect& effect = found.effect;
    const auto& reference = dataset["rm_anova"];
    const auto near = [&](double value, const char* name) {
      INFO(name);
      CHECK(relative(value, reference[name]) <= kRelative);
    };
    const auto p_near = [&](double value, const nlohmann::json& p) {
      CHECK(std::abs(value - p.get<double>()) <= kAbsoluteP);
    };
    CHECK(found.status == StatisticStatus::ok);
    near(effect.ss, "SS_cond");
    near(effect.ss_error, "SS_error");
    near(found.ss_subjects, "SS_subjects");
    near(effect.f, "F");
    near(effect.df1, "df1");
    near(effect.df2, "df2");
    near(effect.epsilon_gg, "eps_gg");
    near(effect.epsilon_hf, "eps_hf");
    near(std::min(1.0, effect.epsilon_hf), "eps_hf_capped");
    near(1 / effect.df1, "eps_lower_bound");
    near(effect.eta2_partial, "eta2_partial");
    near(found.eta2_generalised, "eta2_generalized");
    near(found.eta2_generalised, "eta2");
    near(found.eta2_generalised, "afex_ges");
    near(effect.eta2_partial, "afex_pes");
    near(found.omega2_partial, "omega2_partial");
    near(found.cohen_f, "cohen_f");
    p_near(effect.p, reference["p"]);
    p_near(effect.p_gg, reference["p_gg"]);
    p_near(effect.p_hf, reference["p_hf"]);
    p_near(effect.p_lower_bound, reference["p_lb"]);
    const auto& car = reference["car"];
    CHECK(relative(effect.f, car["F"]) <= kRelative);
    CHECK(relative(effect.epsilon_gg, car["gg"]) <= kRelative);
    CHECK(relative(effect.epsilon_hf, car["hf"]) <= kRelative);
    CHECK(relative(effect.p, car["p"]) <= 1e-9);
    CHECK(relative(effect.p_gg, car["p_gg"]) <= 1e-9);
    CHECK(relative(effect.p_hf, car["p_hf"]) <= 1e-9);

    CHECK(effect.mauchly.status == StatisticStatus::ok);
    CHECK(relative(effect.mauchly.w, dataset["mauchly"]["W"]) <= kRelative);
    for (const char* name : {"p", "p_exact_k3", "p_chisq_first_order"})  // R's W itself is off by 5e-13
      CHECK(std::abs(effect.mauchly.p - dataset["mauchly"][name].get<double>()) <= 1e-11);

    const auto& manova = dataset["rm_manova"];
    CHECK(effect.hotelling_status == StatisticStatus::ok);
    CHECK(relative(effect.hotelling_t2, manova["T2"]) <= kRelative);
    CHECK(relative(effect.hotelling_f, manova["F"]) <= kRelative);
    CHECK(effect.hotelling_df1 == manova["df1"].get<double>());
    CHECK(effect.hotelling_df2 == manova["df2"].get<double>());
    p_near(effect.hotelling_p, manova["p"]);
  }
}

TEST_CASE("Mauchly of three conditions agrees with rational arithmetic", "[analysis]") {
  const std::vector<std::pair<double, double>> exact = {{0.83219580281379543645, 0.23004042895778522834},
                                                        {0.83892380481604406468, 0.41553976448586663671}};
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const Mauchly found = repeated_measures(table_of(group_reference().at("datasets")[i]["data"])).effect.mauchly;
    CHECK(relative(found.w, exact[i].first) <= 1e-14);
    CHECK(relative(found.p, exact[i].second) <= 1e-13);
  }
}

TEST_CASE("four conditions: Mauchly's second-order p and the epsilons", "[analysis]") {
  const auto& reference = group_reference().at("four_conditions");
  const WithinEffect effect = repeated_measures(table_of(reference["data"])).effect;
  CHECK(relative(effect.ss, reference["ss"]) <= kRelative);
  CHECK(relative(effect.ss_error, reference["ss_error"]) <= kRelative);
  CHECK(relative(effect.f, reference["f"]) <= kRelative);
  CHECK(relative(effect.epsilon_gg, reference["eps_gg"]) <= kRelative);
  CHECK(relative(effect.epsilon_hf, reference["eps_hf"]) <= kRelative);
  CHECK(relative(effect.mauchly.w, reference["mauchly_w"]) <= kRelative);
  CHECK(relative(effect.mauchly.p, reference["mauchly_p_r"]) <= kRelative);
  CHECK(relative(effect.p, reference["p"]) <= kRelative);
  CHECK(relative(effect.p_gg, reference["p_gg"]) <= kRelative);
  CHECK(relative(effect.p_hf, reference["p_hf"]) <= kRelative);
}

TEST_CASE("two conditions: F is t squared, and sphericity is no question", "[analysis]") {
  REQUIRE(rc::check("", [] {
    WithinTable table = random_table(2, 2, 30);
    table.k = 2;
    table.values.resize(2 * table.n);
    const RepeatedMeasures found = repeated_measures(table);
    const PairedT t = paired_t(table.column(0), table.column(1));
    RC_ASSERT(found.status == t.status);
    RC_PRE(t.status == StatisticStatus::ok);
    RC_ASSERT(std::abs(found.effect.f - t.t * t.t) <= 1e-10 * (1 + t.t * t.t));
    RC_ASSERT(std::abs(found.effect.p - t.p) < 1e-10);
    RC_ASSERT(found.effect.epsilon_gg == 1);
    RC_ASSERT(found.effect.epsilon_hf == 1);
    RC_ASSERT(found.effect.mauchly.status == StatisticStatus::not_applicable);
    RC_ASSERT(std::isnan(found.effect.mauchly.p));
  }));
}

TEST_CASE("repeated measures: unit, origin, participants' level and every order are irrelevant", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(3, 3, 30);
    const WithinEffect found = repeated_measures(table).effect;
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.epsilon_gg <= 1);
    RC_ASSERT(found.epsilon_gg * found.df1 >= 1 - 1e-12);
    WithinTable changed = permuted(table, random_order(table.n), random_order(table.k));
    for (std::size_t i = 0; i < table.n; ++i)
      for (std::size_t j = 0; j < table.k; ++j) {
        double& value = changed.values[i * table.k + j];
        value = 0.37 * value - 80 + 5.5 * static_cast<double>(i);
      }
    const WithinEffect again = repeated_measures(changed).effect;
    RC_ASSERT(std::abs(again.f - found.f) <= 1e-8 * (1 + found.f));
    RC_ASSERT(std::abs(again.p - found.p) < 1e-8);
    RC_ASSERT(std::abs(again.epsilon_gg - found.epsilon_gg) < 1e-9);
    RC_ASSERT(again.mauchly.status == found.mauchly.status);
    if (found.mauchly.status == StatisticStatus::ok) RC_ASSERT(std::abs(again.mauchly.w - found.mauchly.w) < 1e-9);
  }));
}

TEST_CASE("repeated measures: statuses where something is undefined", "[analysis]") {
  SECTION("too few") {
    const RepeatedMeasures found = repeated_measures({1, 3, {1, 2, 3}});
    CHECK(found.status == StatisticStatus::too_few);
    CHECK(std::isnan(found.effect.f));
    CHECK(std::isnan(found.effect.mauchly.w));
    CHECK(found.effect.df1 == 2);
  }
  SECTION("everybody differs alike: F is infinite or 0/0") {
    // 0.1 + 0.2 is not 0.3: the differences are equal up to rounding only.
    const RepeatedMeasures found = repeated_measures({3, 3, {0.1, 0.2, 0.3, 0.2, 0.3, 0.4, 0.7, 0.8, 0.9}});
    CHECK(found.status == StatisticStatus::no_variance);
    CHECK(std::isnan(found.effect.f));
    CHECK(std::isnan(found.effect.p_gg));
    CHECK(found.effect.mauchly.status == StatisticStatus::no_variance);
    CHECK(found.effect.eta2_partial == Approx(1).epsilon(1e-12));
    CHECK(repeated_measures({3, 3, {5, 5, 5, 5, 5, 5, 5, 5, 5}}).status == StatisticStatus::no_variance);
  }
  SECTION("two participants: one direction of variance") {
    const WithinEffect effect = repeated_measures({2, 3, {1, 2, 4, 2, 5, 3}}).effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.f > 0);
    CHECK(effect.epsilon_gg == Approx(0.5).epsilon(1e-12));
    CHECK(std::isnan(effect.epsilon_hf));
    CHECK(std::isnan(effect.p_hf));
    CHECK(effect.mauchly.status == StatisticStatus::too_few);
    CHECK(effect.hotelling_status == StatisticStatus::too_few);
  }
  SECTION("a condition that is the mean of the two others") {
    const WithinEffect effect = repeated_measures({5, 3, {1, 2, 3, 4, 6, 8, 2, 5, 8, 7, 7.5, 8, 3, 3, 3}}).effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.mauchly.status == StatisticStatus::singular);
    CHECK(std::isnan(effect.mauchly.w));
    CHECK(effect.hotelling_status == StatisticStatus::singular);
    CHECK(effect.epsilon_gg == Approx(0.5).epsilon(1e-12));
  }
}

TEST_CASE("repeated measures keep their digits where others cancel", "[analysis]") {
  const auto& dataset = group_reference().at("datasets")[0];
  const WithinTable table = table_of(dataset["data"]);
  SECTION("a spread of 1e-4 at 1e6") {
    // Scaled by a power of two, so that the differences survive the rounding of the sum as whole multiples.
    WithinTable near = table, far = table;
    for (double& value : near.values) value = std::round(value * 64) * 0x1p-26;
    for (std::size_t i = 0; i < far.values.size(); ++i) far.values[i] = 1e6 + near.values[i];
    const WithinEffect a = repeated_measures(near).effect, b = repeated_measures(far).effect;
    CHECK(relative(b.f, a.f) <= 1e-12);
    CHECK(relative(b.mauchly.w, a.mauchly.w) <= 1e-12);
  }
  SECTION("values near the limits of double") {
    for (const double unit : {0x1p-400, 0x1p400}) {
      WithinTable scaled = table;
      for (double& value : scaled.values) value *= unit;
      CHECK(relative(repeated_measures(scaled).effect.f, dataset["rm_anova"]["F"]) <= kRelative);
      CHECK(relative(repeated_measures(scaled).effect.epsilon_gg, dataset["rm_anova"]["eps_gg"]) <= kRelative);
    }
  }
  SECTION("p deep in the tail") {
    WithinTable sure{80, 3, {}};
    for (std::size_t i = 0; i < sure.n; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        sure.values.push_back(100.0 * static_cast<double>(j) + static_cast<double>((7 * i + 3 * j * i) % 5));
    const WithinEffect effect = repeated_measures(sure).effect;
    CHECK(effect.p > 0);
    CHECK(effect.p < 1e-200);
  }
}

TEST_CASE("Helmert contrasts are orthonormal", "[analysis]") {
  CHECK(helmert_contrasts(1).empty());
  for (const std::size_t k : {2U, 3U, 7U}) {
    const std::vector<double> c = helmert_contrasts(k);
    REQUIRE(c.size() == k * (k - 1));
    for (std::size_t r = 0; r + 1 < k; ++r) {
      double sum = 0;
      for (std::size_t j = 0; j < k; ++j) sum += c[r * k + j];
      CHECK(std::abs(sum) < 1e-14);
      for (std::size_t s = 0; s + 1 < k; ++s) {
        double product = 0;
        for (std::size_t j = 0; j < k; ++j) product += c[r * k + j] * c[s * k + j];
        CHECK(std::abs(product - (r == s ? 1 : 0)) < 1e-14);
      }
    }
  }
}

// Two factors within subjects against cell means in arbitrary precision, and the one-way cases inside.

TEST_CASE("two-way within agrees with sums of squares of cell means", "[analysis]") {
  const auto& reference = group_reference().at("two_way");
  TwoWayTable table{reference["data"].size(), reference["data"][0].size(), reference["data"][0][0].size(), {}};
  for (const auto& participant : reference["data"])
    for (const auto& row : participant)
      for (const auto& value : row) table.values.push_back(value);
  const TwoWayWithin found = two_way_within(table);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(relative(found.ss_subjects, reference["ss_subjects"]) <= 1e-11);
  const auto check = [&](const TwoWayEffect& one, const char* name) {
    CAPTURE(name);
    const auto& expected = reference[name];
    const WithinEffect& effect = one.effect;
    CHECK(effect.status == StatisticStatus::ok);
    CHECK(effect.df1 == expected["df1"].get<double>());
    CHECK(effect.df2 == expected["df2"].get<double>());
    CHECK(relative(effect.ss, expected["ss"]) <= 1e-11);
    CHECK(relative(effect.ss_error, expected["ss_error"]) <= 1e-11);
    CHECK(relative(effect.f, expected["f"]) <= 1e-11);
    CHECK(relative(effect.p, expected["p"]) <= 1e-10);
    CHECK(relative(effect.epsilon_gg, expected["eps_gg"]) <= 1e-11);
    CHECK(relative(effect.epsilon_hf, expected["eps_hf"]) <= 1e-11);
    CHECK(relative(effect.p_gg, expected["p_gg"]) <= 1e-10);
    CHECK(relative(effect.p_hf, expected["p_hf"]) <= 1e-10);
    CHECK(relative(effect.mauchly.w, expected["mauchly_w"]) <= 1e-9);
    CHECK(relative(effect.eta2_partial, expected["eta2_partial"]) <= 1e-11);
    CHECK(relative(one.eta2_generalised, expected["eta2_generalised"]) <= 1e-11);
  };
  check(found.a, "a");
  check(found.b, "b");
  check(found.ab, "ab");
}

TEST_CASE("a main effect is the one-way analysis of the means over the other factor", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const std::size_t n = *rc::gen::inRange<std::size_t>(2, 9), a = *rc::gen::inRange<std::size_t>(2, 5);
    const std::size_t b = *rc::gen::inRange<std::size_t>(2, 4);
    TwoWayTable table{n, a, b, {}}, swapped{n, b, a, {}};
    for (std::size_t i = 0; i < n * a * b; ++i) table.values.push_back(*rc::gen::inRange(0, 50));
    WithinTable means{n, a, {}};
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < a; ++j) {
        double sum = 0;
        for (std::size_t l = 0; l < b; ++l) sum += table.values[(i * a + j) * b + l];
        means.values.push_back(sum / static_cast<double>(b));
      }
      for (std::size_t l = 0; l < b; ++l)
        for (std::size_t j = 0; j < a; ++j) swapped.values.push_back(table.values[(i * a + j) * b + l]);
    }
    const TwoWayWithin found = two_way_within(table), mirrored = two_way_within(swapped);
    const WithinEffect one_way = repeated_measures(means).effect;
    RC_PRE(one_way.status == StatisticStatus::ok && found.ab.effect.status == StatisticStatus::ok);
    RC_ASSERT(std::abs(found.a.effect.f - one_way.f) <= 1e-9 * (1 + one_way.f));
    RC_ASSERT(std::abs(found.a.effect.epsilon_gg - one_way.epsilon_gg) < 1e-9);
    RC_ASSERT(std::abs(found.a.effect.ss - static_cast<double>(b) * one_way.ss) <= 1e-9 * (1 + found.a.effect.ss));
    RC_ASSERT(std::abs(mirrored.b.effect.f - found.a.effect.f) <= 1e-9 * (1 + one_way.f));
    RC_ASSERT(std::abs(mirrored.ab.effect.f - found.ab.effect.f) <= 1e-9 * (1 + found.ab.effect.f));
    // The sums of squares are all there is.
    double mean = 0, total = 0;
    for (const double value : table.values) mean += value / static_cast<double>(table.values.size());
    for (const double value : table.values) total += (value - mean) * (value - mean);
    double parts = found.ss_subjects;
    for (const TwoWayEffect* one : {&found.a, &found.b, &found.ab}) parts += one->effect.ss + one->effect.ss_error;
    RC_ASSERT(std::abs(parts - total) <= 1e-10 * total);
  }));
}

TEST_CASE("two-way within: too few, and no variance", "[analysis]") {
  CHECK(two_way_within({1, 2, 2, {1, 2, 3, 4}}).status == StatisticStatus::too_few);
  CHECK(two_way_within({2, 1, 2, {1, 2, 3, 4}}).status == StatisticStatus::too_few);
  CHECK(std::isnan(two_way_within({1, 2, 2, {1, 2, 3, 4}}).ab.effect.f));
  const TwoWayWithin additive = two_way_within({3, 2, 2, {1, 2, 3, 4, 3, 4, 5, 6, 9, 10, 11, 12}});
  CHECK(additive.status == StatisticStatus::ok);
  CHECK(additive.a.effect.status == StatisticStatus::no_variance);
  CHECK(additive.ab.effect.status == StatisticStatus::no_variance);
  CHECK(std::isnan(additive.ab.effect.p));
}

// Groups and conditions together: a second computation by regression on dummy variables, and the tests that it must agree
// with where there are two groups or two conditions.

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

// Friedman's test against R, and its edges.

TEST_CASE("Friedman agrees with R, with and without ties", "[analysis]") {
  for (const auto& dataset : group_reference().at("datasets")) {
    CAPTURE(dataset["id"].dump());
    const auto& reference = dataset["friedman"];
    const Friedman found = friedman(table_of(dataset["data"]));
    CHECK(found.status == StatisticStatus::ok);
    CHECK(relative(found.chi2, reference["chi2"]) <= 1e-12);
    CHECK(found.df == reference["df"].get<int>());
    CHECK(std::abs(found.p - reference["p"].get<double>()) <= 1e-12);
    CHECK(relative(found.kendall_w, reference["kendall_W"]) <= 1e-12);
    CHECK(relative(found.f_iman_davenport, reference["F_iman_davenport"]) <= 1e-12);
    CHECK(std::abs(found.p_iman_davenport - reference["p_iman_davenport"].get<double>()) <= 1e-12);
  }
}

TEST_CASE("Friedman: perfect agreement, no agreement, nothing to rank", "[analysis]") {
  WithinTable alike{4, 3, {1, 2, 3, 1, 2, 3, 5, 6, 7, 1, 8, 9}};
  CHECK(friedman(alike).kendall_w == Approx(1).epsilon(1e-15));
  CHECK(std::isinf(friedman(alike).f_iman_davenport));
  CHECK(friedman(alike).p_iman_davenport == 0);
  const WithinTable balanced{3, 3, {1, 2, 3, 2, 3, 1, 3, 1, 2}};
  CHECK(friedman(balanced).chi2 == 0);
  CHECK(friedman(balanced).p == 1);
  const WithinTable tied{3, 3, {1, 1, 1, 2, 2, 2, 3, 3, 3}};
  CHECK(friedman(tied).status == StatisticStatus::no_variance);
  CHECK(std::isnan(friedman(tied).chi2));
  CHECK(friedman({1, 3, {1, 2, 3}}).status == StatisticStatus::too_few);
  CHECK(friedman({3, 1, {1, 2, 3}}).status == StatisticStatus::too_few);
  CHECK(friedman({0, 0, {}}).status == StatisticStatus::too_few);
}

TEST_CASE("Friedman sees only the order within each participant", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const WithinTable table = random_table(2, 2, 5);
    const Friedman found = friedman(table);
    RC_PRE(found.status == StatisticStatus::ok);
    RC_ASSERT(found.kendall_w >= 0);
    RC_ASSERT(found.kendall_w <= 1 + 1e-12);
    WithinTable changed = table;  // each participant with an own origin and unit
    for (std::size_t i = 0; i < table.n; ++i)
      for (std::size_t j = 0; j < table.k; ++j)
        changed.values[i * table.k + j] = 100.0 * static_cast<double>(i) + std::exp(table.at(i, j));
    RC_ASSERT(friedman(changed).chi2 == found.chi2);
    const Friedman moved = friedman(permuted(table, random_order(table.n), random_order(table.k)));
    RC_ASSERT(relative(moved.chi2, found.chi2) < 1e-12);
  }));
}

}  // namespace
}  // namespace jnd
