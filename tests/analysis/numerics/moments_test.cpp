// Moments, ranks and proportions: what every group statistic stands on.
#include "analysis/numerics/moments.h"

#include <cmath>
#include <vector>

#include <rapidcheck.h>

#include "analysis/group/questionnaire.h"
#include "analysis/group/rank_tests.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// Moments, ranks and tail probabilities: what every group statistic stands on.

TEST_CASE("moments of few, far and extreme values", "[analysis]") {
  CHECK(std::isnan(moments({}).mean));
  const std::vector<double> one = {3}, far = {1e6, 1e6 + 0x1p-30, 1e6 + 0x1p-29}, huge = {-1e300, 1e300},
                            tiny = {1e-300, 3e-300}, equal(5, 0.1);
  CHECK(moments(one).mean == 3);
  CHECK(std::isnan(moments(one).sd));
  CHECK(moments(far).sd == 0x1p-30);
  CHECK(moments(huge).mean == 0);
  CHECK(moments(huge).sd == Approx(1e300 * std::sqrt(2.0)).epsilon(1e-14));
  CHECK(moments(tiny).sd == Approx(1e-300 * std::sqrt(2.0)).epsilon(1e-14));
  CHECK(moments(equal).sd == 0);
  CHECK(moments(equal).mean == 0.1);
}

TEST_CASE("medians", "[analysis]") {
  const std::vector<double> odd = {5, 1, 3}, even = {1e300, 1, 2, 1e300}, apart = {-4, 6};
  CHECK(std::isnan(median_of({})));
  CHECK(median_of(odd) == 3);
  CHECK(median_of(even) == 5e299);
  CHECK(median_of(apart) == 1);
}

TEST_CASE("only rounding, or a spread", "[analysis]") {
  CHECK(only_rounding(0, 0));
  CHECK(only_rounding(1e-16, 1));
  CHECK_FALSE(only_rounding(1e-14, 1));
  CHECK(only_rounding(1e-10, 1e6));
  CHECK(only_rounding(std::nan(""), 1));
}

TEST_CASE("midranks share their places", "[analysis]") {
  const std::vector<double> values = {3, 1, 3, 2, 3, 1};
  const Ranks found = midranks(values);
  CHECK(found.ranks == std::vector<double>{5, 1.5, 5, 3, 5, 1.5});
  CHECK(found.tie_sum == 24 + 6);
  CHECK(midranks({}).ranks.empty());
}

TEST_CASE("tails of t, F and chi squared", "[analysis]") {
  // Closed forms: t at 1 and 2 degrees of freedom, F at (2, 4), chi squared at 2.
  for (const double t : {1e-8, 0.5, 3.0, 1e5, 1e200})
    CHECK(relative(student_t_two_sided(t, 1), 2 * std::atan(1 / t) / 3.14159265358979323846) <= 1e-14);
  for (const double t : {0.5, 3.0, 1e5})
    CHECK(relative(student_t_two_sided(t, 2), 2 / (2 + t * t) / (1 + t / std::sqrt(2 + t * t))) <= 1e-14);
  for (const double f : {0.1, 2.0, 1e6, 1e100}) CHECK(relative(f_upper(f, 2, 4), std::pow(1 + f / 2, -2)) <= 1e-13);
  for (const double x : {0.1, 7.0, 1300.0}) CHECK(relative(chi2_upper(x, 2), std::exp(-x / 2)) <= 1e-13);
  // t^2 overflows before p vanishes: by the power law of the tail.
  CHECK(relative(student_t_two_sided(1e101, 3), 1e-3 * student_t_two_sided(1e100, 3)) <= 1e-12);
  CHECK(relative(student_t_two_sided(1e170, 1.5), 1e-120 * student_t_two_sided(1e90, 1.5)) <= 1e-12);
  CHECK(relative(f_upper(1e-16, 1, 1), 2 * std::atan(1e8) / 3.14159265358979323846) <= 1e-14);
  CHECK(student_t_two_sided(0, 5) == 1);
  CHECK(student_t_two_sided(kInf, 5) == 0);
  CHECK(relative(student_t_two_sided(1.959963984540054, kInf), 0.05) <= 1e-14);
  CHECK(relative(student_t_quantile_two_sided(0.05, kInf), 1.959963984540054) <= 1e-14);
  CHECK(student_t_quantile_two_sided(0, 3) == kInf);
  CHECK(student_t_quantile_two_sided(1, 3) == 0);
  CHECK(f_upper(0, 2, 3) == 1);
  CHECK(f_upper(kInf, 2, 3) == 0);
  CHECK(chi2_upper(0, 3) == 1);
  for (const double bad : {f_upper(1, 0, 3), chi2_upper(1, -1), student_t_two_sided(1, 0),
                           student_t_quantile_two_sided(2, 3), f_upper(std::nan(""), 1, 1)})
    CHECK(std::isnan(bad));
}

TEST_CASE("the quantile of t is the inverse of its tail", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const double df = *rc::gen::inRange(100, 20'000) / 100.0, t = *rc::gen::inRange(1, 3000) / 100.0;
    RC_ASSERT(relative(student_t_quantile_two_sided(student_t_two_sided(t, df), df), t) < 1e-8);
  }));
}

// Clopper and Pearson's interval: closed forms at the ends, R's binom.test between them.

TEST_CASE("at the ends the exact interval has a closed form", "[analysis]") {
  for (const int n : {1, 5, 12, 200}) {
    const ExactProportion all = exact_proportion(n, n), none = exact_proportion(0, n);
    CHECK(all.share == 1);
    CHECK(all.ci_high == 1);
    CHECK(all.ci_low == Approx(std::pow(0.025, 1.0 / n)).epsilon(1e-12));
    CHECK(none.share == 0);
    CHECK(none.ci_low == 0);
    CHECK(none.ci_high == Approx(1 - std::pow(0.025, 1.0 / n)).epsilon(1e-12));
  }
}

TEST_CASE("between the ends it is binom.test's", "[analysis]") {
  const ExactProportion three = exact_proportion(3, 10);
  CHECK(three.ci_low == Approx(0.06673951117773447).epsilon(1e-12));
  CHECK(three.ci_high == Approx(0.6524528500599972).epsilon(1e-12));
  const ExactProportion half = exact_proportion(6, 12, 0.9);
  CHECK(half.ci_low == Approx(1 - half.ci_high).epsilon(1e-12));
  CHECK(half.ci_low > exact_proportion(6, 12).ci_low);
}

TEST_CASE("nobody gives no share and the widest interval", "[analysis]") {
  const ExactProportion nobody = exact_proportion(0, 0);
  CHECK(std::isnan(nobody.share));
  CHECK(nobody.ci_low == 0);
  CHECK(nobody.ci_high == 1);
}

// Ranks and ties of measured decimals: what R finds on whole multiples of their unit, whatever the unit.

using Numbers = std::vector<double>;

// Hollander and Wolfe 1973, p. 140 (R: example(friedman.test)): times to round first base, three methods.
const WithinTable kRounding = {
    22, 3, {5.40, 5.50, 5.55, 5.85, 5.70, 5.75, 5.20, 5.60, 5.50, 5.55, 5.50, 5.40, 5.90, 5.85, 5.70, 5.45, 5.55,
            5.60, 5.40, 5.40, 5.35, 5.45, 5.50, 5.35, 5.25, 5.15, 5.00, 5.85, 5.80, 5.70, 5.25, 5.20, 5.10, 5.65,
            5.55, 5.45, 5.60, 5.35, 5.45, 5.05, 5.00, 4.95, 5.50, 5.50, 5.40, 5.45, 5.55, 5.50, 5.55, 5.55, 5.35,
            5.45, 5.50, 5.55, 5.50, 5.45, 5.25, 5.65, 5.60, 5.40, 5.70, 5.65, 5.55, 6.30, 6.30, 6.25}};
// R: MASS::shoes, and MASS::anorexia under cognitive behavioural treatment.
const Numbers kShoesA = {13.2, 8.2, 10.9, 14.3, 10.7, 6.6, 9.5, 10.8, 8.8, 13.3};
const Numbers kShoesB = {14.0, 8.8, 11.2, 14.2, 11.8, 6.4, 9.8, 11.3, 9.3, 13.6};
const Numbers kBefore = {80.5, 84.9, 81.5, 82.6, 79.9, 88.7, 94.9, 76.3, 81,   80.5, 85,   89.2, 81.3, 76.5, 70,
                         80.4, 83.3, 83,   87.7, 84.2, 86.4, 76.5, 80.2, 87.8, 83.3, 79.7, 84.5, 80.8, 87.4};
const Numbers kAfter = {82.2, 85.6, 81.4, 81.9, 76.4, 103.6, 98.4, 93.4, 73.4,  82.1, 96.7, 95.3, 82.4, 72.5, 90.9,
                        71.3, 85.4, 81.6, 89.1, 83.9, 82.7,  75.7, 82.6, 100.4, 85.2, 83.6, 84.6, 96.2, 86.7};

// A measurement in another unit: each value is rounded once, in three different ways.
enum class Unit { same, thousandfold, third, seventh };
Numbers in(Unit unit, Numbers values) {
  for (double& value : values) {
    if (unit == Unit::thousandfold) value *= 1000;
    if (unit == Unit::third) value *= 1.0 / 3;
    if (unit == Unit::seventh) value /= 7;
  }
  return values;
}

void check(const Numbers& x, const Numbers& y, double v, double p_normal) {
  for (const Unit unit : {Unit::same, Unit::thousandfold, Unit::third, Unit::seventh}) {
    CAPTURE(static_cast<int>(unit), v);
    const SignedRank found = signed_rank(in(unit, x), in(unit, y));
    CHECK(found.v == v);
    CHECK(found.ties);
    CHECK_FALSE(found.exact);
    CHECK(std::abs(found.p - p_normal) <= 1e-12);
    // The whole multiples of the hundredth have no rounding.
    Numbers whole_x, whole_y;
    for (const double value : x) whole_x.push_back(std::round(100 * value));
    for (const double value : y) whole_y.push_back(std::round(100 * value));
    const SignedRank whole = signed_rank(whole_x, whole_y);
    CHECK(found.zeros == whole.zeros);
    CHECK(found.p_exact_permutation == whole.p_exact_permutation);
    CHECK(found.rank_biserial == whole.rank_biserial);
    const PrattSignedRank pratt = pratt_signed_rank(in(unit, x), in(unit, y)),
                          expected = pratt_signed_rank(whole_x, whole_y);
    CHECK(pratt.z == expected.z);
    CHECK(pratt.p_exact_permutation == expected.p_exact_permutation);
  }
}

TEST_CASE("signed ranks of decimals are R's of whole multiples, in every unit", "[analysis]") {
  check(kRounding.column(0), kRounding.column(1), 103, 0.448962218571282);
  check(kRounding.column(0), kRounding.column(2), 199, 0.0187131395384343);
  check(kRounding.column(1), kRounding.column(2), 222.5, 0.00170654358003479);
  check(kShoesA, kShoesB, 3, 0.0141163887498624);
  check(kBefore, kAfter, 130.5, 0.0613742460144592);
  // R: example(wilcox.test), with digits.rank = 9.
  check({0.4, 0.3, 0.2}, {0.3, 0.2, 0.1}, 6, 0.148914673178766);
}

TEST_CASE("Friedman's ties are those of decimals, in every unit", "[analysis]") {
  for (const Unit unit : {Unit::same, Unit::thousandfold, Unit::third, Unit::seventh}) {
    const Friedman found = friedman({kRounding.n, kRounding.k, in(unit, kRounding.values)});
    CHECK(relative(found.chi2, 11.1428571428571) <= 1e-12);
    CHECK(relative(found.p, 0.00380504077551136) <= 1e-12);
  }
  // Means of three ratings: equal, but for the order in which they were added.
  const double up = (0.1 + 0.2 + 0.3) / 3, down = (0.3 + 0.2 + 0.1) / 3;
  REQUIRE(up != down);
  CHECK(friedman({2, 2, {up, down, 5, 5}}).status == StatisticStatus::no_variance);
}

TEST_CASE("a questionnaire's pairs tie as decimals", "[analysis]") {
  const std::vector<PairedItem> items = {{"force", {3, 2, {0.4, 0.3, 0.3, 0.2, 0.2, 0.1}}}};
  CHECK(paired_questionnaire(items).items[0].pairs[0].test.ties);
}

TEST_CASE("what differs in the fifteenth digit differs", "[analysis]") {
  CHECK(decimal_places(Numbers{9.99999999999999, 9.99999999999998, 9.99999999999999}) == std::vector<int>{1, 0, 1});
  const Numbers x = {9.99999999999999, 9.99999999999998, 9.99999999999999, 1e10, 1e10};
  const Numbers y = {1, 1, 1.00000000000001, 1.00000000000001, 1.00000000000002};
  // Differences of numbers that may have been rounded to 15 digits are known less well.
  CHECK(decimal_difference_places(x, y) == std::vector<int>{1, 1, 1, 2, 2});
  // Too far apart for one unit: each within its own rounding.
  const Numbers far_x = {1e100, 3e-100, 5e-100, 1e100, 7}, far_y = {0, 1e-100, 3e-100, 1, 7};
  CHECK(decimal_difference_places(far_x, far_y) == std::vector<int>{2, 1, 1, 2, 0});
  CHECK(decimal_difference_places(Numbers{0.1 + 0.2, 1}, Numbers{0.3, 2}) == std::vector<int>{0, -1});
  CHECK(decimal_difference_places(Numbers{}, Numbers{}).empty());
  CHECK(decimal_places(Numbers{-0.0, 0.0, 5e-324, -1e300, 1e300}) == std::vector<int>{1, 1, 2, 0, 3});
}

TEST_CASE("fractions written with 15, 16 or 17 digits tie as fractions do", "[analysis]") {
  for (const double unit : {1.0, 100.0, 0.001}) {
    for (const int whole : {3, 6, 7, 9, 11, 12, 13, 17, 60}) {
      CAPTURE(unit, whole);
      Numbers multiples_x, multiples_y, x, y, written_x, written_y;
      for (int i = 0; i < 60; ++i) {
        multiples_x.push_back(i * 7 % 61);
        multiples_y.push_back(i * 5 % 59);
        x.push_back(multiples_x.back() * unit / whole);
        y.push_back(multiples_y.back() * unit / whole);
        written_x.push_back(plain_decimal(x.back()));
        written_y.push_back(plain_decimal(y.back()));
      }
      const std::vector<int> places = decimal_difference_places(multiples_x, multiples_y);
      CHECK(decimal_difference_places(x, y) == places);
      CHECK(decimal_difference_places(written_x, written_y) == places);
      CHECK(decimal_places(written_x) == decimal_places(multiples_x));
    }
  }
}

TEST_CASE("sums of decimals are the decimals that they stand for", "[analysis]") {
  CHECK(plain_decimal(0.1 + 0.2) == 0.3);
  CHECK(plain_decimal(1.0 / 3) == 0.333333333333333);
  for (const double kept : {0.0, 0.3, -2.5, 900.0, 1e300, 5e-324, 123456789012345.0})
    CHECK(plain_decimal(kept) == kept);
  CHECK(plain_sum(0.3, -0.2) == 0.1);
  CHECK(plain_sum(1.1, -1) == 0.1);
  CHECK(plain_sum(1000.1, -1000) == 0.1);
  CHECK(plain_sum(0.1 + 0.2, -0.3) == 0);
  CHECK(plain_sum(-0.2, 0.3) == 0.1);
  CHECK(plain_distance(0.3, 0.1) == 0.2);
  double level = 10;
  for (int step = 0; step < 99; ++step) level = plain_sum(level, -0.1);
  CHECK(level == 0.1);
}

TEST_CASE("the places of decimals are those of their whole multiples", "[analysis]") {
  REQUIRE(rc::check("", [] {
    const int decimals = *rc::gen::inRange(0, 12);
    const int largest = *rc::gen::element(5, 100, 100'000);
    const int n = *rc::gen::inRange(0, 30);
    Numbers whole_x, whole_y, x, y, third_x, third_y;
    for (int i = 0; i < n; ++i) {
      whole_x.push_back(*rc::gen::inRange(-largest, largest));
      whole_y.push_back(*rc::gen::inRange(-largest, largest));
      x.push_back(whole_x.back() / std::pow(10, decimals));
      y.push_back(whole_y.back() / std::pow(10, decimals));
      third_x.push_back(x.back() / 3);
      third_y.push_back(y.back() / 3);
    }
    const std::vector<int> places = decimal_difference_places(whole_x, whole_y);
    RC_ASSERT(decimal_difference_places(x, y) == places);
    RC_ASSERT(decimal_difference_places(third_x, third_y) == places);
    RC_ASSERT(decimal_places(x) == decimal_places(whole_x));
    RC_ASSERT(decimal_places(third_x) == decimal_places(whole_x));
  }));
}

}  // namespace
}  // namespace jnd
