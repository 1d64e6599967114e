#include "analysis/detection/dprime_intervals.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"
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

constexpr double kTie = 1e-11;  // equal d' of different counts differ by rounding, of the order 1e-15

// The z score of the log-linear rate of one class, over all its outcomes: ascending.
struct ScoreDistribution {
  std::vector<double> z, probability, at_least;  // at_least[i] = P(z >= z[i]), with a 0 at the end
  double mean = 0, variance = 0;
};

ScoreDistribution scores(int n, int k) {
  const BinomialTable table = binomial_table(n, corrected_rate(k, n, Correction::loglinear));
  ScoreDistribution result;
  result.probability = table.probability;
  const std::size_t size = table.probability.size();
  for (std::size_t i = 0; i < size; ++i) {
    const int outcome = table.first + static_cast<int>(i);
    // From the rarer side, so that the distribution of the complement is the mirror image to the last bit.
    result.z.push_back(2.0 * outcome > n ? -normal_quantile(corrected_rate(n - outcome, n, Correction::loglinear))
                                         : normal_quantile(corrected_rate(outcome, n, Correction::loglinear)));
    result.mean += table.probability[i] * result.z[i];
  }
  result.at_least.assign(size + 1, 0);
  for (std::size_t i = size; i-- > 0;) {
    result.variance += table.probability[i] * (result.z[i] - result.mean) * (result.z[i] - result.mean);
    result.at_least[i] = result.at_least[i + 1] + table.probability[i];
  }
  return result;
}

// P(z_hit - z_alarm <= limit): both lists ascend, so one walk through each is enough.
double probability_up_to(double limit, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double sum = 0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < hit.z.size(); ++i) {
    while (j < alarm.z.size() && hit.z[i] - alarm.z[j] > limit) ++j;
    sum += hit.probability[i] * alarm.at_least[j];
  }
  return sum;
}

// The smallest difference above the limit.
double next_above(double limit, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double best = kInf;
  std::size_t j = 0;
  for (const double z : hit.z) {
    while (j < alarm.z.size() && z - alarm.z[j] > limit) ++j;
    if (j > 0) best = std::fmin(best, z - alarm.z[j - 1]);
  }
  return best;
}

struct Quantile {
  double value, probability;
};

Quantile quantile(double p, const ScoreDistribution& hit, const ScoreDistribution& alarm) {
  double low = hit.z.front() - alarm.z.back() - 1, high = hit.z.back() - alarm.z.front();
  while (high - low > 0.25 * kTie) {
    const double middle = 0.5 * (low + high);
    (probability_up_to(middle, hit, alarm) < p ? low : high) = middle;
  }
  // Everything up to low is too little; what follows reaches p.
  const double value = next_above(low, hit, alarm);
  return {value, probability_up_to(value + kTie, hit, alarm)};
}

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

DprimeBootstrap dprime_bootstrap(const Counts& counts) {
  if (counts.n_diff <= 0 || counts.n_same <= 0) {
    return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  }
  const ScoreDistribution hit = scores(counts.n_diff, counts.hits);
  const ScoreDistribution alarm = scores(counts.n_same, counts.false_alarms);
  const Quantile lower = quantile(0.025, hit, alarm), upper = quantile(0.975, hit, alarm);
  return {hit.mean - alarm.mean, std::sqrt(hit.variance + alarm.variance), lower.value, upper.value, lower.probability,
          upper.probability};
}

}  // namespace jnd
