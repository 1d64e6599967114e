// Two groups: R's documented data sets, enumeration of every split, and what is undefined.
#include "analysis/group/between_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "protocols/random_stream.h"
#include "tests/catch.h"

namespace jnd {
namespace {

// R's data set `sleep` (Student 1908, Cushny and Peebles): extra hours of sleep, drug 1 and drug 2.
const std::vector<double> kFirstDrug = {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
const std::vector<double> kSecondDrug = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};

TEST_CASE("Welch's t of the sleep data is R's", "[analysis][between]") {
  // R 4.2.2: t.test(extra ~ group, data = sleep), as its help page prints it.
  const WelchT found = welch_t(kFirstDrug, kSecondDrug);
  CHECK(found.status == StatisticStatus::ok);
  CHECK(found.t == Approx(-1.8608).margin(5e-5));
  CHECK(found.df == Approx(17.776).margin(5e-4));
  CHECK(found.p == Approx(0.07939).margin(5e-6));
  CHECK(found.ci_low == Approx(-3.3654832).margin(5e-8));
  CHECK(found.ci_high == Approx(0.2054832).margin(5e-8));
  CHECK(found.mean_difference == Approx(-1.58).epsilon(1e-14));
  const WelchT turned = welch_t(kSecondDrug, kFirstDrug);
  CHECK((turned.t == -found.t && turned.p == found.p && turned.ci_low == -found.ci_high));
}

TEST_CASE("Welch's t of equal sizes and variances is Student's", "[analysis][between]") {
  const std::vector<double> x = {1, 2, 3}, y = {4, 5, 6};
  const WelchT found = welch_t(x, y);
  CHECK(found.t == Approx(-3 / std::sqrt(2.0 / 3)).epsilon(1e-14));
  CHECK(found.df == Approx(4).epsilon(1e-14));
  CHECK(found.d == Approx(-3).epsilon(1e-14));
  // Student's t with 4 degrees of freedom in closed form.
  const double t = std::abs(found.t), cosine = 2 / std::sqrt(4 + t * t), sine = t / std::sqrt(4 + t * t);
  CHECK(found.p == Approx(1 - sine * (1 + cosine * cosine / 2)).epsilon(1e-12));
  std::vector<double> far_x, far_y;
  for (const double value : x) far_x.push_back(value + 1e9);
  for (const double value : y) far_y.push_back(value + 1e9);
  CHECK(welch_t(far_x, far_y).t == Approx(found.t).epsilon(1e-14));
}

TEST_CASE("Mann and Whitney's W and p are R's", "[analysis][between]") {
  // wilcox.test(extra ~ group, data = sleep): ties, so normal.
  const MannWhitney sleep = mann_whitney(kFirstDrug, kSecondDrug);
  CHECK(sleep.w == 25.5);
  CHECK((sleep.ties && !sleep.exact));
  CHECK(sleep.p == Approx(0.06933).margin(5e-6));
  // R's help page of wilcox.test, data of Hollander and Wolfe (1973): W = 35, one-sided p = 0.1272.
  const std::vector<double> x = {0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
  const std::vector<double> y = {1.15, 0.88, 0.90, 0.74, 1.21};
  const MannWhitney found = mann_whitney(x, y);
  CHECK((found.w == 35 && found.exact && !found.ties));
  CHECK(found.p == Approx(2 * 0.1272).margin(1e-4));
  CHECK(found.rank_biserial == Approx(2 * 35.0 / 50 - 1).epsilon(1e-14));
  CHECK((mann_whitney(y, x).w == 15 && mann_whitney(y, x).p == found.p));
}

// The share of all splits of the pooled values into two such groups whose W is as far on the same side.
double enumerated(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> all = x;
  all.insert(all.end(), y.begin(), y.end());
  const auto w_of = [&](const std::vector<int>& chosen) {
    double w = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = 0; j < all.size(); ++j)
        if (chosen[i] == 1 && chosen[j] == 0) w += all[i] > all[j] ? 1 : 0;
    return w;
  };
  std::vector<int> chosen(all.size(), 0);
  std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(x.size()), 1);
  const double w = w_of(chosen), middle = static_cast<double>(x.size() * y.size()) / 2;
  double as_far = 0, count = 0;
  std::sort(chosen.begin(), chosen.end());
  do {
    const double other = w_of(chosen);
    as_far += (w > middle ? other >= w : other <= w) ? 1 : 0;
    ++count;
  } while (std::next_permutation(chosen.begin(), chosen.end()));
  return std::min(1.0, 2 * as_far / count);
}

TEST_CASE("the exact p counts every split", "[analysis][between]") {
  RandomStream stream(5, 1, "between");
  for (int i = 0; i < 40; ++i) {
    std::vector<double> values(10), x, y;
    std::iota(values.begin(), values.end(), 1.0);
    stream.shuffle(values);
    const auto size = static_cast<std::ptrdiff_t>(1 + stream.below(8));
    x.assign(values.begin(), values.begin() + size);
    y.assign(values.begin() + size, values.end());
    const MannWhitney found = mann_whitney(x, y);
    CHECK(found.exact);
    CHECK(found.p == Approx(enumerated(x, y)).epsilon(1e-13));
  }
}

TEST_CASE("groups of 50 have a normal p near the exact one of 49", "[analysis][between]") {
  std::vector<double> x, y;
  for (int i = 0; i < 49; ++i) {
    x.push_back(2 * i);
    y.push_back(2 * i + 9);
  }
  const MannWhitney exact = mann_whitney(x, y);
  CHECK((exact.exact && std::isfinite(exact.p)));
  CHECK(exact.p == Approx(exact.p_normal).epsilon(0.03));
  x.push_back(98);
  CHECK_FALSE(mann_whitney(x, y).exact);
}

TEST_CASE("what is undefined between two groups has a status", "[analysis][between]") {
  const std::vector<double> one = {3}, none, same = {4, 4, 4}, other = {5, 5};
  CHECK(welch_t(one, same).status == StatisticStatus::too_few);
  CHECK(welch_t(one, same).mean_difference == -1);
  CHECK(welch_t(same, other).status == StatisticStatus::no_variance);
  CHECK(std::isnan(welch_t(same, other).t));
  CHECK(welch_t(same, kFirstDrug).status == StatisticStatus::ok);
  CHECK(mann_whitney(none, one).status == StatisticStatus::too_few);
  CHECK(mann_whitney(same, same).status == StatisticStatus::no_variance);
  CHECK((mann_whitney(same, same).w == 4.5 && std::isnan(mann_whitney(same, same).p)));
  CHECK(mann_whitney(one, std::vector{5.0, 6.0}).p == Approx(2.0 / 3).epsilon(1e-12));
  // Differences of decimals tie, whatever their binary forms: 0.1 + 0.2 is written 0.30000000000000004.
  CHECK(mann_whitney(std::vector{0.3, 0.5}, std::vector{0.3, 0.7}).ties);
}

}  // namespace
}  // namespace jnd
