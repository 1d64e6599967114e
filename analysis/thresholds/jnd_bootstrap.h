// Parametric bootstraps: draws the counts of a row of series anew, and with them a least-squares JND.
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

// How far a least-squares JND could have come out differently: a parametric bootstrap of its counts.
//
// Each replicate draws the hits and false alarms of every usable series anew, binomially, with the trials of the
// original and the log-linear rates of the original as probabilities, and goes through the same estimate (Efron and
// Tibshirani 1993, An Introduction to the Bootstrap, section 6.5). Log-linear whatever the correction of the estimate
// is: raw rates of 0 and 1 would never vary. No model of the slope is assumed in the draw, only in the estimate.
struct JndBootstrap {
  // 95 % percentile interval of the JND over the replicates with a slope; no_sensitivity counts as +inf and ceiling as
  // 0, so that nothing is dropped for looking bad. NaN where no replicate has a slope.
  double ci_low = 0, ci_high = 0;
  double slope_ci_low = 0, slope_ci_high = 0;
  int replicates = 0;                                               // drawn
  int ok = 0, no_sensitivity = 0, ceiling = 0, no_information = 0;  // they add up to replicates
};

// replicates >= 1 (2000 give the bounds to about 5 % of the interval's width); the same seed gives the same counts on
// every machine. Replicate i does not depend on how many are drawn. As in estimate_jnd for the rest.
JndBootstrap least_squares_bootstrap(std::span<const SeriesCounts> series, Correction correction, int replicates,
                                     std::uint64_t seed);

}  // namespace jnd
