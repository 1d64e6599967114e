// Psychometric functions, F(x) = G(u): their standard shapes G with derivatives, and the likelihood of counts under them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "analysis/numerics/box_newton.h"
#include "analysis/psychometric/psychometric.h"

namespace jnd {

// At one u: both tails to full relative precision, so that neither rate of a steep function loses its digits.
struct PsychometricShape {
  double g = 0;       // G
  double upper = 0;   // 1 - G
  double first = 0;   // dG/du
  double second = 0;  // d2G/du2
};

// logistic 1 / (1 + exp(-u)); gaussian Phi(u); weibull and gumbel 1 - exp(-exp(u)).
PsychometricShape psychometric_shape(PsychometricFunction function, double u) noexcept;
double psychometric_shape_quantile(PsychometricFunction function, double p) noexcept;  // u with G(u) = p, 0 < p < 1

// The likelihood of counts under a psychometric function, with its exact first and second derivatives.
//
// Variables, always in this order: c0, c1, lapse, guess, with F = G(c0 + c1 t) and t the level, shifted by its mean and
// divided by its range (weibull: ln x, shifted only), so that units do not matter to the search.
struct PsychometricData {
  PsychometricFunction function = PsychometricFunction::logistic;
  // One entry a different level with trials, ascending. Levels with the same logarithm are one to the weibull function.
  std::vector<double> x, t, n, k;
  double shift = 0, scale = 1;  // t = (x - shift) / scale; weibull t = ln x - shift
  double trials = 0, answers = 0;
  double saturated = 0;  // log-likelihood of the rates themselves

  std::size_t levels() const noexcept { return x.size(); }
  double range() const noexcept { return t.empty() ? 0 : t.back() - t.front(); }  // of t
  // Levels nearer on the t axis than this are taken to be this far apart: for a function that rises between them,
  // c0 + c1 t would have lost its digits.
  double least_distance() const noexcept { return 1e-9 * range(); }
};

// Throws std::invalid_argument where a level or the model breaks the ranges of psychometric.h.
PsychometricData psychometric_data(std::span<const PsychometricLevel> levels, const PsychometricModel& model);

// The same data on another t axis, such as that of several groups together.
void move_axis(PsychometricData& data, double shift, double scale) noexcept;

// k ln p, 0 where k = 0.
double count_log(double k, double p) noexcept;
// The log-likelihood of k of n at rate p.
inline double rates_log(double n, double k, double p) noexcept {
  return count_log(k, p) + count_log(n - k, 1 - p);
}
// Rates below this are taken for 0 where something is divided by them.
inline constexpr double kLeastRate = 1e-300;

class PsychometricLikelihood {
 public:
  enum Place : std::size_t { c0, c1, lapse, guess, variables };

  PsychometricLikelihood(PsychometricData data, const PsychometricModel& model);
  // Of other data, under the same model.
  PsychometricLikelihood(const PsychometricLikelihood& other, PsychometricData data);

  const PsychometricData& data() const noexcept { return data_; }
  const NewtonBox& box() const noexcept { return box_; }  // c1 >= 0; fixed rates are held
  int free_parameters() const noexcept;

  // Log-likelihood plus the logarithm of the prior (map); -inf where impossible.
  double value(const std::vector<double>& place) const noexcept;
  void derivatives(const std::vector<double>& place, NewtonDerivatives& out) const;
  double log_likelihood(const std::vector<double>& place) const noexcept;  // without the prior

  // Exponents a - 1 and b - 1 of the prior in force; both 0 without one.
  double prior_a() const noexcept { return prior_a_; }
  double prior_b() const noexcept { return prior_b_; }
  double log_prior(double lapse_rate) const noexcept;

 private:
  PsychometricData data_;
  NewtonBox box_;
  double prior_a_ = 0, prior_b_ = 0;
};

// A fit together with the likelihood it maximises, for what goes on from there: intervals and comparisons.
struct PsychometricSolution {
  PsychometricFit fit;
  PsychometricLikelihood likelihood;
  std::vector<double> place;  // c0, c1, lapse, guess; empty under no_information and not_identified
  double value = 0;           // the largest log-likelihood, with the prior of map; a supremum like fit.log_likelihood
};

// As fit_psychometric. Under separated the place is a very steep function near the supremum, under not_increasing a
// very flat one.
PsychometricSolution solve_psychometric(std::span<const PsychometricLevel> levels, const PsychometricModel& model);

}  // namespace jnd
