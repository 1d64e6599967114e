#include "runner/figures/figure.h"

#include <utility>

namespace jnd {

std::vector<Figure> study_figures(const StudyResults& results, const Protocol& protocol,
                                  const std::vector<PressedTrial>& presses) {
  std::vector<Figure> figures;
  const auto add = [&figures](std::vector<Figure> more) {
    for (Figure& figure : more) figures.push_back(std::move(figure));
  };
  for (const auto make : {jnd_figures, threshold_figures, task_figures, contrast_figures, parameter_figures,
                          combination_figures, curve_figures, slope_figures, roc_figures, track_figures, raster_figures,
                          behaviour_figures, time_figures, rating_figures, rating_bar_figures})
    add(make(results, protocol));
  add(press_figures(presses, protocol));
  add(sensitivity_figures(results, protocol));
  return figures;
}

}  // namespace jnd
