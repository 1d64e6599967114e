// Magnitude estimation: numbers that participants give to stimuli, and the exponent of the power law between them.
//
// answer = a stimulus^exponent (Stevens 1957, Psychological Review 64, 153-181). Everything is done on natural
// logarithms, as answers scatter by ratios:
//   L_pi  mean of ln answer over the repeats of stimulus i by participant p: the cell
//   m_p   mean of L_pi over the stimuli, each weighing the same whatever its repeats; g = mean of m_p
//   exp(L_pi - m_p + g)  the cell once the participants' moduli are equal (Lane, Catania and Stevens 1961, Journal of
//         the Acoustical Society of America 33, 160-167): their own choice of unit is taken off, their exponent is not
// and the exponent is the least-squares slope of L on ln stimulus. A number of 0 or below has no logarithm: one such
// answer refuses the whole set, and its place is told; leaving it out would steepen the line.
//
// Accuracy: 1e-12 relative. Tests: reference numbers of Python (closed formulas) and R 4.2.2 (lm, t.test).
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/numerics/statistic_status.h"
#include "analysis/scaling/mean_interval.h"

namespace jnd {

// The straight line of ln answer on ln stimulus.
struct PowerLaw {
  double exponent = 0, intercept = 0;                     // intercept: at ln stimulus = 0
  double se = 0;                                          // of the exponent
  double ci_low = 0, ci_high = 0;                         // 95 %, Student t of n - 2 degrees of freedom
  double r2 = 0;                                          // share of the variance of ln answer, 0..1
  double residual_sd = 0;                                 // n - 2 in the denominator
  StatisticStatus status = StatisticStatus::ok;           // else too_few (fewer than two stimuli): all NaN
  StatisticStatus interval_status = StatisticStatus::ok;  // else too_few (two stimuli): se, ci, residual_sd NaN
  StatisticStatus r2_status = StatisticStatus::ok;        // else too_few, no_variance (the answers are all alike): NaN
};
// ln_stimulus, ln_answer: of equal size, finite; the stimuli differ.
PowerLaw power_law(const std::vector<double>& ln_stimulus, const std::vector<double>& ln_answer);

// Answers of all participants to the same stimuli.
struct MagnitudeEstimates {
  std::vector<double> stimuli;                            // > 0, finite, each once
  std::vector<std::vector<std::vector<double>>> answers;  // [participant][stimulus][repeat], finite; no cell empty
};

// An answer that has no logarithm. Places count from 1, in the order of the input.
struct RefusedAnswer {
  std::size_t participant = 0, stimulus = 0, repeat = 0;
  double answer = 0;  // <= 0
};

struct ParticipantMagnitudes {
  std::vector<double> cells;       // geometric mean of the repeats, for each stimulus
  std::vector<double> normalised;  // the same after equalising the moduli
  double geometric_mean = 0;       // exp(m_p)
  PowerLaw law;
};

struct MagnitudeScale {
  std::vector<RefusedAnswer> refused;  // where there is one, nothing else is computed
  std::vector<ParticipantMagnitudes> participants;
  double grand_geometric_mean = 0;  // exp(g)
  // Of the group, for each stimulus: geometric mean, and the standard error of its logarithm once the moduli are equal
  // (empty for one participant).
  std::vector<double> group_geometric_means, group_ln_se;
  PowerLaw group;          // through the group's geometric means
  MeanInterval exponents;  // of the participants

  bool ok() const noexcept { return refused.empty(); }
};
MagnitudeScale magnitude_scale(const MagnitudeEstimates& estimates);

}  // namespace jnd
