#include "analysis/behaviour/response_bias.h"

#include <cmath>

#include "analysis/numerics/exact_proportion.h"
#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

ResponseBias response_bias(const Counts& counts, double planned_share) {
  ResponseBias bias;
  bias.counts = counts;
  const YesNo rates = yes_no(counts, Correction::loglinear);
  bias.status = rates.status;
  bias.criterion = rates.criterion;
  bias.se = rates.status == RateStatus::missing ? kNaN : 0.5 * std::sqrt(loglinear_variance(counts));
  bias.ci_low = bias.criterion - kNormal975 * bias.se;
  bias.ci_high = bias.criterion + kNormal975 * bias.se;
  const int n = counts.n_diff + counts.n_same, said = counts.hits + counts.false_alarms;
  const ExactProportion exact = exact_proportion(said, n);
  bias.said_different = {said, n, exact.share, exact.ci_low, exact.ci_high};
  bias.planned_share = planned_share;
  bias.p = n == 0 ? kNaN : binomial_exact_p(said, n, planned_share);
  return bias;
}

ResponseBias response_bias(std::span<const JudgedTrial> trials, double planned_share) {
  return response_bias(counts_of(trials), planned_share);
}

}  // namespace jnd
