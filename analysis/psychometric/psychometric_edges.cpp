#include "analysis/psychometric/psychometric_edges.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_shape.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

constexpr double kSteep = 40;  // of u between neighbouring levels: exp(-40) is left of the rate

// The best lapse where `wrong` of n trials show it directly (their rate is 1 - lapse); without trials the prior's mode.
double best_lapse(const PsychometricLikelihood& likelihood, double n, double wrong) noexcept {
  const double weight = n + likelihood.prior_a() + likelihood.prior_b();
  const double best = weight > 0 ? (wrong + likelihood.prior_a()) / weight : 0;
  return std::clamp(best, likelihood.box().lower[Place::lapse], likelihood.box().upper[Place::lapse]);
}

double best_guess(const PsychometricLikelihood& likelihood, double n, double k) noexcept {
  return std::clamp(n > 0 ? k / n : 0, likelihood.box().lower[Place::guess], likelihood.box().upper[Place::guess]);
}

// True where it is the new best.
bool keep_better(PsychometricEdge& best, double log_likelihood, double lapse, double guess, double level,
                 const PsychometricLikelihood& likelihood) noexcept {
  const double value = log_likelihood + likelihood.log_prior(lapse);
  // A rate on a step must gain something over a step between levels, of which it is the limit.
  const double gain = std::isfinite(best.value) ? 1e-12 * std::abs(best.value) : 0;
  if (!(value > best.value + gain)) return false;
  best = {value, log_likelihood, lapse, guess, level, 0, 0, 0};
  return true;
}

}  // namespace

PsychometricEdge flat_edge(const PsychometricLikelihood& likelihood) noexcept {
  const double n = likelihood.data().trials, k = likelihood.data().answers, p = k / n;
  PsychometricEdge best;
  best.value = -kInf;
  const double free_lapse = best_lapse(likelihood, 0, 0), free_guess = best_guess(likelihood, 0, 0);
  if (p >= free_guess && p <= 1 - free_lapse)
    keep_better(best, rates_log(n, k, p), free_lapse, free_guess, kNaN, likelihood);
  const double lapse = best_lapse(likelihood, n, n - k);
  keep_better(best, rates_log(n, k, 1 - lapse), lapse, free_guess, kNaN, likelihood);
  const double guess = best_guess(likelihood, n, k);
  keep_better(best, rates_log(n, k, guess), free_lapse, guess, kNaN, likelihood);
  const double f = (p - best.guess) / (1 - best.guess - best.lapse);
  best.c0 = psychometric_shape_quantile(likelihood.data().function, std::clamp(f, 1e-9, 1 - 1e-9));
  best.c1 = 1e-4 / likelihood.data().range();
  return best;
}

PsychometricEdge step_edge(const PsychometricLikelihood& likelihood) noexcept {
  const PsychometricData& data = likelihood.data();
  PsychometricEdge best;
  best.value = -kInf;
  // First the steps between two levels, then those through one: a tie goes to the first.
  for (const bool through : {false, true}) {
    double n_below = 0, k_below = 0;
    for (std::size_t j = 0; j < data.levels(); ++j) {
      const double n_above = data.trials - n_below - (through ? data.n[j] : 0);
      const double k_above = data.answers - k_below - (through ? data.k[j] : 0);
      const double lapse = best_lapse(likelihood, n_above, n_above - k_above);
      const double guess = best_guess(likelihood, n_below, k_below);
      const double sides = rates_log(n_below, k_below, guess) + rates_log(n_above, k_above, 1 - lapse);
      const double rate = data.k[j] / data.n[j];
      if (through && rate >= guess && rate <= 1 - lapse) {
        if (keep_better(best, sides + rates_log(data.n[j], data.k[j], rate), lapse, guess, data.x[j], likelihood)) {
          const double f = std::clamp((rate - guess) / (1 - guess - lapse), 1e-9, 1 - 1e-9);
          double nearest = kInf;
          if (j > 0) nearest = data.t[j] - data.t[j - 1];
          if (j + 1 < data.levels()) nearest = std::min(nearest, data.t[j + 1] - data.t[j]);
          best.c1 = kSteep / std::max(nearest, data.least_distance());
          best.t = data.t[j];
          best.c0 = psychometric_shape_quantile(data.function, f) - best.c1 * best.t;
        }
      } else if (!through && j > 0 && keep_better(best, sides, lapse, guess, kNaN, likelihood)) {
        best.c1 = 2 * kSteep / std::max(data.t[j] - data.t[j - 1], data.least_distance());
        best.t = (data.t[j] + data.t[j - 1]) / 2;
        best.c0 = -best.c1 * best.t;
      }
      n_below += data.n[j];
      k_below += data.k[j];
    }
  }
  return best;
}

}  // namespace jnd
