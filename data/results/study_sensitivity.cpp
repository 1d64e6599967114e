#include "data/results/study_sensitivity.h"

#include <cmath>

#include "analysis/numerics/special_values.h"
#include "data/results/study_comparisons.h"
#include "data/results/study_models.h"

namespace jnd {

namespace {

// The same cells under another method.
std::vector<ThresholdResult> thresholds_under(const StudyAnalysis& analysis, const Protocol& protocol,
                                              const ThresholdMethod& method) {
  std::vector<ThresholdResult> thresholds;
  for (std::size_t row = 0; row < analysis.thresholds.size(); ++row) {
    const std::vector<SeriesCounts> counts = series_of_threshold(analysis, protocol, row);
    ThresholdResult threshold;
    threshold.participant = analysis.thresholds[row].participant;
    threshold.condition = analysis.thresholds[row].condition;
    threshold.group = analysis.thresholds[row].group;
    threshold.jnd = estimate_jnd(counts, protocol.stimulus.reference, method.method, method.correction);
    thresholds.push_back(std::move(threshold));
  }
  return thresholds;
}

SensitivityRow row_of(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol,
                      const ThresholdMethod& method) {
  SensitivityRow row;
  row.method = method;
  const std::size_t conditions = protocol.conditions.size();
  row.participants = static_cast<int>(by_participant(thresholds, conditions).size());
  for (std::size_t condition = 0; condition < conditions; ++condition) {
    std::vector<JndEstimate> estimates;
    for (const ThresholdResult& threshold : thresholds)
      if (threshold.condition == static_cast<int>(condition)) estimates.push_back(threshold.jnd);
    const JndGroup group = jnd_group(estimates);
    row.median_status.push_back(group.median_status);
    row.median_jnd.push_back(group.median_jnd);
    row.mean_jnd.push_back(group.mean_jnd.mean);
    row.n_ok.push_back(group.mean_jnd.n);
  }
  const OutcomeComparison outcome = compare_thresholds(thresholds, protocol, protocol.analysis.tests.outcome);
  row.n = static_cast<int>(outcome.table.n);
  row.refused = outcome.refused;
  const bool tested = outcome.refused.empty();
  row.omnibus_p = tested ? omnibus_p(outcome.comparison, protocol.analysis) : kNaN;
  if (!outcome.crossed) {
    for (const ContrastWithin& contrast : contrasts_within(outcome, protocol)) {
      row.contrast_p.push_back(contrast.p);
      row.contrast_slope.push_back(contrast.refused.empty() ? mean_with_ci(contrast.differences).mean : kNaN);
    }
    return row;
  }
  row.contrast_p = tested ? contrast_p(outcome.comparison, protocol.analysis)
                          : std::vector<double>(protocol.analysis.contrasts.size(), kNaN);
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    if (!tested) {
      row.contrast_slope.push_back(kNaN);
      continue;
    }
    const PairPlace place = pair_of(contrast, conditions);
    const double difference = outcome.comparison.pairs[place.pair].mean_difference;
    row.contrast_slope.push_back(place.turned ? -difference : difference);
  }
  return row;
}

bool significant(double p, double alpha) noexcept {
  return p <= alpha;  // false for an undefined p
}

bool decides_alike(const SensitivityRow& row, const SensitivityRow& registered, double alpha) {
  if (!row.refused.empty() || !registered.refused.empty()) return false;
  if (significant(row.omnibus_p, alpha) != significant(registered.omnibus_p, alpha)) return false;
  for (std::size_t i = 0; i < row.contrast_p.size(); ++i) {
    if (significant(row.contrast_p[i], alpha) != significant(registered.contrast_p[i], alpha)) return false;
    if (significant(row.contrast_p[i], alpha) &&
        std::signbit(row.contrast_slope[i]) != std::signbit(registered.contrast_slope[i]))
      return false;
  }
  return true;
}

}  // namespace

std::vector<SensitivityRow> study_sensitivity(const StudyAnalysis& analysis, const Protocol& protocol) {
  std::vector<SensitivityRow> rows;
  for (const ThresholdMethod& method : all_methods(registered_method(protocol))) {
    rows.push_back(row_of(thresholds_under(analysis, protocol, method), protocol, method));
    rows.back().registered = rows.size() == 1;
    rows.back().same_conclusion = decides_alike(rows.back(), rows.front(), protocol.analysis.tests.alpha);
  }
  return rows;
}

}  // namespace jnd
