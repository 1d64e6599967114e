// What every estimate of a threshold asks of its series, whichever the method.
#pragma once

#include <span>
#include <vector>

#include "analysis/thresholds/jnd.h"

namespace jnd {

// d' per N/m: at or below this a slope is a rounding zero. At 1e-9 the JND would be 1e9 N/m.
inline constexpr double kLeastSlope = 1e-9;

struct UsableSeries {
  std::vector<SeriesCounts> series;  // both classes have trials
  bool missing = false;              // some series was left out
  bool few_trials = false;           // fewer than 10 trials in a class of some series that is used
  bool any_information = false;      // some series has both answers
  bool all_at_largest = false;       // in every series: every different pair found, no equal pair mistaken
  double smallest = 0, largest = 0;  // tested differences, N/m; 0 without series
};
UsableSeries usable_series(std::span<const SeriesCounts> series);

}  // namespace jnd
