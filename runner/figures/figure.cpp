#include "runner/figures/figure.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace jnd {

std::vector<FigurePage> figure_pages(std::string_view id, std::string_view title, std::size_t count,
                                     std::size_t per_page) {
  const std::size_t all = std::max<std::size_t>(1, (count + per_page - 1) / per_page);
  std::vector<FigurePage> pages;
  for (std::size_t page = 0; page < all; ++page)
    pages.push_back({all == 1 ? std::string(id) : fmt::format("{}-{}", id, page + 1),
                     all == 1 ? std::string(title) : fmt::format("{} ({} of {})", title, page + 1, all),
                     page * per_page, std::min(count, (page + 1) * per_page)});
  return pages;
}

std::string first_of(std::size_t shown, std::size_t everyone) {
  return shown < everyone ? fmt::format(" The first {} of {} participants.", shown, everyone) : "";
}

std::vector<Figure> study_figures(const StudyResults& results, const Protocol& protocol, const ShownPresses& presses) {
  std::vector<Figure> figures;
  const auto add = [&figures](std::vector<Figure> more) {
    for (Figure& figure : more) figures.push_back(std::move(figure));
  };
  for (const auto make :
       {jnd_figures, outcome_figures, contrast_figures, hierarchical_figures, ratio_figures, predictive_figures,
        curve_figures, parameter_figures, combination_figures, roc_figures, slope_figures, track_figures,
        raster_figures, behaviour_figures, time_figures, rating_figures, rating_bar_figures})
    add(make(results, protocol));
  add(press_figures(presses, protocol));
  add(sensitivity_figures(results, protocol));
  return figures;
}

}  // namespace jnd
