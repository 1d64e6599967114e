#include "analysis/thresholds/counts_sampler.h"

namespace jnd {

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

}  // namespace jnd
