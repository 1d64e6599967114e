#include "analysis/detection/independent_observation.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/tools/roots.hpp>

#include "analysis/detection/yes_no.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kRootTwo = boost::math::constants::root_two<double>();

// In units of noise, D = (x1 - x2)/sqrt 2 and S = (x1 + x2)/sqrt 2 are independent normals. With delta = d'/sqrt 2,
// "different" moves D by +-delta and "same" moves S by +-delta; the likelihood ratio is cosh(delta D) / cosh(delta S).
// The observer answers "different" where it exceeds c. On the line S = 0 that is |D| > a, cosh(delta a) = c; elsewhere
// |D| > A(S), cosh(delta A) = cosh(delta a) cosh(delta S). c < 1 is the mirror image: D and S exchange their parts, so
//   H(-a) = 1 - F(a),  F(-a) = 1 - H(a),
// which gives a its sign. a is the criterion's natural scale: it stays of order 1 where delta and ln c tend to 0.

// log cosh, keeping its digits near 0.
double log_cosh(double x) noexcept {
  x = std::abs(x);
  if (x < 1) {
    const double half = std::sinh(0.5 * x);
    return std::log1p(2 * half * half);
  }
  return x + std::log1p(std::exp(-2 * x)) - boost::math::constants::ln_two<double>();
}

// acosh(exp(l)), l >= 0.
double acosh_of_exp(double l) noexcept {
  const double root = std::sqrt(-std::expm1(-2 * l));
  return l + std::log1p(root);
}

struct Rates {
  double hit, miss, false_alarm, correct_rejection;
};

// For a >= 0. Integrals over s = |S| of smooth functions that may have a bend next to 0: s = exp(t - exp(-t)), which
// the trapezium rule integrates with an error of exp(-2 (pi / (delta step))^2) at worst: 4e-14 at d' = 14.
Rates rates_above(double delta, double a) noexcept {
  constexpr double kStep = 0.08, kFirst = -3.6;
  const double l0 = log_cosh(delta * a), end = std::log(delta + 9.5);
  double hit = 0, miss = 0, alarm = 0;
  for (int i = 0; kFirst + i * kStep < end; ++i) {
    const double t = kFirst + i * kStep, e = std::exp(-t);
    const double s = std::exp(t - e), weight = kStep * s * (1 + e);
    const double limit = acosh_of_exp(l0 + log_cosh(delta * s)) / delta;  // A(s)
    const double beyond = normal_cdf(delta - limit), opposite = normal_cdf(-delta - limit);
    const double here = 2 * normal_density(s);
    hit += weight * here * (beyond + opposite);
    miss += weight * here * (normal_cdf(limit - delta) - opposite);
    alarm += weight * (normal_density(s - delta) + normal_density(s + delta)) * 2 * normal_cdf(-limit);
  }
  return {hit, miss, alarm, 1 - alarm};
}

Rates rates(double delta, double a) noexcept {
  if (a >= 0) return rates_above(delta, a);
  const Rates mirrored = rates_above(delta, -a);
  return {mirrored.correct_rejection, mirrored.false_alarm, mirrored.miss, mirrored.hit};
}

// The root of an increasing function near a guess, to a few ulp of what its rounding allows.
template <typename Function>
double increasing_root(Function&& function, double guess, double step, double lowest) {
  double low = guess, high = guess, at_low = function(guess), at_high = at_low;
  while (at_low > 0 && low > lowest) {
    high = low;
    at_high = at_low;
    low = std::fmax(low - step, lowest);
    at_low = function(low);
    step *= 2;
  }
  while (at_high < 0 && high < 1e3) {
    low = high;
    at_low = at_high;
    high += step;
    at_high = function(high);
    step *= 2;
  }
  if (!(at_low < 0)) return low;
  if (!(at_high > 0)) return high;
  std::uintmax_t iterations = 60;
  const auto close = [](double x, double y) { return std::abs(x - y) <= 1e-11 * (1 + std::abs(x)); };
  const auto [left, right] = boost::math::tools::toms748_solve(function, low, high, at_low, at_high, close, iterations);
  return 0.5 * (left + right);
}

}  // namespace

double unit_slope_dprime(double yes_no_dprime) noexcept {
  if (!std::isfinite(yes_no_dprime) || yes_no_dprime == 0) return yes_no_dprime;
  // 2 pmax - 1 = erf(|zH - zF| / sqrt 8); the complement of its root keeps the digits where pmax is close to 1.
  const double x = std::abs(yes_no_dprime) / (2 * kRootTwo);
  const double root = std::sqrt(boost::math::erf(x));
  const double complement = boost::math::erfc(x) / (1 + root);
  const double dprime = 2 * kRootTwo * (root < 0.5 ? boost::math::erf_inv(root) : boost::math::erfc_inv(complement));
  return std::copysign(dprime, yes_no_dprime);
}

LikelihoodRatioObserver likelihood_ratio_observer(double hit, double miss, double false_alarm,
                                                  double correct_rejection) {
  if (!(miss > 0 && false_alarm > 0 && hit > 0 && correct_rejection > 0)) return {kNaN, kNaN};
  const double z_hit = hit < 0.5 ? normal_quantile(hit) : -normal_quantile(miss);
  const double z_alarm = false_alarm < 0.5 ? normal_quantile(false_alarm) : -normal_quantile(correct_rejection);
  if (!(z_hit > z_alarm)) return {kNaN, kNaN};
  if (z_hit + z_alarm > 0) {  // more "different" than "same": the mirror image has its criterion above 1
    const LikelihoodRatioObserver mirrored = likelihood_ratio_observer(correct_rejection, false_alarm, miss, hit);
    return {mirrored.dprime, -mirrored.ln_criterion};
  }
  double a = 0.5;
  const auto criterion_at = [&](double delta) {
    a = increasing_root([&](double x) { return std::log(false_alarm / rates(delta, x).false_alarm); }, a, 0.1, -50);
    return a;
  };
  const double guess = unit_slope_dprime(z_hit - z_alarm) / kRootTwo;
  const double delta = increasing_root(
      [&](double x) {
        const Rates found = rates(x, criterion_at(x));
        return hit < 0.5 ? std::log(found.hit / hit) : std::log(miss / found.miss);
      },
      guess, 0.02 * guess, 1e-9);
  return {delta * kRootTwo, std::copysign(log_cosh(delta * criterion_at(delta)), a)};
}

IndependentObservation independent_observation(const Counts& counts, Correction correction) {
  const YesNo scores = yes_no(counts, correction);
  if (scores.status == RateStatus::missing) return {kNaN, kNaN, kNaN};
  const LikelihoodRatioObserver observer = likelihood_ratio_observer(
      scores.hit_rate, corrected_rate(counts.n_diff - counts.hits, counts.n_diff, correction), scores.false_alarm_rate,
      corrected_rate(counts.n_same - counts.false_alarms, counts.n_same, correction));
  return {unit_slope_dprime(scores.dprime), observer.dprime, observer.ln_criterion};
}

}  // namespace jnd
