#include "analysis/choice/two_interval.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/choice/choice_steps.h"
#include "analysis/numerics/boost_policy.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// A fit with what its profile intervals start from.
struct TwoIntervalSolution {
  TwoIntervalOptions options;  // order_term: only where both orders have trials
  ChoiceData data;
  ChoiceBox box{};
  ChoiceLimit constant, step;  // the limits s -> inf and s -> 0
  ChoicePeak peak;             // the maximum of those between; under separated and flat not always looked for
  TwoIntervalFit fit;
};

// The global maximum in the box: one climb without lapses, from the peaks of a survey with them.
ChoicePeak solve_choice(const ChoiceData& data, const ChoiceBox& box, const ChoicePlace& start, double pivot) {
  if (box.held(kL) && box.lower[kL] == 0) return climb(data, start, box, pivot);
  return climb_from_survey(data, start, box, pivot);
}

constexpr double kNoGain = 1e-9;  // a log-likelihood better by less is not better than a limit that it runs towards

bool has_both_orders(const ChoiceData& data) noexcept {
  bool first = false, second = false;
  for (const double o : data.o) (o < 0 ? first : second) = true;
  return first && second;
}

// Whether the likelihood does not grow with c from the best constant: the slope there, of each order its share, against
// its rounding.
bool slope_is_flat(const ChoiceData& data, const ChoiceLimit& constant) noexcept {
  double n[2] = {}, k[2] = {};
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const std::size_t which = data.o[i] < 0 ? 1 : 0;
    n[which] += data.n[i];
    k[which] += data.k[i];
  }
  double slope = 0, size = 0;
  for (std::size_t which = 0; which < 2; ++which) {
    if (k[which] == 0 || k[which] == n[which]) continue;
    const double rate = k[which] / n[which];
    const double f = std::fmin(1, std::fmax(0, (rate - 0.5 * constant.lapse) / (1 - constant.lapse)));
    if (f == 0 || f == 1) continue;
    double moment = 0, absolute = 0;
    for (std::size_t i = 0; i < data.rows(); ++i) {
      if ((data.o[i] < 0 ? 1U : 0U) != which) continue;
      moment += (data.k[i] - data.n[i] * rate) * data.t[i];
      absolute += data.n[i] * std::abs(data.t[i]);
    }
    const double density =
        data.link == ChoiceLink::probit ? normal_density(choice_quantile(data.link, f)) : f * (1 - f);
    slope += density / (rate * (1 - rate)) * moment;
    size += density / (rate * (1 - rate)) * absolute;
  }
  return slope <= 1e-13 * size;
}

// Without lapses, and where a lower level has the comparison chosen and a higher one not: most data, at little cost.
bool steps_are_impossible(const ChoiceData& data, const TwoIntervalOptions& options) noexcept {
  if (options.order_term || !options.lapse || *options.lapse != 0) return false;
  double lowest_chosen = kInf, highest_rest = -kInf;
  for (std::size_t i = 0; i < data.rows(); ++i) {
    if (data.k[i] > 0) lowest_chosen = std::fmin(lowest_chosen, data.t[i]);
    if (data.k[i] < data.n[i]) highest_rest = std::fmax(highest_rest, data.t[i]);
  }
  return lowest_chosen < highest_rest;
}

// Each row once more, mirrored at the PSE with the other order and the other answers, and all with half their weight: no row
// says anything about the PSE any more, and about s and b what it did.
ChoiceData mirrored_data(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options) {
  std::vector<ChoiceRow> both(rows.begin(), rows.end());
  for (const ChoiceRow& row : rows)
    both.push_back({2 * *options.pse - row.level, row.n, row.n - row.chosen, -row.order});
  ChoiceData data = choice_data(both, options.link, options.order_term);
  for (double& n : data.n) n *= 0.5;
  for (double& k : data.k) k *= 0.5;
  data.trials *= 0.5;
  data.chosen *= 0.5;
  data.saturated *= 0.5;
  return data;
}

// Exactly the level where t is one.
double from_axis(const ChoiceData& data, double t) noexcept {
  for (std::size_t i = 0; i < data.rows(); ++i)
    if (data.t[i] == t) return data.level[i];
  return data.shift + data.scale * t;
}

void take_limit(TwoIntervalFit& fit, const ChoiceLimit& limit, const TwoIntervalOptions& options) {
  fit.log_likelihood = limit.value;
  if (options.order_term) fit.order_b = limit.b;
}

void take_step_limit(TwoIntervalFit& fit, const ChoiceData& data, const ChoiceLimit& step,
                     const TwoIntervalOptions& options) {
  fit.status = TwoIntervalStatus::separated;
  take_limit(fit, step, options);
  fit.lapse = options.lapse ? options.lapse : step.lapse;
  fit.s = 0;
  fit.pse_range = ChoiceBounds{from_axis(data, step.low), from_axis(data, step.high)};
  if (std::isinf(step.low) != std::isinf(step.high))
    fit.pse = std::isinf(step.low) ? step.low : step.high;
  else if (std::isfinite(step.low))
    fit.pse = 0.5 * (fit.pse_range->low + fit.pse_range->high);
}

// All answers of one order are the same: its b is infinite, and the other order alone has the slope.
ChoicePeak climb_of_one_order(const ChoiceData& data, const ChoiceBox& box) {
  ChoiceData other = data;
  other.t.clear();
  other.o.clear();
  other.n.clear();
  other.k.clear();
  int same = 0;
  double certain = 0, all = 0;
  for (const int order : {-1, 1}) {
    double n = 0, k = 0;
    for (std::size_t i = 0; i < data.rows(); ++i) {
      if (data.o[i] != order) continue;
      n += data.n[i];
      k += data.k[i];
    }
    if (k == 0 || k == n) {
      same = order;
      certain = k;
      all = n;
    }
  }
  for (std::size_t i = 0; i < data.rows(); ++i) {
    if (data.o[i] == same) continue;
    other.t.push_back(data.t[i]);
    other.o.push_back(0);
    other.n.push_back(data.n[i]);
    other.k.push_back(data.k[i]);
  }
  ChoiceBox without = box;
  without.hold(kB, 0);
  ChoicePeak peak = solve_choice(other, without, choice_start(other, without), 0);
  peak.value += choice_count_log(all, 1 - 0.5 * peak.place[kL]);
  const double end = certain == 0 ? -kInf : kInf;
  peak.place[kA] = end;
  peak.place[kB] = same * end;
  return peak;
}

bool one_order_is_same(const ChoiceData& data) noexcept {
  double n[2] = {}, k[2] = {};
  for (std::size_t i = 0; i < data.rows(); ++i) {
    const std::size_t which = data.o[i] < 0 ? 1 : 0;
    n[which] += data.n[i];
    k[which] += data.k[i];
  }
  return n[0] > 0 && n[1] > 0 && (k[0] == 0 || k[0] == n[0] || k[1] == 0 || k[1] == n[1]);
}

void take_peak(TwoIntervalFit& fit, const ChoiceData& data, const ChoicePeak& peak, const TwoIntervalOptions& options) {
  fit.status = TwoIntervalStatus::ok;
  fit.log_likelihood = peak.value;
  fit.lapse = options.lapse ? *options.lapse : peak.place[kL];
  fit.s = data.scale / peak.place[kC];
  fit.pse = data.shift - data.scale * (peak.place[kA] / peak.place[kC]);
  if (options.order_term) fit.order_b = peak.place[kB];
}

void take_constant(TwoIntervalFit& fit, const ChoiceLimit& constant, const TwoIntervalOptions& options) {
  fit.status = TwoIntervalStatus::flat;
  take_limit(fit, constant, options);
  fit.lapse = options.lapse;
  fit.s = kInf;
}

// The best of the limits s -> inf and s -> 0 and of what lies between.
void find_maximum(TwoIntervalSolution& solution) {
  const ChoiceData& data = solution.data;
  const TwoIntervalOptions& options = solution.options;
  const double constant = solution.constant.value, step = solution.step.value;
  const bool flat_slope = slope_is_flat(data, solution.constant);
  const bool concave = options.lapse && *options.lapse == 0;
  if (!concave || !(flat_slope || step > -kInf)) {
    const bool one_order = options.order_term && one_order_is_same(data);
    solution.peak = one_order ? climb_of_one_order(data, solution.box)
                              : solve_choice(data, solution.box, choice_start(data, solution.box), 0);
  }
  // Where the slope at the constant is above 0, what lies between is better, by however little.
  const double least = flat_slope ? constant + kNoGain : constant - kNoGain;
  if (solution.peak.place[kC] > 0 && solution.peak.value > step + kNoGain && solution.peak.value > least)
    take_peak(solution.fit, data, solution.peak, options);
  else if (step > constant + kNoGain)
    take_step_limit(solution.fit, data, solution.step, options);
  else
    take_constant(solution.fit, solution.constant, options);
}

TwoIntervalSolution solve_two_interval(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options) {
  if (options.lapse && !(*options.lapse >= 0 && *options.lapse < 1))
    throw std::invalid_argument("the lapse rate must lie in 0..1, 1 left out");
  if (options.pse && !std::isfinite(*options.pse)) throw std::invalid_argument("a fixed PSE must be finite");
  TwoIntervalSolution solution;
  solution.options = options;
  solution.data = options.pse ? mirrored_data(rows, options) : choice_data(rows, options.link, options.order_term);
  const ChoiceData& data = solution.data;
  if (options.order_term && !has_both_orders(data)) {
    solution.options.order_term = false;
    std::fill(solution.data.o.begin(), solution.data.o.end(), 0.0);
  }
  const TwoIntervalOptions& used = solution.options;
  TwoIntervalFit& fit = solution.fit;
  fit.trials = static_cast<long long>(data.trials);
  if (data.rows() == 0) return solution;
  solution.box = choice_box(used.order_term, used.lapse);
  solution.constant = best_constant(data, used.order_term, used.lapse);
  if (!steps_are_impossible(data, used)) solution.step = best_step(data, used.order_term, used.lapse);
  if (data.chosen == 0 || data.chosen == data.trials) {
    fit.status = TwoIntervalStatus::all_same;
    fit.log_likelihood = solution.constant.value;
    fit.lapse = used.lapse ? used.lapse : solution.constant.lapse;
  } else if (!options.pse && std::adjacent_find(data.t.begin(), data.t.end(), std::not_equal_to<>()) == data.t.end()) {
    fit.status = TwoIntervalStatus::not_identified;
    fit.log_likelihood = solution.constant.value;
    fit.lapse = used.lapse;
  } else {
    find_maximum(solution);
  }
  fit.deviance = std::fmax(0, 2 * (data.saturated - *fit.log_likelihood));
  if (options.pse) {
    fit.pse = options.pse;
    fit.pse_range.reset();
  }
  return solution;
}

// ---- profile intervals

constexpr double kChoiceFarthest = 1e7;  // in ranges of the levels, or of slopes: beyond, nothing bounds the parameter

// How far the profile log-likelihoods lie below the maximum. With lapses there may be several peaks on the way, so that
// each point is surveyed and the walks are short.
class ChoiceProfile {
 public:
  explicit ChoiceProfile(const TwoIntervalSolution& solution)
      : solution_(solution), warm_(choice_start(solution.data, solution.box)) {
    if (solution.fit.status == TwoIntervalStatus::ok && std::isfinite(solution.peak.place[kA]))
      warm_ = solution.peak.place;
  }

  bool concave() const noexcept { return solution_.box.held(kL) && solution_.box.lower[kL] == 0; }
  double below(double value) const noexcept { return *solution_.fit.log_likelihood - value; }

  double at_pse(double t) {
    const TwoIntervalSolution& of = solution_;
    ChoiceBox box = of.box;
    box.hold(kA, 0);
    ChoicePlace start = warm_;
    start[kA] = 0;
    start[kC] = std::fmin(start[kC], 50 / (1 + std::abs(t)));
    double best = best_step_at(of.data, of.options.order_term, of.options.lapse, t);
    take(peak_in(box, start, t), best);
    return below(best);
  }

  double at_slope(double c) {
    if (c == 0) return below(solution_.constant.value);
    ChoiceBox box = solution_.box;
    box.hold(kC, c);
    ChoicePlace start = warm_;
    start[kA] = start[kC] > 0 ? start[kA] * c / start[kC] : start[kA];  // the same PSE
    start[kC] = c;
    double best = -kInf;
    take(peak_in(box, start, 0), best);
    return below(best);
  }

  double at_order(double b) {
    ChoiceBox box = solution_.box;
    box.hold(kB, b);
    ChoicePlace start = warm_;
    start[kB] = b;
    double best = -kInf;
    take(peak_in(box, start, 0), best);
    return below(best);
  }

 private:
  ChoicePeak peak_in(const ChoiceBox& box, const ChoicePlace& start, double pivot) const {
    if (!concave()) return climb_from_survey(solution_.data, start, box, pivot);
    if (box.held(kC)) return climb_from_best(solution_.data, start, box, pivot);
    return climb(solution_.data, start, box, pivot);
  }

  static void take(const ChoicePeak& peak, double& best) { best = std::fmax(best, peak.value); }

  const TwoIntervalSolution& solution_;
  ChoicePlace warm_;
};

using ChoiceDrop = std::function<double(double)>;  // of ln L below its largest, where a parameter is held at a value

// Where the drop passes kProfileDrop, between a value with less and one with more.
double choice_crossing(const ChoiceDrop& drop, double inside, double outside) {
  const auto excess = [&](double x) { return std::fmin(drop(x) - kProfileDrop, 1e3); };
  double low = std::fmin(inside, outside), high = std::fmax(inside, outside);
  const double at_low = excess(low), at_high = excess(high);
  if (at_low == 0) return low;
  if (at_high == 0) return high;
  if ((at_low > 0) == (at_high > 0)) return inside;
  const auto close = [](double a, double b) {
    return std::abs(a - b) <= 1e-12 * (1e-3 + std::fmin(std::abs(a), std::abs(b)));
  };
  std::uintmax_t most = 200;
  std::tie(low, high) = boost::math::tools::toms748_solve(excess, low, high, at_low, at_high, close, most);
  return 0.5 * (low + high);
}

// Walks from inside in growing steps until the drop is passed; end where it is not.
double choice_walk(const ChoiceDrop& drop, double inside, double step, double growth, double end) {
  double last = inside;
  for (;;) {
    double next = last + step;
    if (step > 0 ? next >= end : next <= end) next = end;
    if (drop(next) > kProfileDrop) return choice_crossing(drop, last, next);
    if (next == end) return end;
    last = next;
    step *= growth;
  }
}

class ChoiceIntervals {
 public:
  explicit ChoiceIntervals(const TwoIntervalSolution& solution) : of_(solution), profile_(solution) {}

  ChoiceBounds pse() {
    const double below = beside(-1), above = beside(1);  // drops at +inf and at -inf
    const bool open_high = below <= kProfileDrop, open_low = above <= kProfileDrop;
    const double infinite = of_.fit.pse ? *of_.fit.pse : (above <= below ? -kInf : kInf);
    if (of_.fit.status == TwoIntervalStatus::flat || std::isinf(infinite)) {
      if (open_low && open_high) return {-kInf, kInf};
      return infinite < 0 ? ChoiceBounds{-kInf, from_infinity(1)} : ChoiceBounds{from_infinity(-1), kInf};
    }
    double low = 0, high = 0;
    if (of_.fit.status == TwoIntervalStatus::separated)
      low = high = 0.5 * (of_.step.low + of_.step.high);
    else
      low = high = -of_.peak.place[kA] / of_.peak.place[kC];
    const bool between_levels = of_.fit.status == TwoIntervalStatus::separated && of_.step.low < of_.step.high;
    if (between_levels) {  // as good up to its edges
      low = of_.step.low + 1e-10;
      high = of_.step.high - 1e-10;
    }
    return {on_axis(pse_end(low, -1, open_low)), on_axis(pse_end(high, 1, open_high))};
  }

  ChoiceBounds s() {
    const bool steep = of_.fit.status == TwoIntervalStatus::separated, flat = of_.fit.status == TwoIntervalStatus::flat;
    const double c = steep ? kChoiceFarthest : flat ? 0 : of_.peak.place[kC];
    const double steepest = steep ? kInf : steeper(c), flattest = flat ? 0 : flatter(c);
    const double high = flattest > 0 ? of_.data.scale / flattest : kInf;
    return {steepest >= kChoiceFarthest ? 0 : of_.data.scale / steepest, high};
  }

  ChoiceBounds order() {
    const auto drop = [&](double b) { return profile_.at_order(b); };
    const double farthest = of_.data.link == ChoiceLink::probit ? 60 : 400;
    const double b = of_.fit.order_b.value_or(0), growth = profile_.concave() ? 2 : 1.4;
    const double inside = std::clamp(b, -0.5 * farthest, 0.5 * farthest);
    double low = -kInf, high = kInf;
    if (b != kInf) high = choice_walk(drop, inside, 0.2, growth, farthest);
    if (b != -kInf) low = choice_walk(drop, inside, -0.2, growth, -farthest);
    if (b == kInf) low = choice_walk(drop, inside, -0.5, 1.2, -farthest);
    if (b == -kInf) high = choice_walk(drop, inside, 0.5, 1.2, farthest);
    // NOLINTNEXTLINE(bugprone-narrowing-conversions)
    return {low <= -farthest ? -kInf : low, high >= farthest ? kInf : high};
  }

 private:
  double beside(int side) const {
    return profile_.below(best_constant_beside(of_.data, of_.options.order_term, of_.options.lapse, side));
  }

  double pse_end(double inside, int direction, bool open) {
    if (profile_.concave() && open) return direction * kInf;
    const auto drop = [&](double t) { return profile_.at_pse(t); };
    const double width = of_.fit.status == TwoIntervalStatus::ok ? 1 / of_.peak.place[kC] : 0.1;
    const double step = std::clamp(2 * width / std::sqrt(of_.data.trials), 1e-6, 1.0);
    const double found = profile_.concave()
                             ? choice_walk(drop, inside, direction * step, 2, direction * kSteepestChoice)
                             : choice_walk(drop, inside, direction * 0.3 * step, 1.3, direction * (open ? 1e4 : 1e9));
    return std::abs(found) >= (open ? 1e4 : 1e9) ? direction * kInf : found;
  }

  // The end of an interval that begins at -inf (direction 1) or at inf (direction -1).
  double from_infinity(int direction) {
    const auto drop = [&](double t) { return profile_.at_pse(t); };
    double last = -direction * kChoiceFarthest;
    if (drop(last) > kProfileDrop) return -direction * kInf;
    while (std::abs(last) > 1) {
      const double next = last / 2;
      if (drop(next) > kProfileDrop) return on_axis(choice_crossing(drop, last, next));
      last = next;
    }
    const double found = choice_walk(drop, last, direction * 0.05, profile_.concave() ? 1.5 : 1.1, direction * 1e9);
    return std::abs(found) >= 1e9 ? direction * kInf : on_axis(found);
  }

  double steeper(double c) {
    const auto drop = [&](double slope) { return profile_.at_slope(slope); };
    const double factor = profile_.concave() ? 2 : 1.3;
    return choice_walk(drop, c, c > 0 ? c * (factor - 1) : 0.1, factor, kChoiceFarthest);
  }

  // 0 where the drop is not passed.
  double flatter(double c) {
    const auto drop = [&](double slope) { return profile_.at_slope(slope); };
    const bool open = profile_.below(of_.constant.value) <= kProfileDrop;
    if (profile_.concave() && open) return 0;
    const double factor = profile_.concave() ? 0.5 : 0.75;
    double last = c;
    while (last > 1e-4) {
      const double next = last * factor;
      if (drop(next) > kProfileDrop) return choice_crossing(drop, last, next);
      last = next;
    }
    return open ? 0 : choice_crossing(drop, 1e-5, 0);
  }

  // Exactly the level, or the edge of the PSE's range, where the search ended at one: the profile jumps there.
  double on_axis(double t) const noexcept {
    if (std::isinf(t)) return t;
    if (of_.fit.pse_range && std::abs(of_.step.low - t) <= 1e-9) return of_.fit.pse_range->low;
    if (of_.fit.pse_range && std::abs(of_.step.high - t) <= 1e-9) return of_.fit.pse_range->high;
    for (std::size_t i = 0; i < of_.data.rows(); ++i)
      if (std::abs(of_.data.t[i] - t) <= 1e-9) return of_.data.level[i];
    return of_.data.shift + of_.data.scale * t;
  }

  const TwoIntervalSolution& of_;
  ChoiceProfile profile_;
};

}  // namespace

TwoIntervalFit fit_two_interval(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options) {
  return solve_two_interval(rows, options).fit;
}

ChoiceJnds choice_jnds(ChoiceLink link, double s) noexcept {
  // F^-1 at 0.75, Phi(1) and Phi(1/sqrt 2).
  constexpr ChoiceJnds kProbit = {0.67448975019608174, 1, 0.70710678118654752};
  constexpr ChoiceJnds kLogit = {1.0986122886681098, 1.6682678659858136, 1.1540502776126440};
  const ChoiceJnds& unit = link == ChoiceLink::probit ? kProbit : kLogit;
  return {unit.jnd_75 * s, unit.jnd_84 * s, unit.jnd_dprime1 * s};
}

OrderTermTest test_order_term(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options,
                              const TwoIntervalFit& fit) {
  OrderTermTest test;
  if (!fit.log_likelihood) return test;
  TwoIntervalOptions without = options;
  without.order_term = false;
  test.log_likelihood_without = *fit_two_interval(rows, without).log_likelihood;
  bool first = false, second = false;
  for (const ChoiceRow& row : rows)
    if (row.n > 0) (row.order < 0 ? first : second) = true;
  if (!first || !second) return test;
  test.lr = std::fmax(0, 2 * (*fit.log_likelihood - test.log_likelihood_without));
  test.p = chi2_upper(test.lr, 1);
  return test;
}

double log_binomial_constants(std::span<const ChoiceRow> rows) {
  const auto log_factorial = [](long long n) { return boost::math::lgamma(static_cast<double>(n) + 1, QuietPolicy()); };
  double sum = 0;
  for (const ChoiceRow& row : rows)
    sum += log_factorial(row.n) - log_factorial(row.chosen) - log_factorial(row.n - row.chosen);
  return sum;
}

TwoIntervalIntervals two_interval_intervals(std::span<const ChoiceRow> rows, const TwoIntervalOptions& options) {
  const TwoIntervalSolution solution = solve_two_interval(rows, options);
  TwoIntervalIntervals intervals;
  if (solution.fit.status == TwoIntervalStatus::missing || solution.fit.status == TwoIntervalStatus::not_identified)
    return intervals;
  const bool with_order = solution.options.order_term;
  if (solution.fit.status == TwoIntervalStatus::all_same) {
    // Every threshold beside the levels on that side predicts the answers, however steep.
    const ChoiceData& data = solution.data;
    intervals.s = {0, kInf};
    intervals.pse = data.chosen > 0 ? ChoiceBounds{-kInf, data.level.front()} : ChoiceBounds{data.level.back(), kInf};
    if (with_order) intervals.order_b = {-kInf, kInf};
    return intervals;
  }
  ChoiceIntervals of(solution);
  intervals.pse = of.pse();
  intervals.s = of.s();
  if (with_order) intervals.order_b = of.order();
  return intervals;
}

}  // namespace jnd
