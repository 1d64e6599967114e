// The search for the largest likelihood of a psychometric function.
#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_shape.h"
#include "analysis/psychometric/psychometric_solution.h"
#include "analysis/psychometric/psychometric_survey.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

// Regression of G^-1 of the empirical rates on t, weighted by trials; guess and lapse 0.
std::vector<double> by_regression(const PsychometricLikelihood& likelihood) {
  const PsychometricData& data = likelihood.data();
  double n_sum = 0, u_sum = 0, t_sum = 0;
  std::vector<double> u;
  for (std::size_t i = 0; i < data.levels(); ++i) {
    u.push_back(psychometric_shape_quantile(data.function, (data.k[i] + 0.5) / (data.n[i] + 1)));
    n_sum += data.n[i];
    u_sum += data.n[i] * u.back();
    t_sum += data.n[i] * data.t[i];
  }
  double tu = 0, tt = 0;
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double t = data.t[i] - t_sum / n_sum;
    tu += data.n[i] * t * u[i];
    tt += data.n[i] * t * t;
  }
  const double slope = std::max(tu / tt, 0.1 / data.range());
  return {u_sum / n_sum - slope * t_sum / n_sum, slope, 0, 0};
}

// With guess and lapse 0 and fixed the log-likelihood of all four shapes is concave in (c0, c1): one start is enough.
NewtonResult concave_maximum(const PsychometricLikelihood& likelihood) {
  std::vector<double> start = by_regression(likelihood);
  // A function so flat that no rate is impossible under it.
  if (!std::isfinite(likelihood.value(start))) start = {0, 1e-3 / likelihood.data().range(), 0, 0};
  return maximise_in_box(likelihood, start, likelihood.box());
}

// So near that a search from one would end at the other.
bool alike(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double kNear = 1e-3;
  const double steepness = std::max({a[Place::c1], b[Place::c1], 1e-300});
  return std::abs(a[Place::c1] - b[Place::c1]) <= kNear * steepness &&
         std::abs(a[Place::c0] - b[Place::c0]) <= kNear * (1 + std::abs(a[Place::c0])) &&
         std::abs(a[Place::lapse] - b[Place::lapse]) <= kNear && std::abs(a[Place::guess] - b[Place::guess]) <= kNear;
}

void keep_better(NewtonResult& best, const PsychometricLikelihood& likelihood, const std::vector<double>& start) {
  if (!std::isfinite(likelihood.value(start))) return;
  NewtonResult found = maximise_in_box(likelihood, start, likelihood.box(), best.value);
  // Of two searches to the same place the one that got there.
  const bool better = found.value > best.value + (best.converged && !found.converged ? 1e-9 : 0);
  if (better || (found.converged && !best.converged && found.value >= best.value - 1e-9)) best = std::move(found);
}

// A maximum at an edge of the rates may lie close beside one inside: the best of each edge is a start of its own.
void search_edges(NewtonResult& best, const PsychometricLikelihood& likelihood) {
  const NewtonBox& box = likelihood.box();
  for (const Place rate : {Place::lapse, Place::guess})
    for (const double edge : {box.lower[rate], box.upper[rate]}) {
      if (box.lower[rate] == box.upper[rate] || best.place[rate] == edge) continue;
      NewtonBox at_edge = box;
      at_edge.lower[rate] = at_edge.upper[rate] = edge;
      std::vector<double> start = best.place;
      start[rate] = edge;
      if (!std::isfinite(likelihood.value(start))) continue;
      keep_better(best, likelihood, maximise_in_box(likelihood, start, at_edge).place);
    }
}

}  // namespace

NewtonResult psychometric_maximum(const PsychometricLikelihood& likelihood, double known) {
  constexpr std::size_t kPeaks = 400, kLongSearches = 3;  // most that are searched from; those on all of many levels
  const NewtonBox& box = likelihood.box();
  if (box.upper[Place::lapse] == 0 && box.upper[Place::guess] == 0) return concave_maximum(likelihood);
  PsychometricSurvey survey(likelihood, box);
  const bool many = likelihood.data().levels() > kExactLevels;
  std::vector<NewtonResult> starts;
  for (const PsychometricSurvey::Point& peak : survey.peaks(kPeaks, known)) {
    NewtonResult start;
    start.place = peak.place();
    start.value = peak.value;
    if (many) start = maximise_in_box(survey.merged(peak.c1), start.place, box);
    starts.push_back(std::move(start));
  }
  if (many) {
    std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
    const auto same = [](const NewtonResult& a, const NewtonResult& b) { return alike(a.place, b.place); };
    starts.erase(std::unique(starts.begin(), starts.end(), same), starts.end());
    if (starts.size() > kLongSearches) starts.resize(kLongSearches);
  }
  NewtonResult best;
  best.value = -kInf;
  for (const NewtonResult& start : starts) keep_better(best, likelihood, start.place);
  if (!best.place.empty()) search_edges(best, likelihood);
  return best;
}

}  // namespace jnd
