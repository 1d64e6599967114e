// The order of measured numbers, and of differences between them, as the decimals that were read.
//
// 5.50 - 5.45 and 5.40 - 5.35 are one difference, but not as doubles: ranks, ties and exact p values would follow the
// rounding, and change with the unit. So numbers are compared
//   exactly, as the shortest decimals that read back the same, where all of them have at most 15 significant digits
//   (a double keeps every such decimal) and lie within 37 places of one another;
//   within their rounding elsewhere: a number x is taken as known to 2^-51 |x|, a difference to 2^-51 of the larger
//   of its two numbers. That is enough for the third of a decimal and for a mean of few values; fitted values tie only
//   where their data are the same. Numbers that are nearer than both errors together are equal, and so is a chain of
//   such neighbours.
// R's wilcox.test and friedman.test compare the doubles; wilcox.test(digits.rank = 9) rounds the differences first.
// Tests: R 4.2.2 on whole multiples of the unit of measured data; data times 1/3.
#pragma once

#include <span>
#include <vector>

namespace jnd {

// The place of each value among the different ones: 0 for the smallest, then 1, 2, ...; equal values share a place.
// values: finite.
std::vector<int> decimal_places(std::span<const double> values);

// Of each pair: 0 where x = y; else the place 1, 2, ... of |x - y| among the different ones, with the sign of x - y.
// x and y: finite, of equal size.
std::vector<int> decimal_difference_places(std::span<const double> x, std::span<const double> y);

}  // namespace jnd
