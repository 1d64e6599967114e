// Where the search for the largest likelihood begins.
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/psychometric_edges.h"
#include "analysis/psychometric_shape.h"
#include "analysis/psychometric_solution.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

struct Start {
  std::vector<double> place;
  double value = 0;
};

// Regression of G^-1 of the empirical rates, freed from guess and lapse, on t; weighted by trials.
std::vector<double> by_regression(const PsychometricLikelihood& likelihood, double lapse, double guess) {
  const PsychometricData& data = likelihood.data();
  double n_sum = 0, u_sum = 0, t_sum = 0;
  std::vector<double> u;
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double rate = ((data.k[i] + 0.5) / (data.n[i] + 1) - guess) / (1 - guess - lapse);
    const double least = 0.5 / (data.n[i] + 1);
    u.push_back(psychometric_shape_quantile(data.function, std::clamp(rate, least, 1 - least)));
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
  return {u_sum / n_sum - slope * t_sum / n_sum, slope, lapse, guess};
}

void keep(std::vector<Start>& starts, const PsychometricLikelihood& likelihood, std::vector<double> place) {
  const double value = likelihood.value(place);
  if (std::isfinite(value)) starts.push_back({std::move(place), value});
}

// The likelihood of one (c0, c1) under each choice of the rates; the shape is evaluated once for all of them. best: one
// entry a choice, the best so far.
void keep_best(std::vector<Start>& best, const PsychometricLikelihood& likelihood, double c0, double c1,
               std::vector<PsychometricShape>& shapes) {
  const PsychometricData& data = likelihood.data();
  shapes.clear();
  for (const double t : data.t) shapes.push_back(psychometric_shape(data.function, c0 + c1 * t));
  for (Start& start : best) {
    const double lapse = start.place[Place::lapse], guess = start.place[Place::guess], span = 1 - guess - lapse;
    double value = likelihood.log_prior(lapse);
    for (std::size_t i = 0; i < shapes.size(); ++i)
      value += count_log(data.k[i], guess + span * shapes[i].g) +
               count_log(data.n[i] - data.k[i], lapse + span * shapes[i].upper);
    if (value > start.value) start = {{c0, c1, lapse, guess}, value};
  }
}

// With guess and lapse 0 and fixed the log-likelihood of all four shapes is concave in (c0, c1): one start is enough.
bool concave(const NewtonBox& box) {
  return box.upper[Place::lapse] == 0 && box.upper[Place::guess] == 0;
}

}  // namespace

std::vector<std::vector<double>> psychometric_starts(const PsychometricLikelihood& likelihood) {
  constexpr int kLocations = 8;
  const NewtonBox& box = likelihood.box();
  const PsychometricData& data = likelihood.data();
  const auto choices = [&box](Place place, double low, double high) {
    if (box.lower[place] == box.upper[place]) return std::vector<double>{box.lower[place]};
    return std::vector<double>{low, high};
  };
  const std::vector<double> lapses = choices(Place::lapse, 0.005, 0.07), guesses = choices(Place::guess, 0.02, 0.25);
  std::vector<Start> starts;
  const bool known_rates = lapses.size() * guesses.size() == 1;
  if (known_rates) keep(starts, likelihood, by_regression(likelihood, lapses.front(), guesses.front()));
  if (!concave(box) || starts.empty()) {
    // Several maxima differ in their rates (a steep function with lapses, a flatter one without): a start for each.
    std::vector<Start> best;
    for (const double lapse : lapses)
      for (const double guess : guesses)
        best.push_back({{0, 0, lapse, guess}, -std::numeric_limits<double>::infinity()});
    std::vector<PsychometricShape> shapes;
    const double middle = psychometric_shape_quantile(data.function, 0.5);
    for (const double steepness : {1.5, 4.0, 12.0, 40.0})
      for (int at = 0; at < kLocations; ++at) {
        // From a quarter of the range below the levels to a quarter above.
        const double t = data.t.front() + data.range() * (1.5 * (at + 0.5) / kLocations - 0.25);
        const double c1 = steepness / data.range();
        keep_best(best, likelihood, middle - c1 * t, c1, shapes);
      }
    for (Start& start : best)
      if (std::isfinite(start.value)) starts.push_back(std::move(start));
  }
  if (!concave(box)) {
    // And near the best step, with 4 and with 1 of u between neighbouring levels: maxima there are narrow, and may lie
    // beyond the last level. Known rates may allow no step at all.
    const PsychometricEdge step = step_edge(likelihood);
    const double u = step.c0 + step.c1 * step.t;
    for (const double gentler : {0.1, 0.025})
      if (std::isfinite(step.value))
        keep(starts, likelihood, {u - gentler * step.c1 * step.t, gentler * step.c1, step.lapse, step.guess});
  }
  std::vector<std::vector<double>> places;
  places.reserve(starts.size());
  for (Start& start : starts) places.push_back(std::move(start.place));
  // A function so flat that no rate is impossible under it.
  if (places.empty()) places.push_back({0, 1e-3 / data.range(), lapses.back(), guesses.back()});
  return places;
}

}  // namespace jnd
