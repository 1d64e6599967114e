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
  // First minus second, with Newcombe's hybrid score interval, 95 % (Newcombe 1998, Stat Med 17:873, method 10). NaN
  // unless ok.
  double difference = 0, ci_low = 0, ci_high = 0;
  double p = 0;  // two-sided, Fisher's exact test; NaN unless ok
};

// Pools all differences: balanced designs have each order equally often at each.
OrderEffect order_effect(std::span<const JudgedTrial> trials);

// The same from counts: said "different" of so many.
OrderEffect order_effect(int first_said, int first_n, int second_said, int second_n);

}  // namespace jnd
