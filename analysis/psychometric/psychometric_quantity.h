// What is read off a psychometric function, in the variables (c0, c1) of the likelihood: its value with first
// derivatives, and the curve of all functions that share a value.
#pragma once

#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

enum class PsychometricQuantity { location, second, lapse, guess, pse, jnd, slope };

struct QuantityValue {
  double value = 0;  // in the units of the levels
  double by_c0 = 0, by_c1 = 0;
};

// Any quantity but lapse and guess; c1 > 0.
QuantityValue quantity_at(PsychometricQuantity quantity, const PsychometricData& data, double c0, double c1) noexcept;

// A quantity on an unbounded scale, on which a search can step: t of location and PSE (in ranges of the levels;
// weibull: logarithm), the logarithm of the second parameter, JND and slope, the rates themselves. And back.
double to_search_scale(PsychometricQuantity quantity, const PsychometricData& data, double value) noexcept;
double from_search_scale(PsychometricQuantity quantity, const PsychometricData& data, double z) noexcept;

// The functions that share the quantity's value z (search scale).
struct SharedCurve {
  bool fixes_c1 = false;  // c1 = c1 below and c0 is free; otherwise c0 = h(c1)
  double c1 = 0;
  double h = 0, h1 = 0, h2 = 0;  // c0 at the c1 asked for, with first and second derivative
};
SharedCurve shared_curve(PsychometricQuantity quantity, const PsychometricData& data, double z, double c1) noexcept;

}  // namespace jnd
