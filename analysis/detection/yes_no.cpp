#include "analysis/detection/yes_no.h"

#include <cmath>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

constexpr double kZ975 = 1.9599639845400545;  // qnorm(0.975)

// z of the corrected rate k of n. Above 1/2 it is taken from the complement, which has kept its digits near a rate of
// 1; so that exchanging the answers changes the sign of z and nothing else.
double corrected_z(int k, int n, Correction correction) noexcept {
  return 2.0 * k > n ? -normal_quantile(corrected_rate(n - k, n, correction))
                     : normal_quantile(corrected_rate(k, n, correction)) + 0.0;  // never -0
}

// Variance of that z: rate (1 - rate) / (n phi(z)^2).
double variance_of_z(int k, int n, double z, Correction correction) noexcept {
  const double density = normal_density(z);
  return corrected_rate(k, n, correction) * corrected_rate(n - k, n, correction) / (n * density * density);
}

constexpr auto kRateStatusWords = words<RateStatus>(
    {{"ok", RateStatus::ok}, {"no_information", RateStatus::no_information}, {"missing", RateStatus::missing}});

}  // namespace

std::string_view to_string(RateStatus status) noexcept {
  return word_of(kRateStatusWords, status);
}

YesNo yes_no(const Counts& counts, Correction correction) noexcept {
  YesNo result;
  result.correction = correction;
  if (counts.n_diff <= 0 || counts.n_same <= 0) {
    // Never a pseudo-value: the log-linear rate of 0 out of 0 would be 0.5, which looks like an observation.
    result.status = RateStatus::missing;
    result.raw_hit_rate = result.raw_false_alarm_rate = kNaN;
    result.hit_rate = result.false_alarm_rate = kNaN;
    result.z_hit = result.z_false_alarm = kNaN;
    result.dprime = result.criterion = result.ln_beta = kNaN;
    result.se = result.ci_low = result.ci_high = kNaN;
    return result;
  }
  const int said_different = counts.hits + counts.false_alarms;
  const bool one_answer = said_different == 0 || said_different == counts.n_diff + counts.n_same;
  result.status = one_answer ? RateStatus::no_information : RateStatus::ok;
  result.raw_hit_rate = corrected_rate(counts.hits, counts.n_diff, Correction::none);
  result.raw_false_alarm_rate = corrected_rate(counts.false_alarms, counts.n_same, Correction::none);
  result.hit_rate = corrected_rate(counts.hits, counts.n_diff, correction);
  result.false_alarm_rate = corrected_rate(counts.false_alarms, counts.n_same, correction);
  result.z_hit = corrected_z(counts.hits, counts.n_diff, correction);
  result.z_false_alarm = corrected_z(counts.false_alarms, counts.n_same, correction);
  result.dprime = result.z_hit - result.z_false_alarm;
  result.criterion = -0.5 * (result.z_hit + result.z_false_alarm) + 0.0;
  result.ln_beta = 0.5 * (result.z_false_alarm - result.z_hit) * (result.z_false_alarm + result.z_hit) + 0.0;
  result.se = std::sqrt(variance_of_z(counts.hits, counts.n_diff, result.z_hit, correction) +
                        variance_of_z(counts.false_alarms, counts.n_same, result.z_false_alarm, correction));
  result.ci_low = result.dprime - kZ975 * result.se;
  result.ci_high = result.dprime + kZ975 * result.se;
  return result;
}

}  // namespace jnd
