// Mean, standard deviation and median that keep their digits: values far from zero with a tiny spread lose none to
// cancellation, and values near the limits of double do not overflow when squared.
//
// Source: the corrected two-pass algorithm, Chan, Golub and LeVeque 1983, American Statistician 37, 242-247.
// Accuracy: a few ulp. Tests: exact rational values; shifted and scaled data.
#pragma once

#include <span>

namespace jnd {

struct Moments {
  int n = 0;
  double mean = 0;  // NaN for n = 0
  double sd = 0;    // n - 1 in the denominator; NaN for n < 2
};
Moments moments(std::span<const double> values) noexcept;  // finite values

// NaN for no values. Between two middle values: halfway.
double median_of(std::span<const double> values);

double largest_magnitude(std::span<const double> values) noexcept;  // max |x|; 0 for no values

// Whether a standard error says nothing but rounding: at most 10 ulp of the values, as R's t.test has it.
bool only_rounding(double standard_error, double largest_magnitude) noexcept;

}  // namespace jnd
