#include "data/results/study_models.h"

namespace jnd {

std::vector<SeriesCounts> series_of_threshold(const StudyAnalysis& analysis, const Protocol& protocol,
                                              std::size_t row) {
  const std::size_t series = protocol.series.size();
  std::vector<SeriesCounts> counts;
  for (std::size_t i = row * series; i < (row + 1) * series; ++i)
    counts.push_back({analysis.cells[i].difference, analysis.cells[i].counts});
  return counts;
}

StudyModels study_models(const StudyAnalysis& analysis, const Protocol& protocol) {
  StudyModels models;
  const std::vector<ThresholdMethod> methods = all_methods(analysis.method);
  for (std::size_t row = 0; row < analysis.thresholds.size(); ++row) {
    const std::vector<SeriesCounts> series = series_of_threshold(analysis, protocol, row);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const ThresholdMethod& method = methods[i];
      ThresholdModel model{analysis.thresholds[row].participant, analysis.thresholds[row].condition, method, {}, {}};
      model.group = analysis.thresholds[row].group;
      // The registered estimate carries its interval already.
      model.jnd = i == 0 ? analysis.thresholds[row].jnd
                         : estimate_jnd(series, protocol.stimulus.reference, method.method, method.correction);
      if (is_maximum_likelihood(method.method)) model.quality = fit_quality(series, method.method, 0, 1);
      models.thresholds.push_back(std::move(model));
    }
  }
  for (const CellResult& cell : analysis.cells)
    models.cells.push_back({cell.participant, cell.condition, cell.series, detection_row(cell.counts)});
  return models;
}

}  // namespace jnd
