// Ranks with ties: equal values share the mean of their places (midranks), as R's rank(). Values are equal as the
// decimals that were read (decimal_order.h).
#pragma once

#include <span>
#include <vector>

namespace jnd {

struct Ranks {
  std::vector<double> ranks;  // 1..n, whole or half; in the order of the values
  double tie_sum = 0;         // sum over groups of t equal values of t^3 - t; 0 without ties
};
Ranks midranks(std::span<const double> values);  // finite
// The same from the place of each value: 0, 1, 2, ..., which equal values share.
Ranks midranks_of_places(std::span<const int> places);

}  // namespace jnd
