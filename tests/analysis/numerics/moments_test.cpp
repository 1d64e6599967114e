// Moments, ranks and tail probabilities: what every group statistic stands on.
#include "analysis/numerics/moments.h"

#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/ranks.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "tests/analysis/group_fixture.h"
#include "tests/catch.h"

namespace jnd {
namespace {

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

}  // namespace
}  // namespace jnd
