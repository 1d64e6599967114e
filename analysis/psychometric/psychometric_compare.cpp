#include "analysis/psychometric/psychometric_compare.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/psychometric/psychometric_joint.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "analysis/psychometric/psychometric_search.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;
using Groups = std::span<const std::vector<PsychometricLevel>>;

// What a maximum must gain on an edge: as for a single fit.
double gain_of(double log_likelihood) noexcept {
  return 1e-10 + 1e-13 * std::abs(log_likelihood);
}

// Whether a group, with lapse and guess as found, has a slope and a location of its own.
PsychometricStatus own_status(const std::vector<PsychometricLevel>& levels, PsychometricModel model, double lapse,
                              double guess) {
  model.lapse = lapse;
  model.guess = guess;
  const PsychometricStatus status = solve_psychometric(levels, model).fit.status;
  return is_estimate(status) ? PsychometricStatus::ok : status;
}

// The status of a joint maximum: is it inside, or the limit of steps or of flat functions?
PsychometricStatus joint_status(const JointLikelihood& likelihood, const NewtonResult& found, Groups groups,
                                const PsychometricModel& model, PsychometricSharing sharing) {
  const double lapse = found.place[0], guess = found.place[1];
  if (sharing == PsychometricSharing::own_function) {
    for (const auto& levels : groups)
      if (const PsychometricStatus status = own_status(levels, model, lapse, guess); status != PsychometricStatus::ok)
        return status;
  } else if (sharing == PsychometricSharing::own_location) {
    PsychometricModel fixed = model;
    fixed.lapse = lapse;
    fixed.guess = guess;
    double flat = 0, step = 0;
    for (const PsychometricLikelihood& group : likelihood.groups()) {
      const PsychometricLikelihood at_rates(group.data(), fixed);
      flat += flat_edge(at_rates).value;
      step += step_edge(at_rates).value;
    }
    if (flat >= found.value - gain_of(found.value)) return PsychometricStatus::not_increasing;
    if (step >= found.value - gain_of(found.value)) return PsychometricStatus::separated;
  } else {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (found.place[likelihood.slope_index(g)] <= 0) return PsychometricStatus::not_increasing;
      // Nothing lost by a slope a thousand times as steep: the step is the limit.
      std::vector<double> steeper = found.place;
      steeper[likelihood.slope_index(g)] *= 1000;
      if (likelihood.value(steeper) >= found.value - gain_of(found.value)) return PsychometricStatus::separated;
    }
  }
  NewtonDerivatives at;
  std::vector<double> direction;
  likelihood.derivatives(found.place, at);
  std::vector<double> curvature, gradient;
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < found.place.size(); ++i)
    if (found.place[i] > likelihood.box().lower[i] && found.place[i] < likelihood.box().upper[i]) free.push_back(i);
  for (const std::size_t i : free) {
    gradient.push_back(at.gradient[i]);
    for (const std::size_t j : free) curvature.push_back(at.curvature[i * found.place.size() + j]);
  }
  if (!found.converged || !solve_positive_definite(curvature, gradient)) return PsychometricStatus::not_identified;
  const auto at_bound = [&](std::size_t i) {
    return std::find(free.begin(), free.end(), i) == free.end() &&
           likelihood.box().lower[i] < likelihood.box().upper[i];
  };
  if (at_bound(0)) return PsychometricStatus::lapse_at_bound;
  return at_bound(1) ? PsychometricStatus::guess_at_bound : PsychometricStatus::ok;
}

// A fit of several groups, with the function of each group (c0, c1, lapse, guess on the pooled axis) that it found.
struct Shared {
  SharingFit fit;
  std::vector<std::vector<double>> functions;
};

// simpler: what models within this one found; their likelihood is where this one's begins, so that it is never below.
Shared fit_shared(Groups groups, const PsychometricModel& model, PsychometricSharing sharing,
                  const PsychometricSolution& pooled, const std::vector<PsychometricSolution>& single,
                  const std::vector<const Shared*>& simpler) {
  Shared shared;
  SharingFit& fit = shared.fit;
  fit.sharing = sharing;
  const JointLikelihood likelihood(groups, model, sharing, pooled.likelihood.data());
  for (std::size_t i = 0; i < likelihood.variables(); ++i)
    fit.parameters += likelihood.box().lower[i] < likelihood.box().upper[i] ? 1 : 0;
  for (const PsychometricSolution& one : single)
    if (one.fit.status == PsychometricStatus::no_information || one.fit.levels < 2) {
      fit.status = one.fit.status;
      return shared;
    }

  const double middle = psychometric_shape_quantile(model.function, 0.5);
  std::vector<std::vector<double>> starts = joint_starts(likelihood, model, sharing, groups);
  const auto start_from = [&](const std::vector<std::vector<double>>& functions) {
    if (functions.empty()) return;
    const std::vector<double>& rates = functions.front();
    starts.push_back(joint_place(likelihood, sharing, rates[Place::lapse], rates[Place::guess], functions, middle));
  };
  start_from(std::vector<std::vector<double>>(groups.size(), pooled.place));
  for (const Shared* one : simpler) start_from(one->functions);
  NewtonResult best;
  best.value = -kInf;
  for (const std::vector<double>& start : starts) {
    if (!std::isfinite(likelihood.value(start))) continue;
    NewtonResult found = maximise_in_box(likelihood, start, likelihood.box());
    const bool got_there = found.converged && !best.converged && found.value >= best.value - 1e-9;
    if (found.value > best.value + (best.converged && !found.converged ? 1e-9 : 0) || got_there)
      best = std::move(found);
  }
  if (best.place.empty()) return shared;
  for (std::size_t g = 0; g < groups.size(); ++g) shared.functions.push_back(likelihood.group_place(best.place, g));
  fit.status = joint_status(likelihood, best, groups, model, sharing);
  if (!is_estimate(fit.status)) return shared;
  fit.log_likelihood = best.value;
  fit.lapse = best.place[0];
  fit.guess = best.place[1];
  return shared;
}

SharingTest test_of(const SharingFit& simpler, const SharingFit& general) {
  SharingTest test;
  test.simpler = simpler.sharing;
  test.general = general.sharing;
  test.df = general.parameters - simpler.parameters;
  for (const SharingFit* fit : {&general, &simpler})
    if (!is_estimate(fit->status)) test.status = fit->status;
  if (test.status != PsychometricStatus::ok) return test;
  test.chi_square = std::fmax(0, 2 * (general.log_likelihood - simpler.log_likelihood));
  test.p = boost::math::gamma_q(0.5 * test.df, 0.5 * test.chi_square);
  return test;
}

constexpr auto kPsychometricSharingWords =
    words<PsychometricSharing>({{"same_function", PsychometricSharing::same_function},
                                {"own_location", PsychometricSharing::own_location},
                                {"own_slope", PsychometricSharing::own_slope},
                                {"own_function", PsychometricSharing::own_function}});

}  // namespace

std::string_view to_string(PsychometricSharing sharing) noexcept {
  return word_of(kPsychometricSharingWords, sharing);
}

PsychometricComparison compare_psychometric(Groups groups, const PsychometricModel& asked) {
  if (groups.size() < 2) throw std::invalid_argument("a comparison needs at least two groups");
  PsychometricModel model = asked;
  model.estimator = PsychometricEstimator::ml;
  std::vector<PsychometricLevel> all;
  std::vector<PsychometricSolution> single;
  for (const auto& levels : groups) {
    all.insert(all.end(), levels.begin(), levels.end());
    single.push_back(solve_psychometric(levels, model));
  }
  const PsychometricSolution pooled = solve_psychometric(all, model);

  PsychometricComparison result;
  result.groups = static_cast<int>(groups.size());
  SharingFit& same = result.fits[0];
  same.status = pooled.fit.status;
  same.parameters = pooled.likelihood.free_parameters();
  if (is_estimate(same.status)) {
    same.log_likelihood = pooled.fit.log_likelihood;
    same.lapse = pooled.fit.lapse.value;
    same.guess = pooled.fit.guess.value;
  }
  using Sharing = PsychometricSharing;
  const std::array own = {Sharing::own_location, Sharing::own_slope, Sharing::own_function};
  std::array<Shared, 3> shared;
  for (std::size_t i = 0; i < own.size(); ++i) {
    std::vector<const Shared*> simpler;
    if (own[i] == Sharing::own_function) simpler = {&shared.front(), &shared[1]};
    if (!pooled.place.empty()) {
      shared[i] = fit_shared(groups, model, own[i], pooled, single, simpler);
    } else {
      shared[i].fit.sharing = own[i];
      shared[i].fit.status = pooled.fit.status;
    }
    result.fits[i + 1] = shared[i].fit;
  }
  const auto& [one, location, slope, both] = result.fits;
  result.tests = {test_of(one, location), test_of(one, slope), test_of(one, both), test_of(location, both),
                  test_of(slope, both)};
  return result;
}

}  // namespace jnd
