// d' against the stiffness difference, with the line that the JND is read from.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "runner/figures/figure.h"
#include "runner/figures/figure_slope_panel.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr std::size_t kColumns = 6, kNarrowColumns = 2;
constexpr double kLeft = 62, kSlopePanelWidth = 138, kSlopePanelHeight = 112, kGapX = 14, kGapY = 34, kBottom = 52,
                 kLeastWidth = 480;

std::vector<LegendEntry> legend_of(const Protocol& protocol, const std::vector<SlopePanel>& panels) {
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(i), condition_title(protocol.conditions[i])});
  bool infinite = false, missing = false;
  for (const SlopePanel& panel : panels)
    for (const SlopeCurve& curve : panel.curves)
      for (const SlopePoint& point : curve.points) {
        infinite = infinite || std::isinf(point.dprime);
        missing = missing || std::isnan(point.dprime);
      }
  if (infinite) legend.push_back({LegendEntry::Kind::arrow, 0, "infinite d'"});
  if (missing) legend.push_back({LegendEntry::Kind::cross, 0, "no d'"});
  return legend;
}

// Panels in rows from the left, all with the same scales; axes at the left and below only.
Svg draw_grid(const std::vector<SlopePanel>& panels, const SlopeScales& scales, const Protocol& protocol,
              const std::string& id, const std::string& title, const std::string& description, double enlarged,
              bool narrow) {
  const double wide = kSlopePanelWidth * enlarged, high = kSlopePanelHeight * enlarged;
  const std::size_t most = narrow ? kNarrowColumns : kColumns;
  const std::size_t columns = std::min(enlarged > 1 ? most / 2 : most, panels.size());
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const double width = std::max(narrow ? 0.0 : kLeastWidth, kLeft + static_cast<double>(columns) * (wide + kGapX) + 4);
  const std::vector<LegendEntry> legend = legend_of(protocol, panels);
  const double top = 8 + draw_legend(nullptr, legend, 0, 0, width - kLeft - 10) + 24;
  const double bottom = top + static_cast<double>(rows) * (high + kGapY) - kGapY;
  Svg svg(fmt::format("figure-{}{}", id, narrow ? "-narrow" : ""), width, bottom + kBottom, title, description);
  draw_legend(&svg, legend, kLeft, 8, width - kLeft - 10);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const double left = kLeft + static_cast<double>(column) * (wide + kGapX);
    const double upper = top + static_cast<double>(row) * (high + kGapY);
    const bool lowest = i + columns >= panels.size();
    draw_slope_panel(svg, {left, upper, left + wide, upper + high}, panels[i], scales,
                     {.y_labels = column == 0, .x_labels = lowest, .points_named = enlarged == 1});
  }
  const double middle_x = kLeft + 0.5 * (static_cast<double>(columns) * (wide + kGapX) - kGapX);
  svg.text(middle_x, bottom + 42, fmt::format("stiffness difference ({})", unit_of(protocol)),
           anchored(kLabel, "middle"));
  TextStyle upwards = anchored(kLabel, "middle");
  upwards.upwards = true;
  svg.text(18, (top + bottom) / 2, fmt::format("d' ({} model)", protocol.analysis.model), upwards);
  return svg;
}

std::string caption_of(const StudyAnalysis& analysis, const Protocol& protocol, bool compact) {
  std::string text = fmt::format(
      "d' of every {} against the {} stiffness difference, with the fitted line through the origin ({}). {}",
      compact ? "participant and series" : "series", to_string(analysis.by), describe(analysis.method),
      is_maximum_likelihood(analysis.method.method)
          ? "The line is fitted to the answers, not to the points: a point is the d' of its series alone. "
          : "");
  text +=
      "Dashed: a line without a positive slope, which gives no JND. Points are moved a little sideways, so that they "
      "do "
      "not cover each other.";
  const bool raw = protocol.analysis.model == "differencing" || protocol.analysis.correction == "none";
  if (raw) text += " Arrows at the edges: infinite d' (a rate of 0 or 1).";
  return text;
}

std::vector<SlopePanel> by_condition(const std::vector<SlopePanel>& people, const Protocol& protocol) {
  std::vector<SlopePanel> panels;
  for (const Condition& condition : protocol.conditions)
    panels.push_back({fmt::format("{} (all participants)", condition.name), {}});
  for (const SlopePanel& person : people)
    for (const SlopeCurve& curve : person.curves)
      panels[static_cast<std::size_t>(curve.condition)].curves.push_back(curve);
  return panels;
}

}  // namespace

std::vector<Figure> slope_figures(const StudyResults& results, const Protocol& protocol) {
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  if (constant == nullptr) return {};
  const StudyAnalysis& analysis = constant->analysis;
  const std::vector<SlopePanel> people = slope_panels(analysis, protocol);
  if (people.empty()) return {};
  const SlopeScales scales = slope_scales(people);
  const std::string what = "d' against the stiffness difference";
  if (people.size() > kMostPeopleDrawn) {
    const std::string description = fmt::format(
        "{} participants, a panel for every condition, every participant's points and line.", people.size());
    return {{"slopes", what, caption_of(analysis, protocol, true),
             draw_grid(by_condition(people, protocol), scales, protocol, "slopes", what, description, 2, false),
             draw_grid(by_condition(people, protocol), scales, protocol, "slopes", what, description, 2, true)}};
  }
  std::vector<Figure> figures;
  for (const FigurePage& page : figure_pages("slopes", what, people.size(), kPeopleInFigure)) {
    const std::vector<SlopePanel> shown(people.begin() + static_cast<std::ptrdiff_t>(page.from),
                                        people.begin() + static_cast<std::ptrdiff_t>(page.to));
    const std::string description =
        fmt::format("One panel for every participant, from {} to {}.", shown.front().title, shown.back().title);
    figures.push_back({page.id, page.title, caption_of(analysis, protocol, false),
                       draw_grid(shown, scales, protocol, page.id, page.title, description, 1, false),
                       draw_grid(shown, scales, protocol, page.id, page.title, description, 1, true)});
  }
  return figures;
}

}  // namespace jnd
