#include "analysis/thresholds/jnd_bootstrap.h"

#include <algorithm>

#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

// Keeps this use of a seed apart from others: "jndboot" in ASCII.
constexpr std::uint64_t kBootstrapPurpose = 0x6a6e64626f6f74;

double jnd_of(double slope) noexcept {
  return slope > kLeastSlope ? 1 / slope : kInf;
}

}  // namespace

CountsSampler::Cell CountsSampler::cell(int n, double rate) {
  const BinomialTable table = binomial_table(n, rate);
  Cell cell;
  cell.first = table.first;
  cell.table = AliasTable(table.probability);
  return cell;
}

CountsSampler::CountsSampler(std::span<const SeriesCounts> series, std::span<const double> hit_rates,
                             std::span<const double> false_alarm_rates)
    : series_(series.begin(), series.end()) {
  for (std::size_t i = 0; i < series_.size(); ++i) {
    hits_.push_back(cell(series_[i].counts.n_diff, hit_rates[i]));
    false_alarms_.push_back(cell(series_[i].counts.n_same, false_alarm_rates[i]));
  }
}

void CountsSampler::draw(ExperimentStream& stream, std::vector<SeriesCounts>& drawn) const {
  drawn = series_;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    drawn[i].counts.hits = hits_[i].draw(stream);
    drawn[i].counts.false_alarms = false_alarms_[i].draw(stream);
  }
}

JndBootstrap least_squares_bootstrap(std::span<const SeriesCounts> series, Correction correction, int replicates,
                                     std::uint64_t seed) {
  const std::vector<SeriesCounts> usable = usable_series(series).series;
  std::vector<double> hit_rates, false_alarm_rates;
  for (const SeriesCounts& one : usable) {
    hit_rates.push_back(corrected_rate(one.counts.hits, one.counts.n_diff, Correction::loglinear));
    false_alarm_rates.push_back(corrected_rate(one.counts.false_alarms, one.counts.n_same, Correction::loglinear));
  }
  const CountsSampler sampler(usable, hit_rates, false_alarm_rates);

  JndBootstrap result;
  result.replicates = replicates;
  std::vector<double> slopes;
  std::vector<SeriesCounts> drawn;
  for (int i = 0; i < replicates; ++i) {
    ExperimentStream stream(seed, kBootstrapPurpose, static_cast<std::uint64_t>(i));
    sampler.draw(stream, drawn);
    const JndEstimate estimate = least_squares_jnd(drawn, 1, correction);
    switch (estimate.status) {
      case JndStatus::ok:
        ++result.ok;
        break;
      case JndStatus::no_sensitivity:
        ++result.no_sensitivity;
        break;
      case JndStatus::ceiling:
        ++result.ceiling;
        break;
      case JndStatus::no_information:
        ++result.no_information;
        continue;
    }
    slopes.push_back(estimate.slope);
  }
  result.ci_low = result.ci_high = result.slope_ci_low = result.slope_ci_high = kNaN;
  if (slopes.empty()) return result;
  std::sort(slopes.begin(), slopes.end());
  // Order statistics of rank ceil(n / 40) from either end, without interpolation: infinities stay what they are, and
  // the bounds of 1/m are those of m.
  const std::size_t rank = (slopes.size() + 39) / 40;
  result.slope_ci_low = slopes[rank - 1];
  result.slope_ci_high = slopes[slopes.size() - rank];
  result.ci_low = jnd_of(result.slope_ci_high);
  result.ci_high = jnd_of(result.slope_ci_low);
  return result;
}

}  // namespace jnd
