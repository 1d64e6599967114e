#include "protocols/tasks/task_estimates.h"

#include <algorithm>

#include "analysis/choice/choice_dprime.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"

namespace jnd {
namespace {

// Of the slope m = 1 / JND; counts with a difference of 0 say nothing about it.
double log_likelihood(ChoiceTask task, std::span<const ChoiceCount> counts, double slope) {
  double sum = 0;
  for (const ChoiceCount& one : counts) {
    const ChoiceRate rate = choice_rate(task, slope * one.difference);
    if (one.correct > 0) sum += one.correct * std::log(rate.correct);
    if (one.n > one.correct) sum += (one.n - one.correct) * std::log(rate.wrong);
  }
  return sum;
}

// The place of the highest value between two others, by golden section; the function has one peak there.
template <typename Function>
double highest(Function&& function, double low, double high) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double at_a = function(a), at_b = function(b);
  for (int i = 0; i < 120 && high - low > 1e-12 * (1 + std::abs(low)); ++i) {
    if (at_a < at_b) {
      low = a;
      a = b;
      at_a = at_b;
      b = low + ratio * (high - low);
      at_b = function(b);
    } else {
      high = b;
      b = a;
      at_b = at_a;
      a = high - ratio * (high - low);
      at_a = function(a);
    }
  }
  return 0.5 * (low + high);
}

// Where the function falls through 0 between inside (positive) and outside (negative).
template <typename Function>
double crossing(Function&& function, double inside, double outside) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (inside + outside);
    (function(middle) >= 0 ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

constexpr double kWidest = 12;  // of ln slope on either side of d' = 1 at the largest difference
constexpr int kLooks = 96;      // over that range, to bracket the peak

}  // namespace

TaskEstimate task_estimate(std::optional<double> value, std::optional<ChoiceBounds> interval) {
  TaskEstimate estimate;
  if (value) estimate.value = defined(*value);
  if (interval) {
    estimate.low = defined(interval->low);
    estimate.high = defined(interval->high);
  }
  return estimate;
}

TaskEstimate scaled(TaskEstimate estimate, double by) noexcept {
  for (std::optional<double>* const number : {&estimate.value, &estimate.low, &estimate.high})
    if (*number) **number *= by;
  return estimate;
}

TaskEstimate share_correct(std::span<const AnsweredTrial> trials) {
  int n = 0, correct = 0;
  for (const AnsweredTrial& trial : trials) {
    if (trial.target < 0) continue;
    ++n;
    correct += trial.correct() ? 1 : 0;
  }
  if (n == 0) return {};
  const ExactProportion share = exact_proportion(correct, n);
  return {share.share, share.ci_low, share.ci_high};
}

std::vector<ChoiceCount> counts_by_difference(std::span<const AnsweredTrial> trials) {
  std::map<double, ChoiceCount> by_difference;
  for (const AnsweredTrial& trial : trials) {
    if (trial.target < 0) continue;
    const auto [least, greatest] = std::minmax_element(trial.stimuli.begin(), trial.stimuli.end());
    ChoiceCount& count = by_difference[*greatest - *least];
    count.difference = *greatest - *least;
    ++count.n;
    count.correct += trial.correct() ? 1 : 0;
  }
  std::vector<ChoiceCount> counts;
  for (const auto& [difference, count] : by_difference) counts.push_back(count);
  return counts;
}

ChoiceJnd choice_jnd(ChoiceTask task, std::span<const ChoiceCount> counts) {
  if (counts.empty()) return {"no_trials", kNaN, kNaN, kNaN};
  const double unit = counts.back().difference;  // so that ln slope is near 0
  const auto value = [&](double ln_slope) { return log_likelihood(task, counts, std::exp(ln_slope) / unit); };
  const bool all_correct =
      std::all_of(counts.begin(), counts.end(), [](const auto& one) { return one.correct == one.n; });
  const double at_zero = log_likelihood(task, counts, 0);
  // A coarse look first: the peak is bracketed whatever the data.
  double best = -kWidest, best_value = value(-kWidest);
  for (int step = 0; step <= kLooks; ++step) {
    const double ln_slope = -kWidest + 2 * kWidest * step / kLooks;
    const double here = value(ln_slope);
    if (here > best_value) {
      best = ln_slope;
      best_value = here;
    }
  }
  if (!all_correct) {
    best = highest(value, best - 0.25, best + 0.25);
    best_value = std::max(value(best), at_zero);
  } else {
    best_value = 0;
  }
  ChoiceJnd result;
  const bool none = !all_correct && at_zero >= value(best) - 1e-9;
  result.status = all_correct ? "ceiling" : none ? "no_sensitivity" : "ok";
  result.jnd = all_correct ? 0 : none ? kInf : unit / std::exp(best);
  const auto inside = [&](double ln_slope) { return value(ln_slope) - (best_value - kProfileDrop); };
  // From the estimate outwards: the steep end of the slope is the low end of the JND.
  const double peak = all_correct ? kWidest : none ? -kWidest : best;
  result.low = all_correct || inside(kWidest) >= 0 ? 0 : unit / std::exp(crossing(inside, peak, kWidest));
  result.high = none || at_zero >= best_value - kProfileDrop ? kInf : unit / std::exp(crossing(inside, peak, -kWidest));
  return result;
}

TaskCurve choice_curve(ChoiceTask task, std::span<const AnsweredTrial> trials) {
  const std::vector<ChoiceCount> counts = counts_by_difference(trials);
  TaskCurve curve;
  curve.said = "correct";
  for (const ChoiceCount& one : counts) curve.points.push_back({one.difference, one.n, one.correct});
  const ChoiceJnd fit = choice_jnd(task, counts);
  if (fit.status != "ok") return curve;
  curve.x = evenly(0, counts.back().difference, 60);
  for (const double x : curve.x) curve.fitted.push_back(choice_rate(task, x / fit.jnd).correct);
  return curve;
}

TaskOutcome share_of_correct() {
  return {"correct", "share correct", "", "share of correct answers, exact interval", true, false, false, true};
}

std::vector<TaskOutcome> choice_outcomes(const Protocol& protocol) {
  const std::string unit(to_string(protocol.stimulus.unit));
  return {{"jnd", "JND", unit, "difference at d' = 1, d' in proportion to the difference, maximum likelihood", true},
          {"weber", "Weber fraction", "", "jnd / standard", true, true},
          {"dprime", "d'", "", "d' of all trials together, whatever their difference", false},
          share_of_correct()};
}

TaskEstimates choice_estimates(ChoiceTask task, const Series& series, std::span<const AnsweredTrial> trials) {
  const std::vector<ChoiceCount> counts = counts_by_difference(trials);
  const ChoiceJnd jnd = choice_jnd(task, counts);
  int n = 0, correct = 0;
  for (const ChoiceCount& one : counts) {
    n += one.n;
    correct += one.correct;
  }
  const ChoiceDprime dprime = choice_dprime_of_counts(task, correct, n);
  TaskEstimates estimates;
  estimates.status = jnd.status;
  const double standard = series.standard;
  const auto estimate = [&](double unit) {
    const std::optional<double> value = jnd.status == "ok" ? std::optional(jnd.jnd / unit) : std::nullopt;
    return task_estimate(value, ChoiceBounds{jnd.low / unit, jnd.high / unit});
  };
  estimates.values = {estimate(1), standard != 0 ? estimate(standard) : TaskEstimate{},
                      task_estimate(dprime.dprime, ChoiceBounds{dprime.ci_low, dprime.ci_high}), share_correct(trials)};
  return estimates;
}

std::vector<double> evenly(double low, double high, int steps) {
  std::vector<double> values;
  for (int i = 0; i < steps; ++i) values.push_back(low + (high - low) * i / (steps - 1));
  return values;
}

}  // namespace jnd
