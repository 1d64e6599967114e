// Ends of 95 % profile-likelihood intervals: where the profile has fallen by half the 95 % quantile of chi-square(1).
//
// Source: Venzon and Moolgavkar 1988, Appl Statist 37:87. Newton's method on the signed root of the deviance, which is
// nearly linear in the parameter, inside a bracket that never lets go of the solution.
#pragma once

#include <cmath>
#include <limits>

namespace jnd {

inline constexpr double kProfileDrop = 1.9207294103470621;  // qchisq(0.95, 1) / 2

// The profile at one value of the parameter.
struct ProfilePoint {
  double drop;   // how far the profile log-likelihood lies below its maximum; >= 0
  double slope;  // of the drop on the parameter
};

// The value between inside and outside at which profile(value).drop is kProfileDrop.
//   inside   a value with less drop: the estimate; infinite where that is
//   outside  a value with more drop; infinite: to be found, the drop grows all the way
//   start    the first value to look at, finite and between the two
// The last step is at most `close` (1 + |value|); what is left after it is about its square.
template <typename Profile>
double profile_bound(Profile&& profile, double inside, double outside, double start, double close = 1e-9) {
  constexpr double kLongestStep = 4;  // towards an infinite end
  const double root = std::sqrt(2 * kProfileDrop);
  double at = start;
  for (int i = 0; i < 200; ++i) {
    const ProfilePoint point = profile(at);
    const double signed_root = std::sqrt(2 * std::fmax(0, point.drop));
    const bool beyond = point.drop > kProfileDrop;
    (beyond ? outside : inside) = at;
    const double step = -(signed_root - root) * signed_root / point.slope;
    if (std::abs(step) <= close * (1 + std::abs(at))) return at + step;
    const double low = std::fmin(inside, outside), high = std::fmax(inside, outside);
    if (high - low <= 1e-14 * (1 + std::abs(at))) return at;
    double next = at + step;
    if (std::isinf(low) || std::isinf(high)) {
      // Newton's direction is known where its step is not usable.
      const double open = beyond ? inside : outside;
      const double furthest = at + std::copysign(kLongestStep, open - at);
      if (std::isinf(open) && !(std::abs(step) <= kLongestStep && step * (open - at) > 0)) next = furthest;
      if (!(next >= low && next <= high)) next = furthest;
    } else if (!(next >= low && next <= high)) {
      next = low + 0.5 * (high - low);
    }
    at = next;
  }
  return at;
}

}  // namespace jnd
