#include "analysis/scaling/mean_interval.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

MeanInterval mean_interval(std::span<const double> values) {
  MeanInterval result;
  result.n = static_cast<int>(values.size());
  result.mean = result.sd = result.se = result.ci_low = result.ci_high = kNaN;
  result.status = StatisticStatus::too_few;
  if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) return result;
  const Moments of = moments(values);
  result.mean = of.mean;
  if (of.n < 2) return result;
  result.status = StatisticStatus::ok;
  const double n = of.n;
  result.sd = of.sd;
  result.se = of.sd / std::sqrt(n);
  const double half_width = student_t_quantile_two_sided(0.05, n - 1) * result.se;
  result.ci_low = of.mean - half_width;
  result.ci_high = of.mean + half_width;
  return result;
}

MeanTest mean_test(const MeanInterval& of, double scale) {
  MeanTest test{kNaN, kNaN, of.status};
  if (of.status != StatisticStatus::ok) return test;
  if (only_rounding(of.se, scale)) {
    test.status = StatisticStatus::no_variance;
    return test;
  }
  test.t = of.mean / of.se;
  test.p = student_t_two_sided(test.t, of.n - 1.0);
  return test;
}

}  // namespace jnd
