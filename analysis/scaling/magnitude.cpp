#include "analysis/scaling/magnitude.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

using Logs = std::vector<double>;

std::vector<RefusedAnswer> not_positive(const MagnitudeEstimates& estimates) {
  std::vector<RefusedAnswer> refused;
  for (std::size_t p = 0; p < estimates.answers.size(); ++p)
    for (std::size_t i = 0; i < estimates.answers[p].size(); ++i)
      for (std::size_t r = 0; r < estimates.answers[p][i].size(); ++r)
        if (const double answer = estimates.answers[p][i][r]; !(answer > 0))
          refused.push_back({p + 1, i + 1, r + 1, answer});
  return refused;
}

// Mean of the logarithms of the repeats, for each stimulus.
Logs log_cells(const std::vector<std::vector<double>>& answers) {
  Logs cells, logs;
  for (const std::vector<double>& repeats : answers) {
    logs.clear();
    for (const double answer : repeats) logs.push_back(std::log(answer));
    cells.push_back(moments(logs).mean);
  }
  return cells;
}

std::vector<double> exponentials(const Logs& logs, double shift = 0) {
  std::vector<double> values;
  for (const double log : logs) values.push_back(std::exp(log + shift));
  return values;
}

// Sums of squares and products about the means.
struct Deviations {
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
};

Deviations deviations_of(const Logs& x, const Logs& y) {
  Deviations sums;
  sums.mean_x = moments(x).mean;
  sums.mean_y = moments(y).mean;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - sums.mean_x, dy = y[i] - sums.mean_y;
    sums.xx += dx * dx;
    sums.xy += dx * dy;
    sums.yy += dy * dy;
  }
  return sums;
}

double squared_residuals(const Logs& x, const Logs& y, const Deviations& sums, double slope) {
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - sums.mean_y - slope * (x[i] - sums.mean_x);
    squares += off * off;
  }
  return squares;
}

void add_interval(PowerLaw& law, double squares, double xx, double df) {
  law.interval_status = StatisticStatus::ok;
  law.residual_sd = std::sqrt(squares / df);
  law.se = law.residual_sd / std::sqrt(xx);
  const double half_width = student_t_quantile_two_sided(0.05, df) * law.se;
  law.ci_low = law.exponent - half_width;
  law.ci_high = law.exponent + half_width;
}

}  // namespace

PowerLaw power_law(const std::vector<double>& ln_stimulus, const std::vector<double>& ln_answer) {
  PowerLaw law;
  law.exponent = law.intercept = law.se = law.ci_low = law.ci_high = law.r2 = law.residual_sd = kNaN;
  law.status = law.interval_status = law.r2_status = StatisticStatus::too_few;
  const std::size_t n = ln_stimulus.size();
  if (n < 2) return law;
  law.status = StatisticStatus::ok;
  const Deviations sums = deviations_of(ln_stimulus, ln_answer);
  // Answers that are alike up to the rounding of their logarithms have no slope, and nothing that r2 could be a share of.
  const bool alike = only_rounding(std::sqrt(sums.yy), largest_magnitude(ln_answer));
  law.exponent = alike ? 0 : sums.xy / sums.xx;
  law.intercept = sums.mean_y - law.exponent * sums.mean_x;
  const double squares = alike ? 0 : squared_residuals(ln_stimulus, ln_answer, sums, law.exponent);
  law.r2_status = alike ? StatisticStatus::no_variance : StatisticStatus::ok;
  if (!alike) law.r2 = std::max(0.0, 1 - squares / sums.yy);
  if (n > 2) add_interval(law, squares, sums.xx, static_cast<double>(n) - 2);
  return law;
}

MagnitudeScale magnitude_scale(const MagnitudeEstimates& estimates) {
  MagnitudeScale scale;
  scale.grand_geometric_mean = kNaN;
  scale.refused = not_positive(estimates);
  if (!scale.ok()) return scale;
  Logs ln_stimulus, means;
  for (const double stimulus : estimates.stimuli) ln_stimulus.push_back(std::log(stimulus));
  std::vector<Logs> cells;
  for (const auto& answers : estimates.answers) {
    cells.push_back(log_cells(answers));
    means.push_back(moments(cells.back()).mean);
  }
  const double grand = moments(means).mean;
  scale.grand_geometric_mean = std::exp(grand);

  std::vector<double> exponents;
  for (std::size_t p = 0; p < cells.size(); ++p) {
    const PowerLaw law = power_law(ln_stimulus, cells[p]);
    scale.participants.push_back(
        {exponentials(cells[p]), exponentials(cells[p], grand - means[p]), std::exp(means[p]), law});
    exponents.push_back(law.exponent);
  }
  scale.exponents = mean_interval(exponents);

  Logs group, column(cells.size()), centred(cells.size());
  for (std::size_t i = 0; i < ln_stimulus.size(); ++i) {
    for (std::size_t p = 0; p < cells.size(); ++p) {
      column[p] = cells[p][i];
      centred[p] = cells[p][i] - means[p];
    }
    group.push_back(moments(column).mean);
    if (cells.size() > 1) scale.group_ln_se.push_back(mean_interval(centred).se);
  }
  scale.group_geometric_means = exponentials(group);
  scale.group = power_law(ln_stimulus, group);
  return scale;
}

}  // namespace jnd
