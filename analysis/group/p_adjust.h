// Corrections for many tests.
//
// Source: Holm 1979, Scandinavian Journal of Statistics 6, 65-70; Benjamini and Hochberg 1995, Journal of the Royal
// Statistical Society B 57, 289-300. As R 4.2.2's p.adjust. Accuracy: one rounding. Tests: R 4.2.2.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace jnd {

// p in 0..1, in any order; the results stand in the same order. An undefined p (NaN) stays NaN and is not counted.
// family: the number of tests, where more were made than are given (R's n); 0, or less than given: those given.
std::vector<double> holm(std::span<const double> p, std::size_t family = 0);
std::vector<double> benjamini_hochberg(std::span<const double> p, std::size_t family = 0);
std::vector<double> bonferroni(std::span<const double> p, std::size_t family = 0);

}  // namespace jnd
