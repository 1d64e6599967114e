// Measured numbers as decimals of 15 significant digits, which is what R, MATLAB and spreadsheets write, and what a double
// keeps of every decimal; and the order of such numbers, and of differences between them.
//
// 5.50 - 5.45 and 5.40 - 5.35 are one difference, but not as doubles: ranks, ties and exact p values would follow the
// rounding, and change with the unit.
//   Values are compared exactly if each is a decimal of at most 15 digits and all lie within 37 places of one another.
//   Differences are then computed exactly. A decimal of more than 11 digits may have been rounded: it is known to 0.6
//   units of its fifteenth digit, a difference to the sum of both, and differences nearer than their sum are equal.
//   Other numbers, such as means, are known to 6e-15 of themselves, which are 0.6 of these units at most.
// What is equal to a neighbour in the order is equal to the neighbour's neighbours.
// R's wilcox.test and friedman.test compare the doubles; wilcox.test(digits.rank = 9) rounds the differences first.
// Tests: R 4.2.2 on whole multiples of the unit of measured data; data times 1/3.
#pragma once

#include <span>
#include <vector>

namespace jnd {

// The nearest decimal of 15 digits: 0.3 of 0.1 + 0.2. Every number of a table or of a protocol is read so, and every level
// of a plan is made so, or by plain_sum(): equal levels are one level. value: finite.
double plain_decimal(double value);

// a + b to the fifteenth digit of the larger of the two: 0.1 of 1.1 - 1, and 0 of 0.1 + 0.2 - 0.3.
double plain_sum(double a, double b);
// |a - b|, likewise.
double plain_distance(double a, double b);

// The place of each value among the different ones: 0 for the smallest, then 1, 2, ...; equal values share a place.
// values: finite.
std::vector<int> decimal_places(std::span<const double> values);

// Of each pair: 0 where x = y; else the place 1, 2, ... of |x - y| among the different ones, with the sign of x - y.
// x and y: finite, of equal size.
std::vector<int> decimal_difference_places(std::span<const double> x, std::span<const double> y);

}  // namespace jnd
