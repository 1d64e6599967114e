// Draws the counts of a row of series anew, for parametric bootstraps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

class CountsSampler {
 public:
  // hit_rates, false_alarm_rates: one a series, 0..1.
  CountsSampler(std::span<const SeriesCounts> series, std::span<const double> hit_rates,
                std::span<const double> false_alarm_rates);

  // The same series with other hits and false alarms: two random numbers a series, hits first.
  void draw(ExperimentStream& stream, std::vector<SeriesCounts>& drawn) const;

 private:
  struct Cell {
    int first = 0;
    AliasTable table;
    int draw(ExperimentStream& stream) const noexcept { return first + static_cast<int>(table.draw(stream.next())); }
  };
  static Cell cell(int n, double rate);
  std::vector<SeriesCounts> series_;
  std::vector<Cell> hits_, false_alarms_;
};

}  // namespace jnd
