#include "analysis/behaviour/order_effect.h"

#include <cmath>

#include "analysis/numerics/exact_proportion.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

constexpr auto kOrderStatusWords = words<OrderStatus>({{"ok", OrderStatus::ok},
                                                       {"no_stiffer_first", OrderStatus::no_stiffer_first},
                                                       {"no_stiffer_second", OrderStatus::no_stiffer_second},
                                                       {"no_different_trials", OrderStatus::no_different_trials}});

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
  effect.ci_low = effect.difference - std::hypot(first.value - first.ci_low, second.ci_high - second.value);
  effect.ci_high = effect.difference + std::hypot(first.ci_high - first.value, second.value - second.ci_low);
  effect.p = fisher_exact_p(first_said, first_n, second_said, second_n);
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
