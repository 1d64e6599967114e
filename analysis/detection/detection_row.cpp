#include "analysis/detection/detection_row.h"

namespace jnd {

DetectionRow detection_row(const Counts& counts) {
  DetectionRow row;
  row.counts = counts;
  row.none = yes_no(counts, Correction::none);
  row.loglinear = yes_no(counts, Correction::loglinear);
  row.half = yes_no(counts, Correction::half);
  row.status = row.none.status;
  row.profile = yes_no_profile(counts);
  row.differencing = differencing(counts);
  row.differencing_loglinear = differencing_of_rates(counts, Correction::loglinear);
  row.independent_loglinear = independent_observation(counts, Correction::loglinear);
  row.independent_half = independent_observation(counts, Correction::half);
  row.bootstrap = dprime_bootstrap(counts);
  return row;
}

}  // namespace jnd
