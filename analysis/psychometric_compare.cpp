#include "analysis/psychometric_compare.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <boost/math/special_functions/gamma.hpp>

#include "analysis/psychometric_edges.h"
#include "analysis/psychometric_joint.h"
#include "analysis/psychometric_shape.h"
#include "analysis/psychometric_solution.h"

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

SharingFit fit_shared(Groups groups, const PsychometricModel& model, PsychometricSharing sharing,
                      const PsychometricSolution& pooled, const std::vector<PsychometricSolution>& single) {
  SharingFit fit;
  fit.sharing = sharing;
  const JointLikelihood likelihood(groups, model, sharing, pooled.likelihood.data());
  for (std::size_t i = 0; i < likelihood.variables(); ++i)
    fit.parameters += likelihood.box().lower[i] < likelihood.box().upper[i] ? 1 : 0;
  for (const PsychometricSolution& one : single)
    if (one.fit.status == PsychometricStatus::no_information || one.fit.levels < 2) {
      fit.status = one.fit.status;
      return fit;
    }

  // From the pooled function, and from the groups' own where they have one.
  const double middle = psychometric_shape_quantile(model.function, 0.5);
  NewtonResult best;
  best.value = -std::numeric_limits<double>::infinity();
  for (const bool own : {false, true}) {
    std::vector<double> start(likelihood.variables());
    start[0] = pooled.place[Place::lapse];
    start[1] = pooled.place[Place::guess];
    double log_slope = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      std::vector<double> place = pooled.place;
      if (own && is_estimate(single[g].fit.status)) {
        // Onto the pooled axis: u = c0 + c1 (x - shift) / scale.
        const PsychometricData& from = single[g].likelihood.data();
        const PsychometricData& to = pooled.likelihood.data();
        place = single[g].place;
        place[Place::c0] += place[Place::c1] * (to.shift - from.shift) / from.scale;
        place[Place::c1] *= to.scale / from.scale;
      }
      log_slope += std::log(std::max(place[Place::c1], 1e-6));
      const double pse = (middle - place[Place::c0]) / place[Place::c1];
      const double shared = std::exp(log_slope / static_cast<double>(g + 1));
      start[likelihood.slope_index(g)] = sharing == PsychometricSharing::own_location ? shared : place[Place::c1];
      if (sharing != PsychometricSharing::own_slope)
        start[likelihood.location_index(g)] =
            sharing == PsychometricSharing::own_location ? middle - shared * pse : place[Place::c0];
    }
    if (sharing == PsychometricSharing::own_slope)
      start[2] = (middle - pooled.place[Place::c0]) / pooled.place[Place::c1];
    if (!std::isfinite(likelihood.value(start))) continue;
    NewtonResult found = maximise_in_box(likelihood, start, likelihood.box());
    if (found.value > best.value) best = std::move(found);
  }
  if (best.place.empty()) return fit;
  fit.status = joint_status(likelihood, best, groups, model, sharing);
  if (!is_estimate(fit.status)) return fit;
  fit.log_likelihood = best.value;
  fit.lapse = best.place[0];
  fit.guess = best.place[1];
  return fit;
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

}  // namespace

std::string_view to_string(PsychometricSharing sharing) noexcept {
  switch (sharing) {
    case PsychometricSharing::same_function:
      return "same_function";
    case PsychometricSharing::own_location:
      return "own_location";
    case PsychometricSharing::own_slope:
      return "own_slope";
    case PsychometricSharing::own_function:
      return "own_function";
  }
  return "";
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
  for (std::size_t i = 0; i < own.size(); ++i) {
    SharingFit& fit = result.fits[i + 1];
    if (!pooled.place.empty()) {
      fit = fit_shared(groups, model, own[i], pooled, single);
    } else {
      fit.sharing = own[i];
      fit.status = pooled.fit.status;
    }
  }
  const auto& [one, location, slope, both] = result.fits;
  result.tests = {test_of(one, location), test_of(one, slope), test_of(one, both), test_of(location, both),
                  test_of(slope, both)};
  return result;
}

}  // namespace jnd
