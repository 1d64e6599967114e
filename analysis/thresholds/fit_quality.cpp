#include "analysis/thresholds/fit_quality.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/tail_probabilities.h"
#include "analysis/numerics/words.h"
#include "analysis/thresholds/jnd.h"
#include "analysis/thresholds/jnd_bootstrap.h"
#include "analysis/thresholds/jnd_ml.h"

namespace jnd {

namespace {

// Keeps this use of a seed apart from others: "jndfit" in ASCII.
constexpr std::uint64_t kFitPurpose = 0x6a6e64666974;

struct Misfit {
  double deviance = 0, pearson = 0;
  void operator+=(const Misfit& other) noexcept {
    deviance += other.deviance;
    pearson += other.pearson;
  }
};

// k of n where p was expected. p is 0 or 1 only where the likelihood demands it, that is where k is 0 or n.
Misfit cell_misfit(int k, int n, double p) noexcept {
  Misfit cell;
  const double expected = n * p, unexpected = n * (1 - p);
  if (k > 0) cell.deviance += 2 * k * std::log(k / expected);
  if (k < n) cell.deviance += 2 * (n - k) * std::log((n - k) / unexpected);
  cell.deviance = std::fmax(0, cell.deviance);
  if (p > 0 && p < 1) cell.pearson = (k - expected) * (k - expected) / (expected * (1 - p));
  return cell;
}

Misfit misfit(std::span<const SeriesCounts> series, const MlSlope& fit) noexcept {
  Misfit sum;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Counts& counts = series[i].counts;
    sum += cell_misfit(counts.hits, counts.n_diff, fit.rates[i].different_pair);
    sum += cell_misfit(counts.false_alarms, counts.n_same, fit.rates[i].equal_pair);
  }
  return sum;
}

// Draws from the fit, fits again, and counts what fits no better.
void bootstrap(FitQuality& quality, std::span<const SeriesCounts> series, const MlSlope& fit, JndMethod method,
               std::uint64_t seed) {
  std::vector<double> hit_rates, false_alarm_rates;
  for (const MlSlope::Rates& rates : fit.rates) {
    hit_rates.push_back(rates.different_pair);
    false_alarm_rates.push_back(rates.equal_pair);
  }
  const CountsSampler sampler(series, hit_rates, false_alarm_rates);
  // What differs by less is a tie that rounding has split.
  constexpr double kTie = 1e-9;
  int worse_deviance = 0, worse_pearson = 0;
  std::vector<SeriesCounts> drawn;
  for (int i = 0; i < quality.replicates; ++i) {
    ExperimentStream stream(seed, kFitPurpose, static_cast<std::uint64_t>(i));
    sampler.draw(stream, drawn);
    const Misfit found = misfit(drawn, ml_point(drawn, method));
    if (found.deviance >= quality.deviance - kTie) ++worse_deviance;
    if (found.pearson >= quality.pearson - kTie) ++worse_pearson;
  }
  quality.deviance_p_bootstrap = (1.0 + worse_deviance) / (1.0 + quality.replicates);
  quality.pearson_p_bootstrap = (1.0 + worse_pearson) / (1.0 + quality.replicates);
}

constexpr auto kFitStatusWords = words<FitStatus>({{"ok", FitStatus::ok},
                                                   {"no_degrees_of_freedom", FitStatus::no_degrees_of_freedom},
                                                   {"few_trials", FitStatus::few_trials},
                                                   {"no_information", FitStatus::no_information}});

}  // namespace

std::string_view to_string(FitStatus status) noexcept {
  return word_of(kFitStatusWords, status);
}

FitQuality fit_quality(std::span<const SeriesCounts> series, JndMethod method, int replicates, std::uint64_t seed) {
  if (!is_maximum_likelihood(method))
    throw std::invalid_argument("fit_quality needs a maximum-likelihood method, not " + std::string(to_string(method)));
  const std::vector<SeriesCounts> usable = usable_series(series).series;
  const bool common = method == JndMethod::ml_yes_no_common || method == JndMethod::ml_differencing_common;
  FitQuality quality;
  quality.cells = 2 * static_cast<int>(usable.size());
  quality.parameters = 1 + (common ? 1 : static_cast<int>(usable.size()));
  quality.degrees_of_freedom = quality.cells - quality.parameters;
  quality.deviance = quality.pearson = quality.deviance_p = quality.pearson_p = kNaN;
  quality.deviance_p_bootstrap = quality.pearson_p_bootstrap = kNaN;
  const MlSlope fit = ml_point(usable, method);
  if (std::isnan(fit.slope)) return quality;

  const Misfit found = misfit(usable, fit);
  quality.deviance = found.deviance;
  quality.pearson = found.pearson;
  if (quality.degrees_of_freedom <= 0) {
    quality.status = FitStatus::no_degrees_of_freedom;
    return quality;
  }
  CountsPerLevel counts;
  for (const SeriesCounts& one : usable) {
    counts.add(one.counts.n_diff, one.counts.hits);
    counts.add(one.counts.n_same, one.counts.false_alarms);
  }
  quality.status = counts.too_few() ? FitStatus::few_trials : FitStatus::ok;
  if (quality.status == FitStatus::ok) {
    quality.deviance_p = chi2_upper(found.deviance, quality.degrees_of_freedom);
    quality.pearson_p = chi2_upper(found.pearson, quality.degrees_of_freedom);
  }
  quality.replicates = replicates;
  if (replicates > 0) bootstrap(quality, usable, fit, method, seed);
  return quality;
}

}  // namespace jnd
