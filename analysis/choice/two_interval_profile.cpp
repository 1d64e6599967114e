#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <tuple>

#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/choice/two_interval_solution.h"
#include "analysis/numerics/profile_interval.h"

namespace jnd {

namespace {

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
