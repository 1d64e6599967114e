#include "analysis/group/post_hoc.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/studentised_range.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

PairedT paired_t(std::span<const double> x, std::span<const double> y) {
  const double df = static_cast<double>(std::min(x.size(), y.size())) - 1;
  return paired_t(x, y, df > 0 ? student_t_quantile_two_sided(0.05, df) : kNaN);
}

PairedT paired_t(std::span<const double> x, std::span<const double> y, double t_quantile) {
  PairedT result;
  std::vector<double> differences(std::min(x.size(), y.size()));
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i] = x[i] - y[i];
  const Moments of = moments(differences);
  result.n = of.n;
  result.mean_difference = of.mean;
  result.t = result.df = result.p = result.ci_low = result.ci_high = result.dz = result.d_av = kNaN;
  if (of.n < 2) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  result.df = of.n - 1;
  const double se = of.sd / std::sqrt(static_cast<double>(of.n));
  if (only_rounding(se, std::max(largest_magnitude(x), largest_magnitude(y)))) {
    result.status = StatisticStatus::no_variance;
    return result;
  }
  result.t = of.mean / se;
  result.p = student_t_two_sided(result.t, result.df);
  const double half_width = t_quantile * se;
  result.ci_low = of.mean - half_width;
  result.ci_high = of.mean + half_width;
  result.dz = of.mean / of.sd;
  result.d_av = of.mean / (std::hypot(moments(x).sd, moments(y).sd) / std::sqrt(2.0));
  return result;
}

GamesHowell games_howell(std::span<const double> x, std::span<const double> y, int groups) {
  GamesHowell result;
  result.q = result.df = result.p = result.se = kNaN;
  const Moments of_x = moments(x), of_y = moments(y);
  if (of_x.n < 2 || of_y.n < 2) {
    result.status = StatisticStatus::too_few;
    return result;
  }
  const double se_x = of_x.sd / std::sqrt(static_cast<double>(of_x.n));
  const double se_y = of_y.sd / std::sqrt(static_cast<double>(of_y.n));
  result.se = std::hypot(se_x, se_y);
  if (only_rounding(result.se, std::max(largest_magnitude(x), largest_magnitude(y)))) {
    result.status = StatisticStatus::no_variance;
    return result;
  }
  // Welch and Satterthwaite, by each mean's share of the variance.
  const double share_x = (se_x / result.se) * (se_x / result.se), share_y = (se_y / result.se) * (se_y / result.se);
  result.df = 1 / (share_x * share_x / (of_x.n - 1) + share_y * share_y / (of_y.n - 1));
  result.q = std::abs(of_x.mean - of_y.mean) / (result.se / std::sqrt(2.0));
  result.p = studentised_range_upper(result.q, groups, result.df);
  return result;
}

double games_howell_half_width(const GamesHowell& test, int groups) {
  if (test.status != StatisticStatus::ok) return kNaN;
  return studentised_range_quantile_upper(0.05, groups, test.df) * test.se / std::sqrt(2.0);
}

Tukey tukey(double mean_difference, double mean_square_error, double n, double df, int groups) {
  Tukey result;
  result.q = result.p = kNaN;
  if (!(n >= 2) || !(df >= 1)) {
    result.status = StatisticStatus::too_few;
  } else if (!(mean_square_error > 0)) {
    result.status = StatisticStatus::no_variance;
  } else {
    result.q = std::abs(mean_difference) / std::sqrt(mean_square_error / n);
    result.p = studentised_range_upper(result.q, groups, df);
  }
  return result;
}

}  // namespace jnd
