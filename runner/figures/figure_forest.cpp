#include "runner/figures/figure_forest.h"

#include <algorithm>
#include <cmath>

#include "runner/figures/figure_axis.h"
#include "runner/figures/figure_style.h"

namespace jnd {

namespace {

constexpr double kForestPlot = 380, kForestTop = 14, kForestBelow = 52;

Range forest_range(const std::vector<ForestRow>& rows) {
  double low = 0, high = 0;
  for (const ForestRow& row : rows)
    for (const double end : {row.value, row.low, row.high})
      if (std::isfinite(end)) {
        low = std::min(low, end);
        high = std::max(high, end);
      }
  return round_range(low, high, 6);
}

void draw_forest_row(Svg& svg, const Forest& forest, const ForestRow& row, const Panel& panel, const Scale& x,
                     double y) {
  svg.text(panel.left - 12, y + 4, fitted(row.name, kLabel.size, forest.names - 24), anchored(kLabel, "end"));
  svg.text(panel.right + 14, y + 4, fitted(row.numbers, kMuted.size, forest.numbers - 16), kMuted);
  if (std::isnan(row.value)) return draw_cross(svg, x.at(0), y, 4, kInk);
  svg.begin("mean", row.words);
  if (std::isfinite(row.low) && std::isfinite(row.high)) {
    const double from = x.at(row.low), to = x.at(row.high), end_height = row.of_group ? 5 : 3;
    const ShapeStyle& line = row.of_group ? kInk : kWithin;
    svg.line(from, y, to, y, line);
    for (const double end : {from, to}) svg.line(end, y - end_height, end, y + end_height, line);
  }
  svg.circle(x.at(row.value), y, row.of_group ? 4.5 : 3, kInkFill);
  svg.end();
}

}  // namespace

Svg draw_forest(const Forest& forest) {
  const double height = forest.row * static_cast<double>(forest.rows.size());
  const Panel panel{forest.names, kForestTop, forest.names + kForestPlot, kForestTop + height};
  const Range range = forest_range(forest.rows);
  const Scale x{range.low, range.high, panel.left, panel.right};
  Svg svg(forest.id, forest.names + kForestPlot + forest.numbers, panel.bottom + kForestBelow, forest.title,
          forest.description);
  draw_grid_columns(svg, panel, x, 6);
  draw_x_axis(svg, panel, x, forest.x_title, 6);
  svg.line(x.at(0), panel.top, x.at(0), panel.bottom, kRule);
  for (std::size_t i = 0; i < forest.rows.size(); ++i)
    draw_forest_row(svg, forest, forest.rows[i], panel, x, panel.top + forest.row * (static_cast<double>(i) + 0.5));
  return svg;
}

}  // namespace jnd
