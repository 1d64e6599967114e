// What the tests of ratings share: agreement with reference numbers, and an ordered-probit likelihood of their own.
#pragma once

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/selftest/reference_numbers.h"
#include "tests/catch.h"

namespace jnd::testing {

// Equal, both infinite alike, both undefined, or within an absolute tolerance.
inline bool near_reference(double ours, const nlohmann::json& reference, double tolerance) {
  const double number = reference_number(reference);
  if (std::isnan(number)) return std::isnan(ours);
  return ours == number || std::abs(ours - number) <= tolerance;
}

// ln(Phi(b) - Phi(a)) as the difference of two tails on the same side.
inline double plain_log_slice(double a, double b) {
  const auto upper = [](double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); };
  return std::log(a > 0 ? upper(a) - upper(b) : upper(-b) - upper(-a));
}

// sum n_ij ln P_ij with the cuts (c_j - eta_i) / s_i: criteria, eta and s given plainly.
inline double plain_log_likelihood(const std::vector<std::vector<double>>& counts, const std::vector<double>& criteria,
                                   const std::vector<double>& eta, const std::vector<double>& scale) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    for (std::size_t j = 0; j < counts[i].size(); ++j) {
      if (counts[i][j] == 0) continue;
      const double low = j == 0 ? -kInf : (criteria[j - 1] - eta[i]) / scale[i];
      const double high = j == criteria.size() ? kInf : (criteria[j] - eta[i]) / scale[i];
      if (!(low < high)) return -kInf;
      sum += counts[i][j] * plain_log_slice(low, high);
    }
  return std::isnan(sum) ? -kInf : sum;
}

// The highest value of f that a search by patterns finds from start (Hooke and Jeeves 1961): steps along the axes, then
// on in the direction that they made together, halved where none helps.
template <typename Function>
double highest_by_patterns(const Function& f, std::vector<double> place) {
  double best = f(place);
  int evaluations = 0;
  const auto step_to = [&](const std::vector<double>& next) {
    const double value = f(next);
    ++evaluations;
    if (!(value > best)) return false;
    best = value;
    place = next;
    return true;
  };
  for (double step = 1; step > 1e-6 && evaluations < 20'000;) {
    const std::vector<double> before = place;
    bool better = false;
    for (std::size_t i = 0; i < place.size(); ++i) {
      std::vector<double> up = place, down = place;
      up[i] += step;
      down[i] -= step;
      better = step_to(up) || step_to(down) || better;
    }
    if (!better) {
      step /= 2;
      continue;
    }
    std::vector<double> on = place;
    for (std::size_t i = 0; i < on.size(); ++i) on[i] += place[i] - before[i];
    step_to(on);
  }
  return best;
}

}  // namespace jnd::testing
