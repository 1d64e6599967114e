#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/numerics/binomial_sampler.h"
#include "analysis/psychometric/psychometric_interval.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "analysis/psychometric/psychometric_shape.h"

namespace jnd {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// Quantile by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996); no interpolation towards
// an infinite one: the nearer counts. sorted is not empty.
double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double part = place - static_cast<double>(below);
  const double low = sorted[below], high = sorted[std::min(below + 1, sorted.size() - 1)];
  if (std::isinf(low) || std::isinf(high)) return part < 0.5 ? low : high;
  return low + part * (high - low);
}

ConfidenceBounds percentiles(std::vector<double>& values, double confidence) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5 - 0.5 * confidence), quantile(values, 0.5 + 0.5 * confidence)};
}

struct Collected {
  std::vector<double> location, second, lapse, guess, pse, jnd, slope;
};

void add(std::vector<double>& values, double value) {
  if (!std::isnan(value)) values.push_back(value);
}

void collect(Collected& all, const PsychometricFit& fit) {
  if (fit.status == PsychometricStatus::not_increasing) {
    const bool grows = fit.model.function == PsychometricFunction::gaussian;  // sigma, as the slope falls
    all.second.push_back(grows ? kInf : 0.0);
    all.jnd.push_back(kInf);
    all.slope.push_back(0);
    return;
  }
  add(all.second, fit.second.value);
  add(all.jnd, fit.jnd.value);
  add(all.slope, fit.slope.value);
  add(all.location, fit.location.value);
  add(all.pse, fit.pse.value);
  if (!fit.model.lapse) add(all.lapse, fit.lapse.value);
  if (!fit.model.guess) add(all.guess, fit.guess.value);
}

}  // namespace

PsychometricBootstrap psychometric_bootstrap(std::span<const PsychometricLevel> levels, const PsychometricModel& model,
                                             int replicates, std::uint64_t seed, double confidence,
                                             const std::function<void(int)>& progress) {
  PsychometricBootstrap result;
  result.intervals.confidence = confidence;
  result.replicates = replicates;
  const PsychometricFit fit = fit_psychometric(levels, model);
  if (!is_estimate(fit.status)) return result;

  const PsychometricData data = psychometric_data(levels, model);
  std::vector<BinomialSampler> samplers;
  std::vector<PsychometricLevel> drawn;
  for (std::size_t i = 0; i < data.levels(); ++i) {
    const double f = psychometric_cdf(model.function, fit.location.value, fit.second.value, data.x[i]);
    const double p = fit.guess.value + (1 - fit.guess.value - fit.lapse.value) * f;
    samplers.emplace_back(static_cast<int>(data.n[i]), p);
    drawn.push_back({data.x[i], static_cast<int>(data.n[i]), 0});
  }

  std::mt19937_64 generator(seed);
  Collected all;
  int as_bad = 0;
  for (int replicate = 0; replicate < replicates; ++replicate) {
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i].k = samplers[i].at(open_uniform(generator));
    const PsychometricFit again = fit_psychometric(drawn, model);
    if (again.deviance >= fit.deviance) ++as_bad;
    if (is_estimate(again.status))
      ++result.estimates;
    else if (again.status == PsychometricStatus::separated)
      ++result.separated;
    else if (again.status == PsychometricStatus::not_increasing)
      ++result.not_increasing;
    else
      ++result.others;
    collect(all, again);  // of the others every number is NaN
    if (progress) progress(replicate + 1);
  }
  result.with_pse = static_cast<int>(all.pse.size());
  result.deviance_p = (1.0 + as_bad) / (1.0 + replicates);
  result.intervals.location = percentiles(all.location, confidence);
  result.intervals.second = percentiles(all.second, confidence);
  result.intervals.lapse = percentiles(all.lapse, confidence);
  result.intervals.guess = percentiles(all.guess, confidence);
  result.intervals.pse = percentiles(all.pse, confidence);
  result.intervals.jnd = percentiles(all.jnd, confidence);
  result.intervals.slope = percentiles(all.slope, confidence);
  return result;
}

}  // namespace jnd
