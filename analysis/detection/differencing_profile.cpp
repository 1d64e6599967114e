// The profile-likelihood intervals of the differencing model.
#include <cmath>
#include <limits>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/differencing.h"
#include "analysis/detection/differencing_model.h"
#include "analysis/numerics/profile_interval.h"

namespace jnd {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// No count reaches it: F is then 1e-273. It keeps every rate above the smallest double.
constexpr double kLargestTau = 50;

// The likelihood maximised over tau at each d'.
class OfDprime {
 public:
  OfDprime(const Counts& counts, double maximum, double tau) : counts_(counts), maximum_(maximum), tau_(tau) {}

  ProfilePoint operator()(double dprime) noexcept {
    double low = 0, high = kLargestTau;  // the slope on tau is positive at low, negative at high
    for (int i = 0;; ++i) {
      const DifferencingLikelihood at = differencing_likelihood(counts_, dprime, tau_);
      const double curvature = at.on_tau_twice < 0 ? at.on_tau_twice : -at.information_on_tau;
      const double step = -at.on_tau / curvature;
      // Newton's decrement: what is still to be gained. Past it both values are corrected to second order.
      if ((at.on_tau_twice < 0 && std::abs(at.on_tau * step) < 1e-11) || i == 200)
        return {maximum_ - (at.value + 0.5 * at.on_tau * step), -(at.on_dprime + at.on_dprime_and_tau * step)};
      (at.on_tau > 0 ? low : high) = tau_;
      double next = tau_ + step;
      if (!(next > low && next < high)) next = 0.5 * (low + std::fmin(high, 2 * tau_ + 1));
      tau_ = next;
    }
  }

  void start(double tau) noexcept { tau_ = tau; }

 private:
  Counts counts_;
  double maximum_;
  double tau_;
};

// The likelihood maximised over d' >= 0 at each tau: d' meets the observed hit rate where that is above F, and is 0
// elsewhere.
class OfTau {
 public:
  OfTau(const Counts& counts, double maximum) : counts_(counts), maximum_(maximum) {}

  ProfilePoint operator()(double tau) const noexcept {
    const DifferencingRates rates = differencing_rates(0, tau);
    const double on_tau = differencing_slopes(0, tau).false_alarm_on_tau;
    double value =
        binomial_log_likelihood(counts_.false_alarms, counts_.n_same, rates.false_alarm, rates.correct_rejection);
    double on_rate = slope(counts_.false_alarms, counts_.n_same, rates);
    if (rates.false_alarm * counts_.n_diff <= counts_.hits) {
      value += saturated_log_likelihood(counts_.hits, counts_.n_diff);
    } else {
      value += binomial_log_likelihood(counts_.hits, counts_.n_diff, rates.false_alarm, rates.correct_rejection);
      on_rate += slope(counts_.hits, counts_.n_diff, rates);
    }
    return {maximum_ - value, -on_rate * on_tau};
  }

 private:
  static double slope(int k, int n, const DifferencingRates& rates) noexcept {
    return (k > 0 ? k / rates.false_alarm : 0) - (n > k ? (n - k) / rates.correct_rejection : 0);
  }
  Counts counts_;
  double maximum_;
};

}  // namespace

Differencing differencing(const Counts& counts) noexcept {
  Differencing result;
  result.fit = differencing_fit(counts);
  result.p_value = differencing_p_value(counts);
  result.ci_low = result.ci_high = result.tau_low = result.tau_high = kNaN;
  const DifferencingFit& fit = result.fit;
  if (fit.status != DifferencingStatus::ok) return result;

  // First guesses, finite everywhere.
  const DifferencingFit guess = differencing_of_rates(counts, Correction::loglinear);
  const bool infinite = std::isinf(fit.dprime);
  const double dprime = infinite ? guess.dprime : fit.dprime;
  const double tau = std::isinf(fit.tau) ? guess.tau : fit.tau;
  const double error_guess = infinite ? guess.se_dprime : fit.se_dprime;
  const double width = 2 * (std::isfinite(error_guess) ? std::fmin(error_guess, 2.0) : fit.se_tau);

  OfDprime profile(counts, fit.log_likelihood, tau);
  result.ci_low = 0;
  if (fit.dprime > 0 && half_deviance_of_equal_rates(counts) > kProfileDrop) {
    const double start = std::fmax(dprime - width, 0.25 * dprime);
    profile.start(std::fmax(tau - 0.5 * (dprime - start), 0.5 * tau));
    result.ci_low = profile_bound(profile, fit.dprime, 0, start);
  }
  result.ci_high = kInfinity;
  if (!infinite) {
    profile.start(tau);
    result.ci_high = profile_bound(profile, fit.dprime, kInfinity, dprime + width);
  }

  const OfTau profile_of_tau(counts, fit.log_likelihood);
  const double tau_width = 2 * (std::isfinite(fit.se_tau) ? fit.se_tau : guess.se_tau);
  result.tau_low = profile_bound(profile_of_tau, fit.tau, 0, std::fmax(tau - tau_width, 0.25 * tau));
  result.tau_high =
      std::isinf(fit.tau) ? kInfinity : profile_bound(profile_of_tau, fit.tau, kInfinity, tau + tau_width);
  return result;
}

}  // namespace jnd
