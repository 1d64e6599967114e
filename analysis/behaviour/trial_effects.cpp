#include "analysis/behaviour/trial_effects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

namespace {

constexpr auto kOrderStatusWords = words<OrderStatus>({{"ok", OrderStatus::ok},
                                                       {"no_stiffer_first", OrderStatus::no_stiffer_first},
                                                       {"no_stiffer_second", OrderStatus::no_stiffer_second},
                                                       {"no_different_trials", OrderStatus::no_different_trials}});

// The score z of the hypothesis that the rates differ by delta: their variance is that of the likeliest rates that do
// (Miettinen and Nurminen 1985, equation 9 and the cubic of their appendix).
double score(const Share& first, const Share& second, double delta) {
  const double n1 = first.n, n2 = second.n, p1 = first.value, p2 = second.value, ratio = n2 / n1;
  const double a = 1 + ratio, b = -(1 + ratio + p1 + ratio * p2 + delta * (ratio + 2)),
               c = delta * (delta + 2 * p1 + ratio + 1) + p1 + ratio * p2, d = -p1 * delta * (1 + delta);
  const double shift = b / (3 * a), size = std::sqrt(std::max(0.0, shift * shift - c / (3 * a)));
  const double v = shift * shift * shift - b * c / (6 * a * a) + d / (2 * a), u = v < 0 ? -size : size;
  const double cosine = u == 0 ? 0 : std::clamp(v / (u * u * u), -1.0, 1.0);
  const double angle = (std::numbers::pi + std::acos(cosine)) / 3;
  const double rate1 = std::clamp(2 * u * std::cos(angle) - shift, std::max(0.0, delta), std::min(1.0, 1 + delta)),
               rate2 = rate1 - delta;
  const double variance = (rate1 * (1 - rate1) / n1 + rate2 * (1 - rate2) / n2) * (n1 + n2) / (n1 + n2 - 1);
  const double distance = p1 - p2 - delta;
  return variance > 0    ? distance / std::sqrt(variance)
         : distance == 0 ? 0
                         : std::copysign(std::numeric_limits<double>::infinity(), distance);
}

// The end of the interval on that side: z falls as delta grows.
double bound(const Share& first, const Share& second, int side) {
  double inside = first.value - second.value, outside = side;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (inside + outside) / 2;
    (std::abs(score(first, second, middle)) < kNormal975 ? inside : outside) = middle;
  }
  return inside;
}

HalfDifference compare(double first, double second, double variance) {
  HalfDifference result;
  result.first = first;
  result.second = second;
  result.difference = second - first;
  result.se = std::sqrt(variance);
  result.ci_low = result.difference - kNormal975 * result.se;
  result.ci_high = result.difference + kNormal975 * result.se;
  result.p = 2 * normal_cdf(-std::abs(result.difference / result.se));
  return result;
}

}  // namespace

Counts counts_of(std::span<const JudgedTrial> trials) noexcept {
  Counts counts;
  for (const JudgedTrial& trial : trials) counts.add(trial.same, trial.said_different);
  return counts;
}

Share share_of(int k, int n) noexcept {
  Share share;
  share.k = k;
  share.n = n;
  if (n == 0) {
    share.value = share.ci_low = share.ci_high = kNaN;
    return share;
  }
  const double p = static_cast<double>(k) / n, z2 = kNormal975 * kNormal975;
  const double centre = (p + z2 / (2.0 * n)) / (1 + z2 / n);
  const double half = kNormal975 * std::sqrt(p * (1 - p) / n + z2 / (4.0 * n * n)) / (1 + z2 / n);
  share.value = p;
  // At k = 0 and k = n the bounds are 0 and 1, which rounding would miss by a hair.
  share.ci_low = k == 0 ? 0 : std::max(0.0, centre - half);
  share.ci_high = k == n ? 1 : std::min(1.0, centre + half);
  return share;
}

ResponseBias response_bias(const Counts& counts, double planned_share) {
  ResponseBias bias;
  bias.counts = counts;
  const YesNo rates = yes_no(counts, Correction::loglinear);
  bias.status = rates.status;
  bias.criterion = rates.criterion;
  bias.se = rates.status == RateStatus::missing ? kNaN : 0.5 * std::sqrt(loglinear_variance(counts));
  bias.ci_low = bias.criterion - kNormal975 * bias.se;
  bias.ci_high = bias.criterion + kNormal975 * bias.se;
  const int n = counts.n_diff + counts.n_same, said = counts.hits + counts.false_alarms;
  const ExactProportion exact = exact_proportion(said, n);
  bias.said_different = {said, n, exact.share, exact.ci_low, exact.ci_high};
  bias.planned_share = planned_share;
  bias.p = n == 0 ? kNaN : binomial_exact_p(said, n, planned_share);
  return bias;
}

ResponseBias response_bias(std::span<const JudgedTrial> trials, double planned_share) {
  return response_bias(counts_of(trials), planned_share);
}

std::string_view to_string(OrderStatus status) noexcept {
  return word_of(kOrderStatusWords, status);
}

OrderEffect order_effect(int first_said, int first_n, int second_said, int second_n) {
  OrderEffect effect;
  effect.stiffer_first = share_of(first_said, first_n);
  effect.stiffer_second = share_of(second_said, second_n);
  const Share& first = effect.stiffer_first;
  const Share& second = effect.stiffer_second;
  if (first_n == 0 || second_n == 0) {
    effect.status = first_n + second_n == 0 ? OrderStatus::no_different_trials
                    : first_n == 0          ? OrderStatus::no_stiffer_first
                                            : OrderStatus::no_stiffer_second;
    effect.difference = effect.ci_low = effect.ci_high = effect.p = kNaN;
    return effect;
  }
  effect.status = OrderStatus::ok;
  effect.difference = first.value - second.value;
  effect.ci_low = bound(first, second, -1);
  effect.ci_high = bound(first, second, 1);
  effect.p = std::erfc(std::abs(score(first, second, 0)) / std::numbers::sqrt2);
  return effect;
}

OrderEffect order_effect(std::span<const JudgedTrial> trials) {
  Counts by_order;  // "hits" of the stiffer first, "false alarms" of the stiffer second
  for (const JudgedTrial& trial : trials) {
    if (trial.same) continue;
    ++(trial.first_stiffer ? by_order.n_diff : by_order.n_same);
    if (trial.said_different) ++(trial.first_stiffer ? by_order.hits : by_order.false_alarms);
  }
  return order_effect(by_order.hits, by_order.n_diff, by_order.false_alarms, by_order.n_same);
}

Drift drift(const Counts& first, const Counts& second) {
  Drift result;
  result.first = first;
  result.second = second;
  const YesNo before = yes_no(first, Correction::loglinear), after = yes_no(second, Correction::loglinear);
  if (before.status == RateStatus::missing || after.status == RateStatus::missing) {
    result.status = RateStatus::missing;
    result.dprime = compare(before.dprime, after.dprime, kNaN);
    result.criterion = compare(before.criterion, after.criterion, kNaN);
    return result;
  }
  result.status = before.status == RateStatus::ok ? after.status : before.status;
  const double variance = loglinear_variance(first) + loglinear_variance(second);
  result.dprime = compare(before.dprime, after.dprime, variance);
  result.criterion = compare(before.criterion, after.criterion, variance / 4);
  if (result.status != RateStatus::ok) result.dprime.p = result.criterion.p = kNaN;
  return result;
}

Drift drift(std::span<const JudgedTrial> trials) {
  std::vector<JudgedTrial> first, second;
  for (const JudgedTrial& trial : trials) (trial.time_fraction < 0.5 ? first : second).push_back(trial);
  return drift(counts_of(first), counts_of(second));
}

StratifiedDrift stratified_drift(std::span<const Drift> strata) {
  StratifiedDrift result;
  double sum = 0, weights = 0;
  for (const Drift& one : strata) {
    if (one.status == RateStatus::missing) continue;
    const double weight = 1 / (one.dprime.se * one.dprime.se);
    sum += weight * one.dprime.difference;
    weights += weight;
    ++result.strata;
  }
  result.difference = result.strata > 0 ? sum / weights : kNaN;
  result.se = result.strata > 0 ? 1 / std::sqrt(weights) : kNaN;
  result.ci_low = result.difference - kNormal975 * result.se;
  result.ci_high = result.difference + kNormal975 * result.se;
  result.p = result.strata > 0 ? 2 * normal_cdf(-std::abs(result.difference / result.se)) : kNaN;
  return result;
}

}  // namespace jnd
