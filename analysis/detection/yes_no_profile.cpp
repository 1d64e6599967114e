#include "analysis/detection/yes_no_profile.h"

#include <cmath>
#include <numbers>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// The likelihood maximised over l = z(F), seen from its maximum over everything.
class Profile {
 public:
  Profile(const Counts& counts, double maximum, double l) : counts_(counts), maximum_(maximum), l_(l) {}

  ProfilePoint operator()(double dprime) noexcept {
    l_ -= 0.5 * (dprime - dprime_);  // a change of d' moves the two z scores apart about evenly
    dprime_ = dprime;
    double below = -kInf, above = kInf;  // where the slope on l is positive, and where it is negative
    for (int i = 0;; ++i) {
      const ProbitLikelihood hits = probit_log_likelihood(counts_.hits, counts_.n_diff, l_ + dprime);
      const ProbitLikelihood alarms = probit_log_likelihood(counts_.false_alarms, counts_.n_same, l_);
      const double slope = hits.slope + alarms.slope, curvature = hits.curvature + alarms.curvature;
      const double step = -slope / curvature;
      // Newton's decrement: what is still to be gained. Past it both values are corrected to second order.
      if (std::abs(slope * step) < 1e-11 || i == 100)
        return {maximum_ - (hits.value + alarms.value + 0.5 * slope * step), -(hits.slope + hits.curvature * step)};
      (slope > 0 ? below : above) = l_;
      double next = l_ + std::fmin(std::fmax(step, -2.0), 2.0);
      if (!(next > below && next < above)) next = 0.5 * (below + above);
      l_ = next;
    }
  }

  void start(double dprime, double l) noexcept {
    dprime_ = dprime;
    l_ = l;
  }

 private:
  Counts counts_;
  double maximum_;
  double l_, dprime_ = 0;
};

}  // namespace

double yes_no_p_value(const Counts& counts) noexcept {
  if (counts.n_diff <= 0 || counts.n_same <= 0) return kNaN;
  return std::erfc(std::sqrt(half_deviance_of_equal_rates(counts)));
}

DprimeProfile yes_no_profile(const Counts& counts) noexcept {
  const YesNo raw = yes_no(counts, Correction::none);
  DprimeProfile result;
  result.status = raw.status;
  result.dprime = raw.dprime;
  if (raw.status == RateStatus::missing) {
    result.ci_low = result.ci_high = result.log_likelihood = result.p_value = raw.dprime;
    return result;
  }
  result.log_likelihood = saturated_log_likelihood(counts);
  result.p_value = yes_no_p_value(counts);
  result.ci_low = -kInf;
  result.ci_high = kInf;
  if (raw.status == RateStatus::no_information) return result;

  // First guesses: a Wald interval, of corrected rates where the raw ones have none.
  const YesNo guess = std::isfinite(raw.dprime) ? raw : yes_no(counts, Correction::loglinear);
  Profile profile(counts, result.log_likelihood, guess.z_false_alarm);
  if (raw.dprime != -kInf) {
    profile.start(guess.dprime, guess.z_false_alarm);
    result.ci_low = profile_bound(profile, raw.dprime, -kInf, guess.ci_low);
  }
  if (raw.dprime != kInf) {
    profile.start(guess.dprime, guess.z_false_alarm);
    result.ci_high = profile_bound(profile, raw.dprime, kInf, guess.ci_high);
  }
  return result;
}

}  // namespace jnd
