// The standard shapes G behind the psychometric functions, F(x) = G(u), and their derivatives.
#pragma once

#include "analysis/psychometric/psychometric.h"

namespace jnd {

// At one u: both tails to full relative precision, so that neither rate of a steep function loses its digits.
struct PsychometricShape {
  double g = 0;       // G
  double upper = 0;   // 1 - G
  double first = 0;   // dG/du
  double second = 0;  // d2G/du2
};

// logistic 1 / (1 + exp(-u)); gaussian Phi(u); weibull and gumbel 1 - exp(-exp(u)).
PsychometricShape psychometric_shape(PsychometricFunction function, double u) noexcept;
double psychometric_shape_quantile(PsychometricFunction function, double p) noexcept;  // u with G(u) = p, 0 < p < 1

}  // namespace jnd
