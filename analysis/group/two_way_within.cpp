#include "analysis/group/two_way_within.h"

#include <cmath>

#include "analysis/numerics/moments.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Every product of a row of a (rows_a x la) with a row of b (rows_b x lb): contrasts over the la * lb cells.
std::vector<double> products(const std::vector<double>& a, std::size_t la, const std::vector<double>& b,
                             std::size_t lb) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.size(); i += la)
    for (std::size_t j = 0; j < b.size(); j += lb)
      for (std::size_t s = 0; s < la; ++s)
        for (std::size_t t = 0; t < lb; ++t) result.push_back(a[i + s] * b[j + t]);
  return result;
}

std::vector<double> scores_on(const std::vector<double>& contrasts, const std::vector<double>& x, std::size_t n) {
  const std::size_t cells = x.size() / n;
  std::vector<double> scores;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < contrasts.size(); c += cells) {
      double sum = 0;
      for (std::size_t cell = 0; cell < cells; ++cell) sum += contrasts[c + cell] * x[i * cells + cell];
      scores.push_back(sum);
    }
  }
  return scores;
}

}  // namespace

TwoWayWithin two_way_within(const TwoWayTable& table) {
  TwoWayWithin result;
  result.ss_subjects = kNaN;
  result.a.eta2_generalised = result.b.eta2_generalised = result.ab.eta2_generalised = kNaN;
  const std::size_t a = table.a, b = table.b, n = table.n;
  if (n < 2 || a < 2 || b < 2) {
    result.status = StatisticStatus::too_few;
    result.a.effect = within_effect({}, 0, a < 2 ? 0 : a - 1, 0);
    result.b.effect = within_effect({}, 0, b < 2 ? 0 : b - 1, 0);
    result.ab.effect = within_effect({}, 0, a < 2 || b < 2 ? 0 : (a - 1) * (b - 1), 0);
    return result;
  }
  const double scale = largest_magnitude(table.values);
  std::vector<double> x(table.values);
  for (double& value : x) value -= table.values.front();

  const std::vector<double> of_a = helmert_contrasts(a), of_b = helmert_contrasts(b);
  const std::vector<double> mean_a(a, 1 / std::sqrt(static_cast<double>(a)));
  const std::vector<double> mean_b(b, 1 / std::sqrt(static_cast<double>(b)));
  result.a.effect = within_effect(scores_on(products(of_a, a, mean_b, b), x, n), n, a - 1, scale);
  result.b.effect = within_effect(scores_on(products(mean_a, a, of_b, b), x, n), n, b - 1, scale);
  result.ab.effect = within_effect(scores_on(products(of_a, a, of_b, b), x, n), n, (a - 1) * (b - 1), scale);

  const Moments subjects = moments(scores_on(products(mean_a, a, mean_b, b), x, n));
  result.ss_subjects = (static_cast<double>(n) - 1) * subjects.sd * subjects.sd;
  const double errors =
      result.ss_subjects + result.a.effect.ss_error + result.b.effect.ss_error + result.ab.effect.ss_error;
  for (TwoWayEffect* one : {&result.a, &result.b, &result.ab})
    if (one->effect.ss + errors > 0) one->eta2_generalised = one->effect.ss / (one->effect.ss + errors);
  return result;
}

}  // namespace jnd
