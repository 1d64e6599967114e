// The just-noticeable difference: the stiffness difference at d' = 1, from d' at several differences.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "analysis/counts.h"

namespace jnd {

enum class JndStatus {
  ok,
  no_sensitivity,  // slope <= 1e-9: no difference is noticeable
  ceiling,         // slope infinite: the JND is below anything that was tested
  no_information   // every series was missing, or every answer was the same
};
std::string_view to_string(JndStatus status) noexcept;

// Remarks that exclude nothing.
enum class Caution {
  extrapolated,   // JND outside the tested differences
  floor,          // every d' at the largest value that the correction allows: the JND cannot come out lower
  few_trials,     // fewer than 10 trials a class in some series
  series_missing  // a series with an empty class was left out
};
std::string_view to_string(Caution caution) noexcept;

// One series of one participant and condition.
struct SeriesCounts {
  double difference = 0;  // N/m, > 0
  Counts counts;
};

struct JndEstimate {
  JndStatus status = JndStatus::no_information;
  std::vector<Caution> cautions;
  int series_used = 0;
  double slope = 0;  // d' per N/m; NaN under no_information
  double jnd = 0;    // N/m, 1 / slope; NaN under no_sensitivity and no_information, 0 at the ceiling
  double weber = 0;  // jnd / reference; NaN where jnd is
};

// Least squares through the origin: m = sum(dK d') / sum(dK^2), JND = 1/m (Chinello 2017, section 5.1.3: d' assumed
// proportional to the difference). Series with an empty class are left out and named by a caution; series without
// information stay in with their corrected d' (0), the paper's convention.
JndEstimate least_squares_jnd(std::span<const SeriesCounts> series, double reference_n_per_m, Correction correction);

}  // namespace jnd
