#include "analysis/detection/differencing.h"

#include <cmath>
#include <cstdint>

#include <boost/math/constants/constants.hpp>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/differencing_model.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

// What the model is solved for. excess: H - F, given apart because it can be smaller than the rounding of either.
struct TargetRates {
  double hit, miss, false_alarm, correct_rejection, excess;
};

TargetRates target_rates(const Counts& counts, Correction correction) noexcept {
  TargetRates rates;
  rates.hit = corrected_rate(counts.hits, counts.n_diff, correction);
  rates.miss = corrected_rate(counts.n_diff - counts.hits, counts.n_diff, correction);
  rates.false_alarm = corrected_rate(counts.false_alarms, counts.n_same, correction);
  rates.correct_rejection = corrected_rate(counts.n_same - counts.false_alarms, counts.n_same, correction);
  // Each rate is (2 k + a) / (2 n + 2 a), a = 1 for log-linear and 0 for raw ones: the cross product is an exact
  // integer.
  const std::int64_t a = correction == Correction::loglinear ? 1 : 0;
  const std::int64_t n_diff = counts.n_diff + a, n_same = counts.n_same + a;
  const std::int64_t cross =
      (2 * std::int64_t{counts.hits} + a) * n_same - (2 * std::int64_t{counts.false_alarms} + a) * n_diff;
  rates.excess = static_cast<double>(cross) / (2.0 * static_cast<double>(n_diff) * static_cast<double>(n_same));
  if (correction == Correction::half)
    rates.excess = rates.hit > 0.5 ? rates.correct_rejection - rates.miss : rates.hit - rates.false_alarm;
  return rates;
}

// H - F = sum of 2 Phi^(2k)(-t) (d'^2/2)^k / (2k)!, t = tau / sqrt 2, in s = d'^2; for small d' (1 + t).
double solve_small(double excess, double t, double first_guess) noexcept {
  const double density = normal_density(t), t2 = t * t;
  const double c1 = 0.5 * density * t, c2 = density * t * (t2 - 3) / 48;
  const double c3 = density * t * (t2 * (t2 - 10) + 15) / 2880;
  const double c4 = density * t * (t2 * (t2 * (t2 - 21) + 105) - 105) / 322560;
  double s = first_guess * first_guess;
  for (int i = 0; i < 4; ++i)
    s -= (s * (c1 + s * (c2 + s * (c3 + s * c4))) - excess) / (c1 + s * (2 * c2 + s * (3 * c3 + s * 4 * c4)));
  return std::sqrt(s);
}

// d' > 0 at which the model's hit rate is the target's; all rates strictly between 0 and 1, excess > 0.
double solve_dprime(const TargetRates& target, double tau) noexcept {
  const double t = tau * boost::math::constants::one_div_root_two<double>();
  const double small = std::sqrt(2 * target.excess / (normal_density(t) * t));
  if (small * (1 + t) < 0.1) return solve_small(target.excess, t, small);

  // Without its second term the model would need the larger d' of `high`. Newton's method on the logarithm of the rarer
  // answer, within low..high.
  const bool rare_misses = target.hit > 0.5;
  const double z = rare_misses ? -normal_quantile(target.miss) : normal_quantile(target.hit);
  double low = 0, high = tau + boost::math::constants::root_two<double>() * z;
  high += 1e-15 * (1 + tau);
  double dprime = small < 1 ? std::fmin(small, high) : high;
  const double wanted = std::log(rare_misses ? target.miss : target.hit);
  for (int i = 0; i < 100; ++i) {
    const double slope = differencing_slopes(dprime, tau).hit_on_dprime;
    double rate, on_dprime;
    if (rare_misses) {
      rate = differencing_rates(dprime, tau).miss;
      on_dprime = -slope / rate;
    } else {
      rate = differencing_hit_rate(dprime, tau);
      on_dprime = slope / rate;
    }
    const double error = std::log(rate) - wanted;
    ((error > 0) == rare_misses ? low : high) = dprime;
    double next = dprime - error / on_dprime;
    if (std::abs(next - dprime) <= 1e-9 * dprime) return next;  // the step after it would be its square
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    dprime = next;
  }
  return dprime;
}

// Delta method: (H, F) -> (d', tau), with the binomial variances of the rates.
void set_errors(DifferencingFit& fit, const TargetRates& rates, const Counts& counts) noexcept {
  const DifferencingSlopes slopes = differencing_slopes(fit.dprime, fit.tau);
  const double variance_hit = rates.hit * rates.miss / counts.n_diff;
  const double variance_alarm = rates.false_alarm * rates.correct_rejection / counts.n_same;
  const double variance_tau = variance_alarm / (slopes.false_alarm_on_tau * slopes.false_alarm_on_tau);
  fit.se_tau = std::sqrt(variance_tau);
  fit.se_dprime = std::sqrt(variance_hit + slopes.hit_on_tau * slopes.hit_on_tau * variance_tau) / slopes.hit_on_dprime;
}

// Of tau where it alone is estimated, from different of n answers.
double error_of_tau(double tau, double rate, double complement, double n) noexcept {
  return std::sqrt(rate * complement / n) / -differencing_slopes(0, tau).false_alarm_on_tau;
}

DifferencingFit undefined(DifferencingStatus status) noexcept {
  DifferencingFit fit;
  fit.status = status;
  fit.dprime = fit.tau = fit.se_dprime = fit.se_tau = fit.log_likelihood = kNaN;
  return fit;
}

constexpr auto kDifferencingStatusWords =
    words<DifferencingStatus>({{"ok", DifferencingStatus::ok},
                               {"no_sensitivity", DifferencingStatus::no_sensitivity},
                               {"no_information", DifferencingStatus::no_information},
                               {"missing", DifferencingStatus::missing}});

}  // namespace

std::string_view to_string(DifferencingStatus status) noexcept {
  return word_of(kDifferencingStatusWords, status);
}

DifferencingFit differencing_fit(const Counts& counts) noexcept {
  if (counts.n_diff <= 0 || counts.n_same <= 0) return undefined(DifferencingStatus::missing);
  const std::int64_t different = std::int64_t{counts.hits} + counts.false_alarms;
  const std::int64_t trials = std::int64_t{counts.n_diff} + counts.n_same;
  if (different == 0 || different == trials) return undefined(DifferencingStatus::no_information);

  DifferencingFit fit = undefined(DifferencingStatus::ok);
  const TargetRates rates = target_rates(counts, Correction::none);
  if (rates.excess <= 0) {
    const double n = static_cast<double>(trials);
    const double rate = static_cast<double>(different) / n, complement = static_cast<double>(trials - different) / n;
    fit.dprime = 0;
    fit.tau = differencing_tau(rate, complement);
    fit.se_tau = error_of_tau(fit.tau, rate, complement, n);
    fit.log_likelihood = pooled_log_likelihood(counts);
    return fit;
  }
  fit.log_likelihood = saturated_log_likelihood(counts);
  fit.tau = differencing_tau(rates.false_alarm, rates.correct_rejection);
  fit.dprime = kInf;
  if (counts.false_alarms == 0) return fit;
  if (counts.hits == counts.n_diff) {
    fit.se_tau = error_of_tau(fit.tau, rates.false_alarm, rates.correct_rejection, counts.n_same);
    return fit;
  }
  fit.dprime = solve_dprime(rates, fit.tau);
  set_errors(fit, rates, counts);
  return fit;
}

DifferencingFit differencing_of_rates(const Counts& counts, Correction correction) noexcept {
  if (correction == Correction::none) return differencing_fit(counts);
  if (counts.n_diff <= 0 || counts.n_same <= 0) return undefined(DifferencingStatus::missing);
  const std::int64_t different = std::int64_t{counts.hits} + counts.false_alarms;
  const bool one_answer = different == 0 || different == std::int64_t{counts.n_diff} + counts.n_same;
  const TargetRates rates = target_rates(counts, correction);
  DifferencingFit fit = undefined(DifferencingStatus::ok);
  fit.tau = differencing_tau(rates.false_alarm, rates.correct_rejection);
  if (rates.excess <= 0) {
    fit.status = DifferencingStatus::no_sensitivity;
    fit.dprime = 0;
    fit.se_tau = error_of_tau(fit.tau, rates.false_alarm, rates.correct_rejection, counts.n_same);
  } else {
    fit.dprime = solve_dprime(rates, fit.tau);
    set_errors(fit, rates, counts);
  }
  if (one_answer) fit.status = DifferencingStatus::no_information;
  fit.log_likelihood = differencing_log_likelihood(counts, fit.dprime, fit.tau);
  return fit;
}

double differencing_p_value(const Counts& counts) noexcept {
  if (counts.n_diff <= 0 || counts.n_same <= 0) return kNaN;
  const std::int64_t different = std::int64_t{counts.hits} + counts.false_alarms;
  if (different == 0 || different == std::int64_t{counts.n_diff} + counts.n_same) return kNaN;
  if (std::int64_t{counts.hits} * counts.n_same <= std::int64_t{counts.false_alarms} * counts.n_diff) return 0.5;
  return 0.5 * std::erfc(std::sqrt(half_deviance_of_equal_rates(counts)));
}

// The profile-likelihood intervals of the differencing model.

namespace {

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
  result.ci_high = kInf;
  if (!infinite) {
    profile.start(tau);
    result.ci_high = profile_bound(profile, fit.dprime, kInf, dprime + width);
  }

  const OfTau profile_of_tau(counts, fit.log_likelihood);
  const double tau_width = 2 * (std::isfinite(fit.se_tau) ? fit.se_tau : guess.se_tau);
  result.tau_low = profile_bound(profile_of_tau, fit.tau, 0, std::fmax(tau - tau_width, 0.25 * tau));
  result.tau_high = std::isinf(fit.tau) ? kInf : profile_bound(profile_of_tau, fit.tau, kInf, tau + tau_width);
  return result;
}

}  // namespace jnd
