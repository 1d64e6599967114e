#include "analysis/scaling/adjustment.h"

#include <algorithm>
#include <cmath>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

std::vector<double> settings_from(std::span<const Setting> settings, StartSide side) {
  std::vector<double> values;
  for (const Setting& setting : settings)
    if (setting.start == side) values.push_back(setting.value);
  return values;
}

// (n - 1) SD^2; 0 for one value.
double squares_of(const Moments& of) {
  return of.n > 1 ? (of.n - 1) * of.sd * of.sd : 0.0;
}

void test_start(Adjustment& result, const Moments& above, const Moments& below) {
  result.start_df = above.n + below.n - 2;
  if (result.start_df < 1) {
    result.start_test_status = StatisticStatus::too_few;
    return;
  }
  result.variable_error = std::sqrt((squares_of(above) + squares_of(below)) / result.start_df);
  result.jnd_within_side = kProbableError * result.variable_error;
  if (!(result.variable_error > 0)) {  // equal settings are equal doubles: no rounding comes in
    result.start_test_status = StatisticStatus::no_variance;
    return;
  }
  result.start_test_status = StatisticStatus::ok;
  const double se = result.variable_error * std::sqrt(1.0 / above.n + 1.0 / below.n);
  result.start_t = result.start_effect / se;
  result.start_p = student_t_two_sided(result.start_t, result.start_df);
}

// Where a JND is 0 its logarithm is not there, where it is undefined nothing of it is.
StatisticStatus status_of_logs(std::span<const Adjustment> participants) {
  const auto any = [&](auto is) { return std::any_of(participants.begin(), participants.end(), is); };
  if (any([](const Adjustment& one) { return std::isnan(one.jnd); })) return StatisticStatus::too_few;
  if (any([](const Adjustment& one) { return !(one.jnd > 0); })) return StatisticStatus::no_variance;
  return StatisticStatus::ok;
}

}  // namespace

Adjustment adjustment(std::span<const Setting> settings, double standard) {
  Adjustment result;
  std::vector<double> values;
  for (const Setting& setting : settings) values.push_back(setting.value);
  result.settings = mean_interval(values);
  result.constant_error = result.settings.mean - standard;
  result.jnd = kProbableError * result.settings.sd;
  result.weber = result.jnd / standard;
  const double half_df = 0.5 * (static_cast<double>(values.size()) - 1);
  result.jnd_low = result.jnd_high = kNaN;
  if (half_df > 0) {
    result.jnd_low = result.jnd * std::sqrt(half_df / boost::math::gamma_p_inv(half_df, 0.975));
    result.jnd_high = result.jnd * std::sqrt(half_df / boost::math::gamma_p_inv(half_df, 0.025));
  }
  result.mean_from_above = result.mean_from_below = result.start_effect = kNaN;
  result.variable_error = result.jnd_within_side = result.start_t = result.start_p = kNaN;
  const Moments above = moments(settings_from(settings, StartSide::above));
  const Moments below = moments(settings_from(settings, StartSide::below));
  if (above.n == 0 || below.n == 0) return result;
  result.start_status = StatisticStatus::ok;
  result.mean_from_above = above.mean;
  result.mean_from_below = below.mean;
  result.start_effect = above.mean - below.mean;
  test_start(result, above, below);
  return result;
}

AdjustmentGroup adjustment_group(std::span<const Adjustment> participants) {
  AdjustmentGroup group;
  std::vector<double> pse, constant_error, jnd, ln_jnd, start_effect;
  for (const Adjustment& one : participants) {
    pse.push_back(one.settings.mean);
    constant_error.push_back(one.constant_error);
    jnd.push_back(one.jnd);
    ln_jnd.push_back(one.jnd > 0 ? std::log(one.jnd) : kNaN);
    if (one.start_status == StatisticStatus::ok) start_effect.push_back(one.start_effect);
  }
  const double scale = largest_magnitude(pse);
  group.pse = mean_interval(pse);
  group.constant_error = mean_interval(constant_error);
  group.constant_error_test = mean_test(group.constant_error, scale);
  group.jnd = mean_interval(jnd);
  group.ln_jnd = mean_interval(ln_jnd);
  group.ln_jnd_status = status_of_logs(participants);
  group.jnd_geometric_mean = std::exp(group.ln_jnd.mean);
  group.jnd_geometric_ci_low = std::exp(group.ln_jnd.ci_low);
  group.jnd_geometric_ci_high = std::exp(group.ln_jnd.ci_high);
  group.start_effect = mean_interval(start_effect);
  group.start_effect_test = mean_test(group.start_effect, scale);
  group.start_status = start_effect.empty() ? StatisticStatus::not_applicable : StatisticStatus::ok;
  return group;
}

}  // namespace jnd
