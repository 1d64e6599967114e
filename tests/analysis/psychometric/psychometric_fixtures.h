// What the tests of psychometric functions share: data, the likelihood written down directly, simulated observers.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric.h"

namespace jnd::testing {

inline constexpr PsychometricFunction kFunctions[] = {PsychometricFunction::logistic, PsychometricFunction::gaussian,
                                                      PsychometricFunction::weibull, PsychometricFunction::gumbel};

// "comparison stiffer" at 600 to 1200 N/m, and a forced choice between two alternatives.
inline const std::vector<PsychometricLevel> kComparison = {{600, 20, 1},   {700, 20, 2},   {800, 20, 6},
                                                           {850, 20, 7},   {900, 20, 11},  {950, 20, 14},
                                                           {1000, 20, 15}, {1100, 20, 18}, {1200, 20, 20}};
inline const std::vector<PsychometricLevel> kForcedChoice = {
    {15, 50, 27}, {30, 32, 15}, {60, 64, 40}, {90, 40, 28}, {120, 64, 52}, {180, 24, 21}, {260, 50, 47}, {400, 50, 47}};

// F straight from its definition, without any of the code under test.
inline double plain_cdf(PsychometricFunction function, double location, double second, double x) {
  switch (function) {
    case PsychometricFunction::logistic:
      return 1 / (1 + std::exp(-second * (x - location)));
    case PsychometricFunction::gaussian:
      return 0.5 * std::erfc(-(x - location) / second / std::sqrt(2.0));
    case PsychometricFunction::weibull:
      return 1 - std::exp(-std::pow(x / location, second));
    case PsychometricFunction::gumbel:
      return 1 - std::exp(-std::exp(second * (x - location)));
  }
  return 0;
}

// x with F(x) = p, 0 < p < 1.
inline double plain_quantile(PsychometricFunction function, double location, double second, double p) {
  switch (function) {
    case PsychometricFunction::logistic:
      return location + std::log(p / (1 - p)) / second;
    case PsychometricFunction::gaussian:
      return location + second * normal_quantile(p);
    case PsychometricFunction::weibull:
      return location * std::pow(-std::log(1 - p), 1 / second);
    case PsychometricFunction::gumbel:
      return location + std::log(-std::log(1 - p)) / second;
  }
  return 0;
}

inline double plain_log_likelihood(const std::vector<PsychometricLevel>& levels, PsychometricFunction function,
                                   double location, double second, double guess, double lapse) {
  double sum = 0;
  for (const PsychometricLevel& level : levels) {
    const double p = guess + (1 - guess - lapse) * plain_cdf(function, location, second, level.x);
    if (level.k > 0) sum += level.k * std::log(p);
    if (level.k < level.n) sum += (level.n - level.k) * std::log(1 - p);
  }
  return std::isnan(sum) ? -kInf : sum;
}

inline double plain_log_likelihood(const std::vector<PsychometricLevel>& levels, const PsychometricFit& fit) {
  return plain_log_likelihood(levels, fit.model.function, fit.location.value, fit.second.value, fit.guess.value,
                              fit.lapse.value);
}

// A typical function of each kind over the levels 1 to 8.
struct Truth {
  double location, second;
};
inline Truth truth_of(PsychometricFunction function) {
  switch (function) {
    case PsychometricFunction::gaussian:
      return {4.2, 1.6};
    case PsychometricFunction::weibull:
      return {4.8, 2.6};
    case PsychometricFunction::logistic:
    case PsychometricFunction::gumbel:
      break;
  }
  return {4.4, 1.1};
}

inline std::vector<PsychometricLevel> simulated(PsychometricFunction function, Truth truth, double guess, double lapse,
                                                int trials, std::mt19937_64& generator, int levels = 8) {
  std::vector<PsychometricLevel> data;
  for (int i = 1; i <= levels; ++i) {
    PsychometricLevel level;
    level.x = i;
    level.n = trials;
    const double p = guess + (1 - guess - lapse) * plain_cdf(function, truth.location, truth.second, level.x);
    for (int trial = 0; trial < trials; ++trial)
      if (static_cast<double>(generator() >> 11U) * 0x1p-53 < p) ++level.k;
    data.push_back(level);
  }
  return data;
}

}  // namespace jnd::testing
