#include "analysis/behaviour/order_effect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

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

}  // namespace

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

}  // namespace jnd
