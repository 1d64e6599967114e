#include "analysis/choice/choice_dprime.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "analysis/detection/binomial_likelihood.h"
#include "analysis/detection/counts.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

namespace {

constexpr auto kChoiceStatusWords = words<ChoiceStatus>({{"ok", ChoiceStatus::ok},
                                                         {"ceiling", ChoiceStatus::ceiling},
                                                         {"floor", ChoiceStatus::floor},
                                                         {"not_above_chance", ChoiceStatus::not_above_chance},
                                                         {"missing", ChoiceStatus::missing}});

// The likelihood of the count on z of the proportion, where it is smooth and concave up to both ends.
class CountProfile {
 public:
  CountProfile(int correct, int n, double maximum) : correct_(correct), n_(n), maximum_(maximum) {}
  ProfilePoint operator()(double z) const noexcept {
    const ProbitLikelihood at = probit_log_likelihood(correct_, n_, z);
    return {maximum_ - at.value, -at.slope};
  }

 private:
  int correct_, n_;
  double maximum_;
};

double dprime_of_z(ChoiceTask task, double z) noexcept {
  return choice_dprime(task, normal_cdf(z), normal_cdf(-z));
}

// Both ends lie where z of the proportion does, since P(d') only rises.
void set_interval(ChoiceDprime& result, ChoiceTask task) noexcept {
  const bool is_signed = has_signed_dprime(task);
  const double chance = normal_quantile(chance_level(task));
  const CountProfile profile(result.correct, result.n, result.log_likelihood);
  const bool at_chance = result.status == ChoiceStatus::not_above_chance;
  // First guesses, finite everywhere: two standard errors of z from the log-linear proportion.
  const double rate = corrected_rate(result.correct, result.n, Correction::loglinear);
  const double estimate = at_chance ? chance : normal_quantile(result.pc);
  const double middle = at_chance ? chance : normal_quantile(rate);
  const double width = 2 * std::sqrt(rate * (1 - rate) / result.n) / normal_density(normal_quantile(rate));
  result.ci_low = is_signed ? -kInf : 0;
  if (is_signed && result.correct > 0)
    result.ci_low = dprime_of_z(task, profile_bound(profile, estimate, -kInf, middle - width));
  if (!is_signed && !at_chance && profile(chance).drop > kProfileDrop)
    result.ci_low =
        dprime_of_z(task, profile_bound(profile, estimate, chance, std::fmax(middle - width, 0.5 * (chance + middle))));
  result.ci_high = kInf;
  if (result.correct < result.n)
    result.ci_high = dprime_of_z(task, profile_bound(profile, estimate, kInf, middle + width));
}

ChoiceStatus status_of(ChoiceTask task, int correct, int n) noexcept {
  if (correct == n) return ChoiceStatus::ceiling;
  if (has_signed_dprime(task)) return correct == 0 ? ChoiceStatus::floor : ChoiceStatus::ok;
  return std::int64_t{correct} * chance_of_one_in(task) > n ? ChoiceStatus::ok : ChoiceStatus::not_above_chance;
}

struct BothStrategies {
  double differencing, independent;
};

BothStrategies dprime_of_difference(RatesTask task, double zd) noexcept {
  if (std::isnan(zd)) return {kNaN, kNaN};
  if (task == RatesTask::reminder_one_interval) return {std::numbers::sqrt2 * zd, zd};
  if (task == RatesTask::reminder_two_intervals) return {zd / std::numbers::sqrt2, zd / std::numbers::sqrt2};
  const double correct = normal_cdf(0.5 * zd), wrong = normal_cdf(-0.5 * zd);
  return {choice_dprime(ChoiceTask::abx_differencing, correct, wrong),
          choice_dprime(ChoiceTask::abx_independent, correct, wrong)};
}

TwoRates two_rates(RatesTask task, const YesNo& rates) noexcept {
  const BothStrategies dprime = dprime_of_difference(task, rates.dprime);
  const double unbiased = task == RatesTask::reminder_one_interval ? kNaN : normal_cdf(0.5 * rates.dprime);
  return {rates.hit_rate, rates.false_alarm_rate, rates.dprime, unbiased, dprime.differencing, dprime.independent};
}

}  // namespace

std::string_view to_string(ChoiceStatus status) noexcept {
  return word_of(kChoiceStatusWords, status);
}

ChoiceDprime choice_dprime_of_counts(ChoiceTask task, int correct, int n) noexcept {
  ChoiceDprime result;
  result.n = n;
  result.correct = correct;
  result.pc = result.dprime = result.se = result.log_likelihood = result.ci_low = result.ci_high = kNaN;
  if (n <= 0) return result;
  const double trials = n, wrong = (trials - correct) / trials;
  result.status = status_of(task, correct, n);
  result.pc = correct / trials;
  if (result.status == ChoiceStatus::not_above_chance) {
    result.dprime = 0;
    result.log_likelihood = binomial_log_likelihood(correct, n, chance_level(task), 1 - chance_level(task));
  } else {
    result.dprime = choice_dprime(task, result.pc, wrong);
    result.log_likelihood = saturated_log_likelihood(correct, n);
  }
  if (result.status == ChoiceStatus::ok)
    result.se = std::sqrt(result.pc * wrong / trials) / choice_rate(task, result.dprime).slope;
  set_interval(result, task);
  return result;
}

RatesDprime dprime_of_rates(RatesTask task, const Counts& counts) noexcept {
  const YesNo raw = yes_no(counts, Correction::none), loglinear = yes_no(counts, Correction::loglinear);
  const DprimeProfile profile = yes_no_profile(counts);
  const BothStrategies low = dprime_of_difference(task, profile.ci_low);
  const BothStrategies high = dprime_of_difference(task, profile.ci_high);
  RatesDprime result;
  result.status = raw.status;
  result.counts = counts;
  result.raw = two_rates(task, raw);
  result.loglinear = two_rates(task, loglinear);
  result.se_z_difference = loglinear.se;
  result.z_difference_low = profile.ci_low;
  result.z_difference_high = profile.ci_high;
  result.differencing_low = low.differencing;
  result.differencing_high = high.differencing;
  result.independent_low = low.independent;
  result.independent_high = high.independent;
  return result;
}

}  // namespace jnd
