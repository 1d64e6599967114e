#include "data/results/study_sensitivity.h"

#include <cmath>

#include "analysis/numerics/special_values.h"
#include "data/results/study_comparisons.h"

namespace jnd {

namespace {

// The same cells under another method.
TaskResults results_under(const TaskResults& results, const Protocol& protocol, const ThresholdMethod& method) {
  TaskResults other = empty_task_results(protocol);
  for (std::size_t row = 0; row < results.estimates.size(); ++row) {
    const TaskEstimateRow& of = results.estimates[row];
    TaskEstimateRow& one = other.estimates.emplace_back();
    one.participant = of.participant;
    one.condition = of.condition;
    one.group = of.group;
    one.estimates = estimates_of(
        estimate_jnd(series_of(results, protocol, row), protocol.stimulus.reference, method.method, method.correction),
        protocol.stimulus.reference);
  }
  add_group(other, protocol);
  return other;
}

SensitivityRow row_of(TaskResults results, const Protocol& protocol, const ThresholdMethod& method) {
  SensitivityRow row;
  row.method = method;
  const std::size_t conditions = protocol.conditions.size();
  row.participants = static_cast<int>(by_participant(results.estimates, conditions).size());
  const OutcomeComparison outcome = compare_task(results, protocol);
  for (TaskGroupRow& of : results.group)
    if (results.outcomes[of.outcome].key == "jnd") row.group.push_back(std::move(of));
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

std::vector<SensitivityRow> study_sensitivity(const TaskResults& results, const Protocol& protocol) {
  std::vector<SensitivityRow> rows;
  for (const ThresholdMethod& method : all_methods(registered_method(protocol))) {
    rows.push_back(row_of(results_under(results, protocol, method), protocol, method));
    rows.back().registered = rows.size() == 1;
    rows.back().same_conclusion = decides_alike(rows.back(), rows.front(), protocol.analysis.tests.alpha);
  }
  return rows;
}

}  // namespace jnd
