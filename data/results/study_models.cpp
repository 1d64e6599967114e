#include "data/results/study_models.h"

namespace jnd {

StudyModels study_models(const TaskResults& results, const Protocol& protocol) {
  StudyModels models;
  if (results.cells.empty()) return models;
  const std::vector<ThresholdMethod> methods = all_methods(results.pairs.method);
  for (std::size_t row = 0; row < results.estimates.size(); ++row) {
    const std::vector<SeriesCounts> series = series_of(results, protocol, row);
    const TaskEstimateRow& of = results.estimates[row];
    for (const ThresholdMethod& method : methods) {
      ThresholdModel& model = models.thresholds.emplace_back();
      model.participant = of.participant;
      model.condition = of.condition;
      model.group = of.group;
      model.method = method;
      model.jnd = estimate_jnd(series, protocol.stimulus.reference, method.method, method.correction);
      if (is_maximum_likelihood(method.method)) model.quality = fit_quality(series, method.method, 0, 1);
      if (&method != &methods.front()) continue;
      const TaskEstimate& registered = of.estimates.values[1];  // which carries an interval of its own
      model.jnd.ci_low = registered.low.value_or(kNaN);
      model.jnd.ci_high = registered.high.value_or(kNaN);
    }
  }
  for (const CellResult& cell : results.cells)
    models.cells.push_back({cell.participant, cell.condition, cell.series, detection_row(cell.counts)});
  return models;
}

}  // namespace jnd
