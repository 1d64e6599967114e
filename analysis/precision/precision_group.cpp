#include "analysis/precision/precision_group.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <boost/math/distributions/students_t.hpp>

#include "analysis/numerics/sample_quantile.h"
#include "analysis/numerics/special_values.h"
#include "analysis/precision/monte_carlo.h"

namespace jnd {

namespace {

// Mean and 95 % t interval without calling for the t quantile each time.
class Intervals {
 public:
  explicit Intervals(int most) {
    for (int n = 2; n <= most; ++n)
      factors_.push_back(boost::math::quantile(boost::math::students_t(n - 1), 0.975) / std::sqrt(n));
  }
  struct Interval {
    double mean = 0, half_width = 0;
  };
  Interval of(std::span<const double> values) const {  // at least one; half_width NaN for one
    const auto n = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    const double mean = sum / n;
    if (values.size() < 2) return {mean, kNaN};
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, factors_[values.size() - 2] * std::sqrt(squares / (n - 1))};
  }

 private:
  std::vector<double> factors_;  // t / sqrt(n) for n = 2, 3, ...
};

// What the studies of one condition, or of one contrast, came to.
struct Tally {
  std::vector<double> means, widths;
  int without_interval = 0, with_undefined = 0, excluding_zero = 0, slopes_excluding_zero = 0;
  double undefined = 0;
};

bool excludes_zero(const Intervals::Interval& interval) {
  return std::abs(interval.mean) > interval.half_width;  // false for NaN
}

void add(Tally& tally, std::span<const double> values, std::size_t participants, const Intervals& intervals) {
  if (values.size() < participants) ++tally.with_undefined;
  tally.undefined += static_cast<double>(participants - values.size());
  if (values.empty()) {
    ++tally.without_interval;
    return;
  }
  const Intervals::Interval interval = intervals.of(values);
  tally.means.push_back(interval.mean);
  if (values.size() < 2) {
    ++tally.without_interval;
    return;
  }
  tally.widths.push_back(2 * interval.half_width);
  if (excludes_zero(interval)) ++tally.excluding_zero;
}

void add_condition(Tally& tally, std::span<const double> slopes, const Intervals& intervals,
                   std::vector<double>& work) {
  work.clear();
  for (const double slope : slopes)
    if (status_of_slope(slope) == JndStatus::ok) work.push_back(1 / slope);
  add(tally, work, slopes.size(), intervals);
}

void add_contrast(Tally& tally, std::span<const double> a, std::span<const double> b, const Intervals& intervals,
                  std::vector<double>& work) {
  work.clear();
  for (std::size_t i = 0; i < a.size(); ++i)
    if (status_of_slope(a[i]) == JndStatus::ok && status_of_slope(b[i]) == JndStatus::ok)
      work.push_back(1 / a[i] - 1 / b[i]);
  add(tally, work, a.size(), intervals);
  work.clear();
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) work.push_back(a[i] - b[i]);
  if (work.size() >= 2 && excludes_zero(intervals.of(work))) ++tally.slopes_excluding_zero;
}

double share_se(double share, double n) {
  return std::sqrt(share * (1 - share) / n);
}

GroupPrecision group_of(Tally tally, double experiments) {
  const SampleQuantiles means(std::move(tally.means)), widths(std::move(tally.widths));
  GroupPrecision group;
  group.median = means.at(0.5);
  group.q05 = means.at(0.05);
  group.q95 = means.at(0.95);
  group.ci_width = widths.at(0.5);
  group.ci_width_se = widths.standard_error(0.5);
  group.without_interval = tally.without_interval / experiments;
  group.with_undefined = tally.with_undefined / experiments;
  group.mean_undefined = tally.undefined / experiments;
  return group;
}

ContrastPrecision contrast_of(Tally tally, double experiments) {
  const SampleQuantiles means(std::move(tally.means)), widths(std::move(tally.widths));
  ContrastPrecision contrast;
  contrast.median = means.at(0.5);
  contrast.ci_width = widths.at(0.5);
  contrast.ci_width_se = widths.standard_error(0.5);
  contrast.power = tally.excluding_zero / experiments;
  contrast.power_se = share_se(contrast.power, experiments);
  contrast.power_of_slopes = tally.slopes_excluding_zero / experiments;
  contrast.power_of_slopes_se = share_se(contrast.power_of_slopes, experiments);
  contrast.without_interval = tally.without_interval / experiments;
  contrast.with_undefined = tally.with_undefined / experiments;
  return contrast;
}

}  // namespace

void set_group_precision(Precision& result, const std::function<void(int)>& progress) {
  constexpr int kReports = 500;
  const PrecisionQuestion& question = result.question;
  StudyModel model;
  model.design = question.design;
  model.jnds = question.jnds;
  model.participants = question.participants;
  model.between_cv = question.between_cv;
  const StudySimulator simulator(model);
  const Intervals intervals(question.participants);
  const std::size_t participants = simulator.participants();
  std::vector<double> slopes(simulator.conditions() * participants), work;
  const auto of_condition = [&](std::size_t condition) {
    return std::span<const double>(slopes).subspan(condition * participants, participants);
  };
  std::vector<Tally> conditions(simulator.conditions()), contrasts(question.contrasts.size());
  for (int experiment = 0; experiment < question.experiments; ++experiment) {
    if (progress && experiment % (1 + question.experiments / kReports) == 0) progress(experiment);
    simulator.slopes(question.seed, static_cast<std::uint64_t>(experiment), slopes);
    for (std::size_t i = 0; i < conditions.size(); ++i) add_condition(conditions[i], of_condition(i), intervals, work);
    for (std::size_t i = 0; i < contrasts.size(); ++i)
      add_contrast(contrasts[i], of_condition(static_cast<std::size_t>(question.contrasts[i][0])),
                   of_condition(static_cast<std::size_t>(question.contrasts[i][1])), intervals, work);
  }
  for (Tally& tally : conditions) result.group.push_back(group_of(std::move(tally), question.experiments));
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    const auto [a, b] = question.contrasts[i];
    ContrastPrecision contrast = contrast_of(std::move(contrasts[i]), question.experiments);
    contrast.a = a;
    contrast.b = b;
    contrast.true_difference = question.jnds[static_cast<std::size_t>(a)] - question.jnds[static_cast<std::size_t>(b)];
    result.contrasts.push_back(contrast);
  }
}

}  // namespace jnd
