// Psychometric functions: the probability of an answer as a function of the stimulus level, fitted to counts.
//
//   P(x) = guess + (1 - guess - lapse) F(x)
//
//   logistic  F = 1 / (1 + exp(-beta (x - alpha)))      gaussian  F = Phi((x - mu) / sigma)
//   weibull   F = 1 - exp(-(x / scale)^shape), x > 0    gumbel    F = 1 - exp(-exp(beta (x - alpha)))
//
// All four are F = G(c0 + c1 t) with t = x (weibull: t = ln x), and c1 > 0: P grows with the level. PSE = F^-1(0.5),
// JND = F^-1(0.75) - F^-1(0.5), slope = dF/dx at the PSE: of F, without guess and lapse.
//
// Source: Wichmann and Hill 2001, "The psychometric function I", Perception & Psychophysics 63:1293-1313 (model,
// deviance); Kingdom and Prins 2016, Psychophysics, 2nd edition, chapter 4; Treutwein and Strasburger 1999 (prior on
// the lapse).
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "analysis/numerics/special_values.h"

namespace jnd {

enum class PsychometricFunction { logistic, gaussian, weibull, gumbel };
std::string_view to_string(PsychometricFunction function) noexcept;
std::optional<PsychometricFunction> psychometric_function_from(std::string_view name) noexcept;
// The names of the two parameters, location first: alpha, beta; mu, sigma; scale, shape; alpha, beta.
std::pair<std::string_view, std::string_view> parameter_names(PsychometricFunction function) noexcept;

// F at x for the two named parameters (second > 0; x > 0 for the Weibull function).
double psychometric_cdf(PsychometricFunction function, double location, double second, double x) noexcept;

// One level: n trials, k of them with the answer whose probability grows with x. 0 <= k <= n.
struct PsychometricLevel {
  double x = 0;  // finite, any unit; > 0 for the Weibull function
  int n = 0;
  int k = 0;
};

enum class PsychometricEstimator { ml, map };
std::string_view to_string(PsychometricEstimator estimator) noexcept;

// Density of a free lapse rate, proportional to lapse^(a - 1) (1 - lapse)^(b - 1); a, b >= 1.
struct BetaPrior {
  double a = 1.2, b = 10;
};

inline constexpr double kLargestLapse = 0.1;  // a free lapse lies in 0..0.1
inline constexpr double kLargestGuess = 0.5;  // a free guess lies in 0..0.5

struct PsychometricModel {
  PsychometricFunction function = PsychometricFunction::logistic;
  std::optional<double> guess = 0.0;  // fixed, 0 <= guess < 1 (0.5 for two alternatives); none: free
  std::optional<double> lapse = 0.0;  // fixed, 0 <= lapse < 1 - guess; none: free
  PsychometricEstimator estimator = PsychometricEstimator::ml;
  BetaPrior prior;  // of a free lapse, used by map only
};

enum class PsychometricStatus {
  ok,
  lapse_at_bound,  // a free lapse at 0 or 0.1: every number is defined, but the errors take the lapse as known
  guess_at_bound,  // the same of a free guess
  not_increasing,  // the best slope is <= 0: there is no threshold
  separated,       // the best slope is infinite: JND 0; the PSE is a level, or undefined between two levels
  no_information,  // one and the same answer throughout, or no trials
  not_identified   // fewer different levels than free parameters, or a likelihood that is flat in some direction
};
std::string_view to_string(PsychometricStatus status) noexcept;
// ok and the two bounds: all parameters, PSE, JND and slope are finite numbers.
bool is_estimate(PsychometricStatus status) noexcept;

// An estimate and its standard error from the observed information (delta method). NaN where undefined.
struct PsychometricEstimate {
  double value = kNaN;
  double se = kNaN;
};

struct PsychometricFit {
  PsychometricModel model;
  PsychometricStatus status = PsychometricStatus::no_information;
  PsychometricEstimate location, second;  // the two named parameters
  PsychometricEstimate guess, lapse;      // the se of a fixed one, or of one at its bound, is NaN
  PsychometricEstimate pse, jnd, slope;   // separated: jnd 0, slope inf, without errors
  // Largest log-likelihood, without binomial constants and without the prior. Under not_increasing and separated the
  // supremum, which no function of the family reaches; NaN under no_information, and where levels are too few.
  double log_likelihood = kNaN;
  double deviance = kNaN;      // 2 (log-likelihood of the rates themselves - this one)
  double deviance_p = kNaN;    // chi-square with degrees_of_freedom; NaN if that is < 1, or few_trials
  bool few_trials = false;     // too few per level for that p (CountsPerLevel); the bootstrap has one
  int degrees_of_freedom = 0;  // different levels - free parameters
  int levels = 0;              // different ones, with trials
  long long trials = 0;
};

// Maximum likelihood, or the mode of likelihood times prior (map): damped Newton steps with exact derivatives. Where
// the likelihood may have several maxima (a guess or lapse that is free or above 0), from every peak of a survey of all
// functions of the family over the data (psychometric_search.h), and from the edges of the free rates; checked against
// searches from random places, 30 in each of 200 data sets, by hand 80 in each of 10,000 (tests/README.md). The time is
// linear in rows and levels. Rows with the same x (weibull: the same ln x) count as one level; rows without trials are
// left out. Throws std::invalid_argument where a level or the model breaks its range, or a level has 2^31 trials.
PsychometricFit fit_psychometric(std::span<const PsychometricLevel> levels, const PsychometricModel& model);

}  // namespace jnd
