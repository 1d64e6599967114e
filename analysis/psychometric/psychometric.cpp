#include "analysis/psychometric/psychometric.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "analysis/numerics/words.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "analysis/psychometric/psychometric_quantity.h"
#include "analysis/psychometric/psychometric_search.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

constexpr auto kFunctionWords = words<PsychometricFunction>({{"logistic", PsychometricFunction::logistic},
                                                             {"gaussian", PsychometricFunction::gaussian},
                                                             {"weibull", PsychometricFunction::weibull},
                                                             {"gumbel", PsychometricFunction::gumbel}});
constexpr auto kEstimatorWords =
    words<PsychometricEstimator>({{"ml", PsychometricEstimator::ml}, {"map", PsychometricEstimator::map}});
constexpr auto kStatusWords = words<PsychometricStatus>({{"ok", PsychometricStatus::ok},
                                                         {"lapse_at_bound", PsychometricStatus::lapse_at_bound},
                                                         {"guess_at_bound", PsychometricStatus::guess_at_bound},
                                                         {"not_increasing", PsychometricStatus::not_increasing},
                                                         {"separated", PsychometricStatus::separated},
                                                         {"no_information", PsychometricStatus::no_information},
                                                         {"not_identified", PsychometricStatus::not_identified}});

bool is_free(const NewtonBox& box, std::size_t i) noexcept {
  return box.lower[i] < box.upper[i];
}

bool at_bound(const PsychometricSolution& solution, std::size_t i) noexcept {
  const NewtonBox& box = solution.likelihood.box();
  return is_free(box, i) && (solution.place[i] <= box.lower[i] || solution.place[i] >= box.upper[i]);
}

// A limit shape: parameters take the values they tend to.
void take_step(PsychometricFit& fit, const PsychometricEdge& step) {
  fit.status = PsychometricStatus::separated;
  fit.log_likelihood = step.log_likelihood;
  fit.pse.value = fit.location.value = step.level;
  fit.second.value = fit.model.function == PsychometricFunction::gaussian ? 0 : kInf;
  fit.jnd.value = 0;
  fit.slope.value = kInf;
  fit.lapse.value = step.lapse;
  fit.guess.value = step.guess;
}

// Estimates, and errors from the observed information of what is free and not at a bound. False where that is singular.
bool take_estimates(PsychometricSolution& solution) {
  PsychometricFit& fit = solution.fit;
  const std::vector<double>& place = solution.place;
  NewtonDerivatives at;
  solution.likelihood.derivatives(place, at);
  std::vector<std::size_t> free = {Place::c0, Place::c1};
  for (const std::size_t rate : {Place::lapse, Place::guess})
    if (is_free(solution.likelihood.box(), rate) && !at_bound(solution, rate)) free.push_back(rate);
  const std::size_t m = free.size();

  bool regular = true;
  // Standard error of a function with this gradient in the free variables: sqrt(g' I^-1 g).
  const auto error_of = [&](const std::vector<double>& gradient) {
    std::vector<double> information(m * m), solved = gradient;
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j)
        information[i * m + j] = at.curvature[free[i] * PsychometricLikelihood::variables + free[j]];
    if (!solve_positive_definite(information, solved)) {
      regular = false;
      return kNaN;
    }
    double variance = 0;
    for (std::size_t i = 0; i < m; ++i) variance += gradient[i] * solved[i];
    return std::sqrt(variance);
  };
  const auto estimate_of = [&](PsychometricQuantity quantity) {
    const QuantityValue found = quantity_at(quantity, solution.likelihood.data(), place[Place::c0], place[Place::c1]);
    std::vector<double> gradient(m, 0);
    gradient[0] = found.by_c0;
    gradient[1] = found.by_c1;
    return PsychometricEstimate{found.value, error_of(gradient)};
  };
  fit.location = estimate_of(PsychometricQuantity::location);
  fit.second = estimate_of(PsychometricQuantity::second);
  fit.pse = estimate_of(PsychometricQuantity::pse);
  fit.jnd = estimate_of(PsychometricQuantity::jnd);
  fit.slope = estimate_of(PsychometricQuantity::slope);
  fit.lapse.value = place[Place::lapse];
  fit.guess.value = place[Place::guess];
  for (std::size_t i = 2; i < m; ++i) {
    std::vector<double> gradient(m, 0);
    gradient[i] = 1;
    (free[i] == Place::lapse ? fit.lapse : fit.guess).se = error_of(gradient);
  }
  fit.log_likelihood = solution.likelihood.log_likelihood(place);
  fit.status = at_bound(solution, Place::lapse)   ? PsychometricStatus::lapse_at_bound
               : at_bound(solution, Place::guess) ? PsychometricStatus::guess_at_bound
                                                  : PsychometricStatus::ok;
  return regular;
}

void take_deviance(PsychometricFit& fit, const PsychometricData& data) {
  // The rates themselves cannot be beaten; rounding may say otherwise.
  fit.deviance = std::fmax(0, 2 * (data.saturated - fit.log_likelihood));
  CountsPerLevel counts;
  for (std::size_t i = 0; i < data.levels(); ++i) counts.add(data.n[i], data.k[i]);
  fit.few_trials = counts.too_few();
  if (fit.degrees_of_freedom >= 1 && !fit.few_trials) fit.deviance_p = chi2_upper(fit.deviance, fit.degrees_of_freedom);
}

void forget_estimates(PsychometricSolution& solution) {
  PsychometricFit& fit = solution.fit;
  for (PsychometricEstimate* estimate :
       {&fit.location, &fit.second, &fit.guess, &fit.lapse, &fit.pse, &fit.jnd, &fit.slope})
    *estimate = {};
  solution.place.clear();
}

}  // namespace

std::string_view to_string(PsychometricFunction function) noexcept {
  return word_of(kFunctionWords, function);
}

std::optional<PsychometricFunction> psychometric_function_from(std::string_view name) noexcept {
  return value_of(kFunctionWords, name);
}

std::pair<std::string_view, std::string_view> parameter_names(PsychometricFunction function) noexcept {
  switch (function) {
    case PsychometricFunction::gaussian:
      return {"mu", "sigma"};
    case PsychometricFunction::weibull:
      return {"scale", "shape"};
    case PsychometricFunction::logistic:
    case PsychometricFunction::gumbel:
      break;
  }
  return {"alpha", "beta"};
}

std::string_view to_string(PsychometricEstimator estimator) noexcept {
  return word_of(kEstimatorWords, estimator);
}

std::string_view to_string(PsychometricStatus status) noexcept {
  return word_of(kStatusWords, status);
}

bool is_estimate(PsychometricStatus status) noexcept {
  return status == PsychometricStatus::ok || status == PsychometricStatus::lapse_at_bound ||
         status == PsychometricStatus::guess_at_bound;
}

PsychometricSolution solve_psychometric(std::span<const PsychometricLevel> levels, const PsychometricModel& model) {
  PsychometricSolution solution{{}, PsychometricLikelihood(psychometric_data(levels, model), model), {}, -kInf};
  const PsychometricLikelihood& likelihood = solution.likelihood;
  const PsychometricData& data = likelihood.data();
  PsychometricFit& fit = solution.fit;
  fit.model = model;
  fit.levels = static_cast<int>(data.levels());
  fit.trials = static_cast<long long>(data.trials);
  fit.degrees_of_freedom = fit.levels - likelihood.free_parameters();
  if (data.answers == 0 || data.answers == data.trials) return solution;  // no_information, as it begins
  if (fit.degrees_of_freedom < 0) {
    fit.status = PsychometricStatus::not_identified;
    return solution;
  }

  const PsychometricEdge flat = flat_edge(likelihood), step = step_edge(likelihood);
  NewtonResult found = psychometric_maximum(likelihood, std::max(flat.value, step.value));
  solution.value = found.value;
  solution.place = std::move(found.place);
  // What an inner maximum must gain on the edges: above the rounding of the sums.
  const double gain = 1e-10 + 1e-13 * std::abs(data.saturated);
  if (flat.value >= solution.value - gain && flat.value >= step.value - gain) {
    forget_estimates(solution);
    fit.status = PsychometricStatus::not_increasing;
    fit.log_likelihood = flat.log_likelihood;
    solution.value = flat.value;
    solution.place = {flat.c0, flat.c1, flat.lapse, flat.guess};
  } else if (step.value >= solution.value - gain) {
    take_step(fit, step);
    solution.value = step.value;
    solution.place = {step.c0, step.c1, step.lapse, step.guess};
  } else if (!take_estimates(solution) || !found.converged) {
    forget_estimates(solution);
    fit.status = PsychometricStatus::not_identified;
  }
  take_deviance(fit, data);
  return solution;
}

PsychometricFit fit_psychometric(std::span<const PsychometricLevel> levels, const PsychometricModel& model) {
  return solve_psychometric(levels, model).fit;
}

}  // namespace jnd
