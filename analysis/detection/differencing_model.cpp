#include "analysis/detection/differencing_model.h"

#include <cmath>

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/erf.hpp>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/numerics/boost_policy.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kOneOverRootPi = boost::math::constants::one_div_root_pi<double>();

double erfc(double x) noexcept {
  if (std::isinf(x)) return x > 0 ? 0.0 : 2.0;
  return boost::math::erfc(x, QuietPolicy());
}
double erf(double x) noexcept {
  if (std::isinf(x)) return x > 0 ? 1.0 : -1.0;
  return boost::math::erf(x, QuietPolicy());
}

// P(|x1 - x2| <= tau): the mass of a normal density of mean d' and variance 2 between -tau and tau.
double miss_rate(double dprime, double tau) noexcept {
  if (std::isinf(dprime)) return 0;
  if (tau >= dprime) return 0.5 * (erf(0.5 * (tau - dprime)) + erf(0.5 * (tau + dprime)));
  if (tau * (1 + dprime) > 0.5) return 0.5 * (erfc(0.5 * (dprime - tau)) - erfc(0.5 * (dprime + tau)));
  // Two close tails would cancel: integrate the density, which is all but constant.
  const double integral = boost::math::quadrature::gauss<double, 7>::integrate(
      [&](double u) { return std::exp(-0.25 * tau * tau * u * u) * std::cosh(0.5 * tau * dprime * u); }, 0.0, 1.0);
  return kOneOverRootPi * tau * std::exp(-0.25 * dprime * dprime) * integral;
}

// The normal densities of variance 2 at tau, from either side.
struct Densities {
  double near, far;
};
Densities densities(double dprime, double tau) noexcept {
  const double half = 0.5 * kOneOverRootPi;
  return {half * std::exp(-0.25 * (tau - dprime) * (tau - dprime)),
          half * std::exp(-0.25 * (tau + dprime) * (tau + dprime))};
}

double ratio(int count, double rate) noexcept {
  return count == 0 ? 0.0 : count / rate;
}

}  // namespace

double differencing_hit_rate(double dprime, double tau) noexcept {
  if (std::isinf(dprime) && std::isinf(tau)) return kNaN;
  return 0.5 * (erfc(0.5 * (tau - dprime)) + erfc(0.5 * (tau + dprime)));
}

double differencing_tau(double false_alarm_rate, double correct_rejection_rate) noexcept {
  if (!(false_alarm_rate > 0)) return kInf;
  if (!(correct_rejection_rate > 0)) return 0;
  return false_alarm_rate < 0.5 ? 2 * boost::math::erfc_inv(false_alarm_rate, QuietPolicy())
                                : 2 * boost::math::erf_inv(correct_rejection_rate, QuietPolicy());
}

DifferencingRates differencing_rates(double dprime, double tau) noexcept {
  return {differencing_hit_rate(dprime, tau), miss_rate(dprime, tau), erfc(0.5 * tau), erf(0.5 * tau)};
}

DifferencingSlopes differencing_slopes(double dprime, double tau) noexcept {
  const auto [near, far] = densities(dprime, tau);
  // near - far by sinh where the two are close.
  const double product = dprime * tau;
  const double difference =
      product < 1 ? kOneOverRootPi * std::exp(-0.25 * (dprime * dprime + tau * tau)) * std::sinh(0.5 * product)
                  : near - far;
  return {difference, -(near + far), -kOneOverRootPi * std::exp(-0.25 * tau * tau)};
}

double differencing_log_likelihood(const Counts& counts, double dprime, double tau) noexcept {
  const DifferencingRates rates = differencing_rates(dprime, tau);
  return binomial_log_likelihood(counts.hits, counts.n_diff, rates.hit, rates.miss) +
         binomial_log_likelihood(counts.false_alarms, counts.n_same, rates.false_alarm, rates.correct_rejection);
}

DifferencingLikelihood differencing_likelihood(const Counts& counts, double dprime, double tau) noexcept {
  const DifferencingRates rates = differencing_rates(dprime, tau);
  const DifferencingSlopes slopes = differencing_slopes(dprime, tau);
  const auto [near, far] = densities(dprime, tau);
  const int misses = counts.n_diff - counts.hits, rejections = counts.n_same - counts.false_alarms;
  // d logL / dH and d logL / dF, and how they change.
  const double of_hits = ratio(counts.hits, rates.hit), of_misses = ratio(misses, rates.miss);
  const double of_alarms = ratio(counts.false_alarms, rates.false_alarm);
  const double of_rejections = ratio(rejections, rates.correct_rejection);
  const double on_hit = of_hits - of_misses, on_alarm = of_alarms - of_rejections;
  const double hit_twice = -ratio(counts.hits, rates.hit * rates.hit) - ratio(misses, rates.miss * rates.miss);
  const double alarm_twice = -ratio(counts.false_alarms, rates.false_alarm * rates.false_alarm) -
                             ratio(rejections, rates.correct_rejection * rates.correct_rejection);
  const double hit_tau_twice = 0.5 * ((tau - dprime) * near + (tau + dprime) * far);
  const double hit_dprime_tau = 0.5 * ((dprime - tau) * near + (dprime + tau) * far);
  const double alarm_tau_twice = -0.5 * tau * slopes.false_alarm_on_tau;

  DifferencingLikelihood result;
  result.value =
      binomial_log_likelihood(counts.hits, counts.n_diff, rates.hit, rates.miss) +
      binomial_log_likelihood(counts.false_alarms, counts.n_same, rates.false_alarm, rates.correct_rejection);
  result.on_dprime = on_hit * slopes.hit_on_dprime;
  result.on_tau = on_hit * slopes.hit_on_tau + on_alarm * slopes.false_alarm_on_tau;
  result.on_tau_twice = on_hit * hit_tau_twice + hit_twice * slopes.hit_on_tau * slopes.hit_on_tau +
                        on_alarm * alarm_tau_twice +
                        alarm_twice * slopes.false_alarm_on_tau * slopes.false_alarm_on_tau;
  result.on_dprime_and_tau = on_hit * hit_dprime_tau + hit_twice * slopes.hit_on_tau * slopes.hit_on_dprime;
  result.information_on_tau = counts.n_diff * slopes.hit_on_tau * slopes.hit_on_tau / (rates.hit * rates.miss) +
                              counts.n_same * slopes.false_alarm_on_tau * slopes.false_alarm_on_tau /
                                  (rates.false_alarm * rates.correct_rejection);
  return result;
}

}  // namespace jnd
