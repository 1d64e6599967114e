#include "analysis/psychometric/psychometric_shape.h"

#include <cmath>

#include "analysis/numerics/normal.h"

namespace jnd {

PsychometricShape psychometric_shape(PsychometricFunction function, double u) noexcept {
  PsychometricShape shape;
  switch (function) {
    case PsychometricFunction::logistic: {
      const double e = std::exp(-std::abs(u));
      const double large = 1 / (1 + e), small = e / (1 + e);
      shape.g = u >= 0 ? large : small;
      shape.upper = u >= 0 ? small : large;
      shape.first = large * small;
      shape.second = shape.first * (shape.upper - shape.g);
      return shape;
    }
    case PsychometricFunction::gaussian: {
      const double small = normal_cdf(-std::abs(u));
      shape.g = u >= 0 ? 1 - small : small;
      shape.upper = u >= 0 ? small : 1 - small;
      shape.first = normal_density(u);
      shape.second = -u * shape.first;
      return shape;
    }
    case PsychometricFunction::weibull:
    case PsychometricFunction::gumbel: {
      const double e = std::exp(u);
      shape.upper = std::exp(-e);
      shape.g = -std::expm1(-e);
      // From u = 6.7 on the upper tail is 0 in double precision; so are its derivatives, though e may overflow.
      shape.first = shape.upper > 0 ? e * shape.upper : 0;
      shape.second = shape.upper > 0 ? shape.first * (1 - e) : 0;
      return shape;
    }
  }
  return shape;
}

double psychometric_shape_quantile(PsychometricFunction function, double p) noexcept {
  switch (function) {
    case PsychometricFunction::logistic:
      return std::log(p) - std::log1p(-p);
    case PsychometricFunction::gaussian:
      return normal_quantile(p);
    case PsychometricFunction::weibull:
    case PsychometricFunction::gumbel:
      return std::log(-std::log1p(-p));
  }
  return 0;
}

double psychometric_cdf(PsychometricFunction function, double location, double second, double x) noexcept {
  double u = second * (x - location);
  if (function == PsychometricFunction::gaussian) u = (x - location) / second;
  if (function == PsychometricFunction::weibull) u = second * std::log(x / location);
  return psychometric_shape(function, u).g;
}

}  // namespace jnd
