#include "analysis/psychometric/psychometric_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "analysis/psychometric/psychometric_quantity.h"
#include "analysis/psychometric/psychometric_search.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

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
      : solution_(solution),
        quantity_(quantity),
        survey_(solution.likelihood, solution.likelihood.box()),
        warm_(solution.place) {}

  double at(double z) {
    const PsychometricLikelihood& likelihood = solution_.likelihood;
    const auto plain = [](const PsychometricLikelihood& of) -> const PsychometricLikelihood& { return of; };
    NewtonBox box = likelihood.box();
    if (quantity_ == PsychometricQuantity::lapse || quantity_ == PsychometricQuantity::guess) {
      const Place rate = quantity_ == PsychometricQuantity::lapse ? Place::lapse : Place::guess;
      hold(box, rate, z);
      survey_.hold(rate, z);
      warm_[rate] = z;
      return best_of(plain, box, [&](double known) { return survey_.peaks(kMostPeaks, known); });
    }
    const SharedCurve curve = shared_curve(quantity_, likelihood.data(), z, warm_[Place::c1]);
    if (curve.fixes_c1) {
      hold(box, Place::c1, curve.c1);
      // Steeper or flatter about the middle of F.
      const double middle = survey_.middle();
      warm_[Place::c0] = middle - curve.c1 * (middle - warm_[Place::c0]) / warm_[Place::c1];
      warm_[Place::c1] = curve.c1;
      return best_of(plain, box, [&](double known) { return survey_.peaks_at(curve.c1, kMostPeaks, known); });
    }
    hold(box, Place::c0, 0);
    box.lower[Place::c1] = 1e-300;  // the curves are not defined at 0
    warm_[Place::c0] = 0;
    const auto curved = [&](const PsychometricLikelihood& of) { return CurvedLikelihood(of, quantity_, z); };
    const auto h = [&](double c1) { return shared_curve(quantity_, likelihood.data(), z, c1).h; };
    return best_of(curved, box, [&](double) {
      std::vector<PsychometricSurvey::Point> points = survey_.peaks_along(h, kMostPeaks);
      for (PsychometricSurvey::Point& point : points) point.c0 = 0;
      return points;
    });
  }

 private:
  static constexpr std::size_t kMostPeaks = 4;

  static void hold(NewtonBox& box, std::size_t i, double value) { box.lower[i] = box.upper[i] = value; }

  // From where the last search ended, and from the peaks of the survey. Of many levels a search goes on from a peak
  // only where that of the merged levels gains something.
  template <typename FunctionOf, typename Peaks>
  double best_of(FunctionOf&& function_of, const NewtonBox& box, Peaks&& peaks) {
    constexpr double kGain = 1e-3;
    const auto& function = function_of(solution_.likelihood);
    NewtonResult best;
    best.value = -kInf;
    if (std::isfinite(function.value(warm_))) best = maximise_in_box(function, warm_, box);
    for (const PsychometricSurvey::Point& peak : peaks(best.value)) {
      std::vector<double> start = peak.place();
      if (solution_.likelihood.data().levels() > kExactLevels) {
        const auto& merged = function_of(survey_.merged(peak.c1));
        if (!std::isfinite(merged.value(start))) continue;
        NewtonResult found = maximise_in_box(merged, start, box);
        if (!best.place.empty() && std::isfinite(merged.value(best.place)) &&
            found.value <= maximise_in_box(merged, best.place, box).value + kGain)
          continue;
        start = std::move(found.place);
      }
      if (!std::isfinite(function.value(start))) continue;
      NewtonResult found = maximise_in_box(function, start, box, best.value);
      if (found.value > best.value) best = std::move(found);
    }
    if (!best.place.empty()) warm_ = best.place;
    return best.value;
  }

  const PsychometricSolution& solution_;
  PsychometricQuantity quantity_;
  PsychometricSurvey survey_;
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

// On a linear axis JND and slope are the second parameter in other units.
void take_from_second(PsychometricIntervals& intervals, PsychometricFunction function) {
  const double middle = psychometric_shape_quantile(function, 0.5);
  const double width = psychometric_shape_quantile(function, 0.75) - middle;
  const double at_middle = psychometric_shape(function, middle).first;
  const auto [low, high] = intervals.second;
  if (function == PsychometricFunction::gaussian) {
    intervals.jnd = {width * low, width * high};
    intervals.slope = {at_middle / high, at_middle / low};
  } else {
    intervals.jnd = {width / high, width / low};
    intervals.slope = {at_middle * low, at_middle * high};
  }
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
  const bool logarithmic = model.function == PsychometricFunction::weibull;
  if (flat && logarithmic) return intervals;
  if (logarithmic) {
    fill(intervals.jnd, PsychometricQuantity::jnd);
    fill(intervals.slope, PsychometricQuantity::slope);
  } else {
    take_from_second(intervals, model.function);
  }
  if (flat) return intervals;
  fill(intervals.location, PsychometricQuantity::location);
  if (psychometric_shape_quantile(model.function, 0.5) == 0)
    intervals.pse = intervals.location;
  else
    fill(intervals.pse, PsychometricQuantity::pse);
  fill(intervals.lapse, PsychometricQuantity::lapse);
  fill(intervals.guess, PsychometricQuantity::guess);
  return intervals;
}

namespace {

// Quantile by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996); no interpolation towards
// an infinite one: the nearer counts. sorted is not empty.
double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(below);
  const double low = sorted[below], high = sorted[std::min(below + 1, sorted.size() - 1)];
  if (std::isinf(low) || std::isinf(high)) return part < 0.5 ? low : high;
  return low + part * (high - low);
}

ConfidenceBounds percentiles(std::vector<double>& values, double confidence) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5 - 0.5 * confidence), quantile(values, 0.5 + 0.5 * confidence)};
}

struct Collected {
  std::vector<double> location, second, lapse, guess, pse, jnd, slope;
};

void add(std::vector<double>& values, double value) {
  if (!std::isnan(value)) values.push_back(value);
}

void collect(Collected& all, const PsychometricFit& fit) {
  if (fit.status == PsychometricStatus::not_increasing) {
    const bool grows = fit.model.function == PsychometricFunction::gaussian;  // sigma, as the slope falls
    all.second.push_back(grows ? kInf : 0.0);
    all.jnd.push_back(kInf);
    all.slope.push_back(0);
    return;
  }
  add(all.second, fit.second.value);
  add(all.jnd, fit.jnd.value);
  add(all.slope, fit.slope.value);
  add(all.location, fit.location.value);
  add(all.pse, fit.pse.value);
  if (!fit.model.lapse) add(all.lapse, fit.lapse.value);
  if (!fit.model.guess) add(all.guess, fit.guess.value);
}

}  // namespace

PsychometricBootstrap psychometric_bootstrap(std::span<const PsychometricLevel> levels, const PsychometricModel& model,
                                             int replicates, std::uint64_t seed, double confidence,
                                             const std::function<void(int)>& progress) {
  PsychometricBootstrap result;
  result.intervals.confidence = confidence;
  result.replicates = replicates;
  const PsychometricFit fit = fit_psychometric(levels, model);
  if (!is_estimate(fit.status)) return result;

  const PsychometricData data = psychometric_data(levels, model);
  std::vector<BinomialSampler> samplers;
  std::vector<PsychometricLevel> drawn;
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double f = psychometric_cdf(model.function, fit.location.value, fit.second.value, data.x[i]);
    const double p = fit.guess.value + (1 - fit.guess.value - fit.lapse.value) * f;
    samplers.emplace_back(static_cast<int>(data.n[i]), p);
    drawn.push_back({data.x[i], static_cast<int>(data.n[i]), 0});
  }

  std::mt19937_64 generator(seed);
  Collected all;
  int as_bad = 0;
  for (int replicate = 0; replicate < replicates; ++replicate) {
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i].k = samplers[i].at(open_uniform(generator));
    const PsychometricFit again = fit_psychometric(drawn, model);
    if (again.deviance >= fit.deviance) ++as_bad;
    if (is_estimate(again.status))
      ++result.estimates;
    else if (again.status == PsychometricStatus::separated)
      ++result.separated;
    else if (again.status == PsychometricStatus::not_increasing)
      ++result.not_increasing;
    else
      ++result.others;
    collect(all, again);  // of the others every number is NaN
    if (progress) progress(replicate + 1);
  }
  result.with_pse = static_cast<int>(all.pse.size());
  result.deviance_p = (1.0 + as_bad) / (1.0 + replicates);
  result.intervals.location = percentiles(all.location, confidence);
  result.intervals.second = percentiles(all.second, confidence);
  result.intervals.lapse = percentiles(all.lapse, confidence);
  result.intervals.guess = percentiles(all.guess, confidence);
  result.intervals.pse = percentiles(all.pse, confidence);
  result.intervals.jnd = percentiles(all.jnd, confidence);
  result.intervals.slope = percentiles(all.slope, confidence);
  return result;
}

}  // namespace jnd
