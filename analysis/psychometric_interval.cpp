#include "analysis/psychometric_interval.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/normal.h"
#include "analysis/psychometric_quantity.h"
#include "analysis/psychometric_shape.h"
#include "analysis/psychometric_solution.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;
constexpr double kInf = std::numeric_limits<double>::infinity();

// The likelihood along a curve c0 = h(c1): c0 is held, and follows.
class CurvedLikelihood {
 public:
  CurvedLikelihood(const PsychometricLikelihood& base, PsychometricQuantity quantity, double z)
      : base_(base), quantity_(quantity), z_(z) {}

  std::vector<double> on_curve(std::vector<double> place) const {
    place[Place::c0] = curve(place).h;
    return place;
  }
  double value(const std::vector<double>& place) const { return base_.value(on_curve(place)); }
  void derivatives(const std::vector<double>& place, NewtonDerivatives& out) const {
    const SharedCurve at = curve(place);
    base_.derivatives(on_curve(place), out);
    constexpr std::size_t n = PsychometricLikelihood::variables;
    const double by_c0 = out.gradient[Place::c0];
    for (std::vector<double>* matrix : {&out.curvature, &out.expected}) {
      std::vector<double>& m = *matrix;
      m[Place::c1 * n + Place::c1] += 2 * at.h1 * m[Place::c1 * n] + at.h1 * at.h1 * m[0];
      for (const std::size_t rate : {Place::lapse, Place::guess}) {
        m[Place::c1 * n + rate] += at.h1 * m[rate];
        m[rate * n + Place::c1] = m[Place::c1 * n + rate];
      }
    }
    out.curvature[Place::c1 * n + Place::c1] -= by_c0 * at.h2;
    out.gradient[Place::c1] += by_c0 * at.h1;
  }

 private:
  SharedCurve curve(const std::vector<double>& place) const noexcept {
    return shared_curve(quantity_, base_.data(), z_, place[Place::c1]);
  }
  const PsychometricLikelihood& base_;
  PsychometricQuantity quantity_;
  double z_;
};

// The largest likelihood for a given value of one quantity.
class Profile {
 public:
  Profile(const PsychometricSolution& solution, PsychometricQuantity quantity)
      : solution_(solution), quantity_(quantity), warm_(solution.place) {}

  double at(double z) {
    const PsychometricLikelihood& likelihood = solution_.likelihood;
    NewtonBox box = likelihood.box();
    if (quantity_ == PsychometricQuantity::lapse || quantity_ == PsychometricQuantity::guess) {
      const Place rate = quantity_ == PsychometricQuantity::lapse ? Place::lapse : Place::guess;
      hold(box, rate, z);
      std::vector<std::vector<double>> starts = {warm_, solution_.place};
      for (auto& start : starts) start[rate] = z;
      return best_of(likelihood, starts, box);
    }
    const double c1 = solution_.place[Place::c1];
    const SharedCurve curve = shared_curve(quantity_, likelihood.data(), z, c1);
    if (curve.fixes_c1) {
      hold(box, Place::c1, curve.c1);
      return best_of(likelihood, starts_at_steepness(curve.c1), box);
    }
    hold(box, Place::c0, 0);
    box.lower[Place::c1] = 1e-300;  // the curves are not defined at 0
    const CurvedLikelihood curved(likelihood, quantity_, z);
    std::vector<std::vector<double>> starts = {warm_};
    const auto add = [&](double steepness) {
      starts.push_back(solution_.place);
      starts.back()[Place::c1] = steepness;
    };
    for (int power = -8; power <= 4; ++power) add(std::ldexp(c1, power));
    // The farther away the shared value, the flatter the functions through the data.
    for (const double steepness : {0.1, 0.3, 1.0, 3.0, 10.0}) add(steepness / (1 + std::abs(z)));
    for (auto& start : starts) start[Place::c0] = 0;
    return best_of(curved, starts, box);
  }

 private:
  static void hold(NewtonBox& box, std::size_t i, double value) { box.lower[i] = box.upper[i] = value; }

  // Functions of one steepness, each through the rate of one level.
  std::vector<std::vector<double>> starts_at_steepness(double c1) const {
    const PsychometricData& data = solution_.likelihood.data();
    const double middle = psychometric_shape_quantile(data.function, 0.5);
    std::vector<std::vector<double>> starts = {warm_, solution_.place};
    starts[1][Place::c0] = middle - c1 * (middle - starts[1][Place::c0]) / starts[1][Place::c1];
    const double guess = starts[1][Place::guess], lapse = starts[1][Place::lapse];
    for (std::size_t i = 0; i < data.levels(); ++i) {
      const double f = (data.k[i] / data.n[i] - guess) / (1 - guess - lapse);
      starts.push_back(solution_.place);
      starts.back()[Place::c0] =
          psychometric_shape_quantile(data.function, std::clamp(f, 1e-3, 1 - 1e-3)) - c1 * data.t[i];
    }
    for (auto& start : starts) start[Place::c1] = c1;
    return starts;
  }

  // The warm start, which comes first, and the best of the others.
  template <typename Function>
  double best_of(const Function& function, const std::vector<std::vector<double>>& starts, const NewtonBox& box) {
    std::size_t best = 0;
    double most = -kInf;
    for (std::size_t i = 0; i < starts.size(); ++i)
      if (const double value = function.value(starts[i]); value > most) {
        most = value;
        best = i;
      }
    double found = -kInf;
    const auto search_from = [&](std::size_t i) {
      if (!std::isfinite(function.value(starts[i]))) return;
      const NewtonResult result = maximise_in_box(function, starts[i], box);
      if (!(result.value > found)) return;
      found = result.value;
      warm_ = result.place;
    };
    search_from(best);
    if (best != 0) search_from(0);
    return found;
  }

  const PsychometricSolution& solution_;
  PsychometricQuantity quantity_;
  std::vector<double> warm_;
};

struct Search {
  double start = 0;          // the estimate, search scale
  double step = 0.5;         // first step
  double low = 0, high = 0;  // the ends of the scale
};

// Where the profile falls below target on the way from the estimate to end; end itself where it does not.
double crossing(const PsychometricSolution& solution, PsychometricQuantity quantity, const Search& search, double end,
                double target) {
  constexpr double kDeepest = 1e3;
  Profile profile(solution, quantity);
  const auto above = [&](double z) { return std::fmax(profile.at(z) - target, -kDeepest); };
  const double direction = end > search.start ? 1 : -1;
  double inside = search.start, inside_value = above(inside);
  if (end == inside || !(inside_value > 0)) return inside;
  double step = search.step, outside = inside + direction * step, outside_value = 0;
  for (;;) {
    if (direction * (outside - end) >= 0) outside = end;
    outside_value = above(outside);
    if (outside_value <= 0) break;
    if (outside == end) return end;
    inside = outside;
    inside_value = outside_value;
    step *= 2;
    outside = search.start + direction * step;
  }
  if (outside_value == 0) return outside;
  const bool up = direction > 0;
  const double precision = 1e-10 * std::fmax(search.step, 1e-3);
  std::uintmax_t most = 100;
  const auto [a, b] = boost::math::tools::toms748_solve(
      above, up ? inside : outside, up ? outside : inside, up ? inside_value : outside_value,
      up ? outside_value : inside_value, [&](double x, double y) { return std::abs(x - y) <= precision; }, most);
  return 0.5 * (a + b);
}

const PsychometricEstimate& fitted(const PsychometricFit& fit, PsychometricQuantity quantity) noexcept {
  switch (quantity) {
    case PsychometricQuantity::location:
      return fit.location;
    case PsychometricQuantity::second:
      return fit.second;
    case PsychometricQuantity::lapse:
      return fit.lapse;
    case PsychometricQuantity::guess:
      return fit.guess;
    case PsychometricQuantity::pse:
      return fit.pse;
    case PsychometricQuantity::jnd:
      return fit.jnd;
    case PsychometricQuantity::slope:
      break;
  }
  return fit.slope;
}

// How far from the estimate a search goes; beyond, nothing bounds the quantity. 1e7 ranges of the levels; a factor of
// exp(60) on the level axis of the Weibull function; a factor of exp(20) of the steepness, where u still has 7 digits.
double reach_of(PsychometricQuantity quantity, const PsychometricData& data) noexcept {
  const bool on_level_axis = quantity == PsychometricQuantity::location || quantity == PsychometricQuantity::pse;
  if (data.function == PsychometricFunction::weibull && quantity != PsychometricQuantity::second) return 60;
  return on_level_axis ? 1e7 : 20;
}

ConfidenceBounds interval_of(const PsychometricSolution& solution, PsychometricQuantity quantity, double drop) {
  const PsychometricData& data = solution.likelihood.data();
  const std::vector<double>& place = solution.place;
  Search search;
  PsychometricEstimate estimate;
  if (quantity == PsychometricQuantity::lapse || quantity == PsychometricQuantity::guess) {
    const bool is_lapse = quantity == PsychometricQuantity::lapse;
    const Place rate = is_lapse ? Place::lapse : Place::guess;
    search = {place[rate], 0.01, solution.likelihood.box().lower[rate], solution.likelihood.box().upper[rate]};
    if (search.low == search.high) return {};
    estimate = fitted(solution.fit, quantity);
    estimate.value = place[rate];
  } else {
    estimate.value = quantity_at(quantity, data, place[Place::c0], place[Place::c1]).value;
    const double start = to_search_scale(quantity, data, estimate.value), reach = reach_of(quantity, data);
    search = {start, 0.5, start - reach, start + reach};
    estimate.se = fitted(solution.fit, quantity).se;
  }
  if (std::isfinite(estimate.se) && estimate.se > 0) {
    const double error = to_search_scale(quantity, data, estimate.value + estimate.se) - search.start;
    search.step = std::clamp(1.5 * std::abs(error), 1e-6, 2.0);
  }
  const double target = solution.value - drop;
  const bool steep = solution.fit.status == PsychometricStatus::separated;
  const bool flat = solution.fit.status == PsychometricStatus::not_increasing;
  // Towards the edge on which the estimate lies there is nothing to cross.
  const bool falls = quantity == PsychometricQuantity::jnd;  // the scale on which steeper means smaller
  const bool sided = falls || quantity == PsychometricQuantity::second || quantity == PsychometricQuantity::slope;
  const bool open_low = sided && (falls ? steep : flat), open_high = sided && (falls ? flat : steep);
  double low = open_low ? search.low : crossing(solution, quantity, search, search.low, target);
  double high = open_high ? search.high : crossing(solution, quantity, search, search.high, target);
  if (quantity == PsychometricQuantity::lapse || quantity == PsychometricQuantity::guess) return {low, high};
  if (low <= search.low) low = -kInf;
  if (high >= search.high) high = kInf;
  const double a = from_search_scale(quantity, data, low), b = from_search_scale(quantity, data, high);
  return {std::fmin(a, b), std::fmax(a, b)};
}

}  // namespace

PsychometricIntervals psychometric_profile(std::span<const PsychometricLevel> levels, const PsychometricModel& model,
                                           double confidence) {
  PsychometricIntervals intervals;
  intervals.confidence = confidence;
  const PsychometricSolution solution = solve_psychometric(levels, model);
  if (solution.place.empty()) return intervals;
  const double z = normal_quantile(0.5 + 0.5 * confidence);
  const bool flat = solution.fit.status == PsychometricStatus::not_increasing;
  const auto fill = [&](ConfidenceBounds& bounds, PsychometricQuantity quantity) {
    bounds = interval_of(solution, quantity, 0.5 * z * z);
  };
  fill(intervals.second, PsychometricQuantity::second);
  if (flat && model.function == PsychometricFunction::weibull) return intervals;
  fill(intervals.jnd, PsychometricQuantity::jnd);
  fill(intervals.slope, PsychometricQuantity::slope);
  if (flat) return intervals;
  fill(intervals.location, PsychometricQuantity::location);
  fill(intervals.pse, PsychometricQuantity::pse);
  fill(intervals.lapse, PsychometricQuantity::lapse);
  fill(intervals.guess, PsychometricQuantity::guess);
  return intervals;
}

}  // namespace jnd
