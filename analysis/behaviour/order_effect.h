// Does it matter which interval holds the stiffer object? Among different pairs, how often "different" was said with
// the stiffer one first and with the stiffer one second (the time-order error: Hellstrom 1985, Psychol Bull 97:35).
#pragma once

#include <span>
#include <string_view>

#include "analysis/behaviour/judged_trial.h"

namespace jnd {

enum class OrderStatus {
  ok,
  no_stiffer_first,   // no different pair had the stiffer object first: nothing to compare
  no_stiffer_second,  // or second
  no_different_trials
};
std::string_view to_string(OrderStatus status) noexcept;

struct OrderEffect {
  OrderStatus status = OrderStatus::no_different_trials;
  Share stiffer_first, stiffer_second;  // said "different", of the different pairs with that order
  // First minus second, and the two-sided p of no difference, by one score test: the 95 % interval holds the differences that it
  // does not reject (Miettinen and Nurminen 1985, Stat Med 4:213). NaN unless ok.
  double difference = 0, ci_low = 0, ci_high = 0, p = 0;
};

// Pools all differences: balanced designs have each order equally often at each.
OrderEffect order_effect(std::span<const JudgedTrial> trials);

// The same from counts: said "different" of so many.
OrderEffect order_effect(int first_said, int first_n, int second_said, int second_n);

}  // namespace jnd
