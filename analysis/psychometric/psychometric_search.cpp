#include "analysis/psychometric/psychometric_search.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

namespace {

using Place = PsychometricLikelihood::Place;

// ---- the edges

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

// ---- the survey

namespace {

constexpr double kTail = 1e-6;          // of F: nearer to 0 or 1 it counts as there
constexpr double kSteeper = 1.5;        // from row to row
constexpr double kFlattest = 8;         // rise of the first row, in ranges of the levels
constexpr double kSteepest = 6;         // rises of the last row between neighbouring levels
constexpr double kStep = 0.25;          // along a row, in rises
constexpr double kNear = 3;             // rises from a level, beyond which a gap between levels is skipped
constexpr double kMerged = 0.1;         // widest cell, in rises
constexpr double kMergedError = 1e-3;   // of log-likelihood a trial, at most, by merging
constexpr double kSteepestAlong = 1e4;  // rises of the last function of a curve in the range of the levels
constexpr std::size_t kParts = 1000;    // of many levels: the narrowest of them sets the steepest row

}  // namespace

PsychometricSurvey::PsychometricSurvey(const PsychometricLikelihood& likelihood, const NewtonBox& box)
    : likelihood_(likelihood),
      data_(likelihood.data()),
      box_(box),
      low_(psychometric_shape_quantile(data_.function, kTail)),
      middle_(psychometric_shape_quantile(data_.function, 0.5)),
      high_(psychometric_shape_quantile(data_.function, 1 - kTail)),
      rise_(psychometric_shape_quantile(data_.function, 0.75) - psychometric_shape_quantile(data_.function, 0.25)),
      nearest_(kInf) {
  const std::size_t apart = 1 + data_.levels() / kParts;
  double n = 0, k = 0, t = 0, best = 0;
  for (std::size_t i = 0; i <= data_.levels(); ++i) {
    n_before_.push_back(n);
    k_before_.push_back(k);
    t_before_.push_back(t);
    best_before_.push_back(best);
    if (i == data_.levels()) break;
    if (i >= apart) nearest_ = std::min(nearest_, data_.t[i] - data_.t[i - apart]);
    n += data_.n[i];
    k += data_.k[i];
    t += data_.n[i] * data_.t[i];
    best += rates_log(data_.n[i], data_.k[i], data_.k[i] / data_.n[i]);
  }
  nearest_ = std::max(nearest_, data_.least_distance());
  lapse_ = 0.5 * (box_.lower[Place::lapse] + box_.upper[Place::lapse]);
  guess_ = 0.5 * (box_.lower[Place::guess] + box_.upper[Place::guess]);
}

void PsychometricSurvey::hold(Place rate, double value) {
  box_.lower[rate] = box_.upper[rate] = value;
}

const PsychometricSurvey::Cells& PsychometricSurvey::cells_for(double c1) {
  const bool exact = data_.levels() <= kExactLevels;
  const int power = exact ? 0 : static_cast<int>(std::floor(std::log2(kMerged * rise_ / c1)));
  auto found = cells_.find(power);
  if (found == cells_.end()) found = cells_.emplace(power, cells_of_width(exact ? 0 : std::ldexp(1.0, power))).first;
  return found->second;
}

PsychometricSurvey::Cells PsychometricSurvey::cells_of_width(double width) const {
  PsychometricData merged;
  merged.function = data_.function;
  merged.shift = data_.shift;
  merged.scale = data_.scale;
  merged.trials = data_.trials;
  merged.answers = data_.answers;
  merged.saturated = data_.saturated;
  std::vector<double> n_before, k_before, best_before;
  const auto add_sums = [&](std::size_t level) {
    n_before.push_back(n_before_[level]);
    k_before.push_back(k_before_[level]);
    best_before.push_back(best_before_[level]);
  };
  for (std::size_t first = 0; first < data_.levels();) {
    // Galloping: cells of many levels are passed in few steps.
    const double end = data_.t[first] + width;
    std::size_t reach = 1;
    while (first + reach < data_.levels() && data_.t[first + reach] <= end) reach *= 2;
    const auto begin = data_.t.begin();
    const auto past =
        std::upper_bound(begin + static_cast<std::ptrdiff_t>(first + reach / 2),
                         begin + static_cast<std::ptrdiff_t>(std::min(first + reach, data_.levels())), end);
    const auto next = std::max(static_cast<std::size_t>(past - begin), first + 1);
    const double n = n_before_[next] - n_before_[first];
    add_sums(first);
    merged.t.push_back(next == first + 1 ? data_.t[first] : (t_before_[next] - t_before_[first]) / n);
    merged.n.push_back(n);
    merged.k.push_back(k_before_[next] - k_before_[first]);
    first = next;
  }
  add_sums(data_.levels());
  merged.x = merged.t;  // counts the cells
  return {PsychometricLikelihood(likelihood_, std::move(merged)), std::move(n_before), std::move(k_before),
          std::move(best_before)};
}

// The largest likelihood of the weighed values of F over the rates, by Newton steps within the box; -inf is no value of
// it where the rates are free.
double PsychometricSurvey::best_rates(double& lapse, double& guess) const {
  constexpr int kMostSteps = 12;
  constexpr double kEnough = 1e-4, kTowardsZero = 0.1;
  const double lapse_range = box_.upper[Place::lapse] - box_.lower[Place::lapse];
  const double guess_range = box_.upper[Place::guess] - box_.lower[Place::guess];
  const double a = likelihood_.prior_a(), b = likelihood_.prior_b();
  const auto moved = [](double from, double step, double lower, double upper) {
    // A likelihood may end at a rate of 0: nearer and nearer to it, never beyond.
    const double least = lower < 1e-9 ? lower + kTowardsZero * (from - lower) : lower;
    return std::clamp(from + step, least, upper);
  };
  for (int i = 0; i < kMostSteps && (lapse_range > 0 || guess_range > 0); ++i) {
    double by_lapse = a / std::max(lapse, kLeastRate) - b / (1 - lapse), by_guess = 0;
    double lapse_twice = a / std::max(lapse * lapse, kLeastRate) + b / ((1 - lapse) * (1 - lapse));
    double both = 0, guess_twice = 0;
    for (const Weighed& cell : weighed_) {
      const double p = std::max(guess * cell.upper + (1 - lapse) * cell.g, kLeastRate);
      const double q = std::max(lapse * cell.g + (1 - guess) * cell.upper, kLeastRate);
      const double yes = cell.k / p, no = (cell.n - cell.k) / q;
      const double score = yes - no, weight = yes / p + no / q;
      by_lapse -= score * cell.g;
      by_guess += score * cell.upper;
      lapse_twice += weight * cell.g * cell.g;
      both -= weight * cell.g * cell.upper;
      guess_twice += weight * cell.upper * cell.upper;
    }
    const auto held = [](double at, double slope, double lower, double upper) {
      return lower == upper || (at >= upper && slope >= 0) || (at <= lower && slope <= 0);
    };
    const bool lapse_held = held(lapse, by_lapse, box_.lower[Place::lapse], box_.upper[Place::lapse]);
    const bool guess_held = held(guess, by_guess, box_.lower[Place::guess], box_.upper[Place::guess]);
    if (lapse_held && guess_held) break;
    double lapse_step = lapse_held ? 0 : by_lapse / lapse_twice, guess_step = guess_held ? 0 : by_guess / guess_twice;
    const double determinant = lapse_twice * guess_twice - both * both;
    if (!lapse_held && !guess_held && determinant > 1e-9 * lapse_twice * guess_twice) {
      lapse_step = (guess_twice * by_lapse - both * by_guess) / determinant;
      guess_step = (lapse_twice * by_guess - both * by_lapse) / determinant;
    }
    if (!std::isfinite(lapse_step) || !std::isfinite(guess_step)) break;
    const double lapse_before = lapse, guess_before = guess;
    lapse = moved(lapse, lapse_step, box_.lower[Place::lapse], box_.upper[Place::lapse]);
    guess = moved(guess, guess_step, box_.lower[Place::guess], box_.upper[Place::guess]);
    if (std::abs(lapse - lapse_before) <= kEnough * lapse_range &&
        std::abs(guess - guess_before) <= kEnough * guess_range)
      break;
  }
  double value = likelihood_.log_prior(lapse);
  for (const Weighed& cell : weighed_)
    value += count_log(cell.k, guess * cell.upper + (1 - lapse) * cell.g) +
             count_log(cell.n - cell.k, lapse * cell.g + (1 - guess) * cell.upper);
  return std::isnan(value) ? -kInf : value;
}

PsychometricSurvey::Point PsychometricSurvey::at(double c0, double c1) {
  const Cells& cells = cells_for(c1);
  const PsychometricData& data = cells.likelihood.data();
  const auto begin = data.t.begin();
  auto first = static_cast<std::size_t>(std::lower_bound(begin, data.t.end(), (low_ - c0) / c1) - begin);
  auto last = static_cast<std::size_t>(std::upper_bound(begin, data.t.end(), (high_ - c0) / c1) - begin);
  // Where a rate is known to be 0, answers far out on its side are not impossible but ever less likely.
  if (box_.upper[Place::guess] == 0 && cells.k_before[first] > 0) first = 0;
  const double n_above = cells.n_before.back() - cells.n_before[last];
  const double k_above = cells.k_before.back() - cells.k_before[last];
  if (box_.upper[Place::lapse] == 0 && k_above < n_above) last = data.levels();
  weighed_.clear();
  if (first > 0) weighed_.push_back({cells.n_before[first], cells.k_before[first], 0, 1});
  for (std::size_t i = first; i < last; ++i) {
    const PsychometricShape shape = psychometric_shape(data.function, c0 + c1 * data.t[i]);
    weighed_.push_back({data.n[i], data.k[i], shape.g, shape.upper});
  }
  if (last < data.levels()) weighed_.push_back({n_above, k_above, 1, 0});
  // Not from an edge, where Newton steps of a rate near 0 are small.
  const auto inside = [&](double rate, Place place) {
    const double margin = 0.02 * (box_.upper[place] - box_.lower[place]);
    return std::clamp(rate, box_.lower[place] + margin, box_.upper[place] - margin);
  };
  Point point{c0, c1, inside(lapse_, Place::lapse), inside(guess_, Place::guess), 0};
  point.value = best_rates(point.lapse, point.guess);
  lapse_ = point.lapse;
  guess_ = point.guess;
  return point;
}

// No function of this steepness or a greater one, with its middle within slack of t, has a larger likelihood.
double PsychometricSurvey::bound(const Cells& cells, double t, double c1, double slack) const {
  const auto begin = cells.t().begin(), end = cells.t().end();
  const auto first = static_cast<std::size_t>(std::lower_bound(begin, end, t - (middle_ - low_) / c1 - slack) - begin);
  const auto last = static_cast<std::size_t>(std::upper_bound(begin, end, t + (high_ - middle_) / c1 + slack) - begin);
  const double n_below = cells.n_before[first], k_below = cells.k_before[first];
  const double n_above = cells.n_before.back() - cells.n_before[last];
  const double missed = n_above - (cells.k_before.back() - cells.k_before[last]);
  // Beyond the rise a rate may still be 1e-6 off the known one.
  const double guess =
      std::clamp(n_below > 0 ? k_below / n_below : 0, box_.lower[Place::guess], box_.upper[Place::guess] + kTail);
  const double lapse =
      std::clamp(n_above > 0 ? missed / n_above : 0, box_.lower[Place::lapse], box_.upper[Place::lapse] + kTail);
  const double a = likelihood_.prior_a(), b = likelihood_.prior_b();
  const double likely = a + b > 0 ? std::clamp(a / (a + b), box_.lower[Place::lapse], box_.upper[Place::lapse]) : 0;
  return rates_log(n_below, k_below, guess) + rates_log(n_above, missed, lapse) + cells.best_before[last] -
         cells.best_before[first] + likelihood_.log_prior(likely) + 4 * kTail * data_.trials;
}

// All functions of this steepness that have a level on their rise.
PsychometricSurvey::Stretch PsychometricSurvey::whole_row(double c1) const noexcept {
  return {data_.t.front() - (high_ - middle_) / c1, data_.t.back() + (middle_ - low_) / c1};
}

// The functions of one steepness, a quarter of their rise apart, within the stretches; these become what is left of
// them. Of a gap between levels much wider than the rise, one place is enough.
std::vector<PsychometricSurvey::Point> PsychometricSurvey::row(double c1, std::vector<Stretch>& stretches,
                                                               double& best) {
  const Cells& cells = cells_for(c1);
  const Stretch whole = whole_row(c1);
  const double step = kStep * rise_ / c1, near = kNear * rise_ / c1;
  const double merging = data_.levels() > kExactLevels ? kMergedError * data_.trials : 0;
  std::vector<Point> points;
  std::vector<Stretch> left;
  for (const Stretch& stretch : stretches) {
    const double to = std::min(stretch.to, whole.to);
    double t = std::max(stretch.from, whole.from);
    auto next = std::upper_bound(cells.t().begin(), cells.t().end(), t);
    while (t <= to) {
      if (bound(cells, t, c1, step) >= best - merging) {
        points.push_back(at(middle_ - c1 * t, c1));
        best = std::max(best, points.back().value);
        if (!left.empty() && left.back().to >= t - step)
          left.back().to = t + step;
        else
          left.push_back({t - step, t + step});
      }
      t = std::max(t + step, std::nextafter(t, kInf));  // a step may be less than the last digit of t
      while (next != cells.t().end() && *next <= t) ++next;
      const bool in_gap = next != cells.t().begin() && next != cells.t().end();
      if (in_gap && t - *(next - 1) > near && *next - t > near) t = *next - near;
    }
  }
  stretches = std::move(left);
  return points;
}

namespace {

std::vector<PsychometricSurvey::Point> best_of(std::vector<PsychometricSurvey::Point> found, std::size_t most) {
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
  if (found.size() > most) found.resize(most);
  return found;
}

bool is_peak(const std::vector<PsychometricSurvey::Point>& points, std::size_t i) {
  // Of equals, such as steps in one gap, the first.
  return std::isfinite(points[i].value) && !(i > 0 && points[i - 1].value >= points[i].value) &&
         !(i + 1 < points.size() && points[i + 1].value > points[i].value);
}

}  // namespace

std::vector<PsychometricSurvey::Point> PsychometricSurvey::peaks(std::size_t most, double known) {
  const double flattest = rise_ / (kFlattest * data_.range()), steepest = kSteeper * kSteepest * rise_ / nearest_;
  std::vector<Stretch> stretches = {whole_row(flattest)};
  double best = known;
  std::vector<Point> found;
  double c1 = flattest;
  while (c1 <= steepest && c1 < kInf && !stretches.empty()) {  // infinite where all levels are at one t
    const std::vector<Point> points = row(c1, stretches, best);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (is_peak(points, i)) found.push_back(points[i]);
    c1 *= kSteeper;
  }
  return best_of(std::move(found), most);
}

std::vector<PsychometricSurvey::Point> PsychometricSurvey::peaks_at(double c1, std::size_t most, double known) {
  std::vector<Stretch> stretches = {whole_row(c1)};
  const std::vector<Point> found = row(c1, stretches, known);
  std::vector<Point> peaks;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (is_peak(found, i)) peaks.push_back(found[i]);
  return best_of(std::move(peaks), most);
}

std::vector<PsychometricSurvey::Point> PsychometricSurvey::peaks_along(const std::function<double(double)>& h,
                                                                       std::size_t most) {
  // From what is all but flat even far away from the levels.
  const double flattest = 1e-3 * rise_ / data_.range();
  const double steepest = std::min(kSteepest * rise_ / nearest_, kSteepestAlong * rise_ / data_.range());
  std::vector<Point> points, peaks;
  double c1 = flattest;
  while (c1 <= kSteeper * steepest && c1 < kInf) {
    points.push_back(at(h(c1), c1));
    c1 *= kSteeper;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_peak(points, i)) peaks.push_back(points[i]);
  return best_of(std::move(peaks), most);
}

// ---- the search

namespace {

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
