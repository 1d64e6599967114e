#include "runner/drawing/figure_forest.h"

#include <algorithm>
#include <cmath>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"

namespace jnd {

namespace {

constexpr double kForestTop = 14, kForestTitle = 18, kForestBelow = 52, kForestRight = 16;
constexpr int kForestTicks = 6;

Range forest_range(const std::vector<ForestRow>& rows) {
  double low = 0, high = 0;
  for (const ForestRow& row : rows)
    for (const double end : {row.value, row.low, row.high})
      if (std::isfinite(end)) {
        low = std::min(low, end);
        high = std::max(high, end);
      }
  return round_range(low, high, kForestTicks);
}

void draw_forest_row(Svg& svg, const Forest& forest, const ForestRow& row, bool named, const Panel& panel,
                     const Scale& x, double y) {
  if (named)
    svg.text(panel.left - 12, y + 4, fitted(row.name, kLabel.size, forest.names - 24), anchored(kLabel, "end"));
  if (forest.numbers > 0)
    svg.text(panel.right + 14, y + 4, fitted(row.numbers, kMuted.size, forest.numbers - 16), kMuted);
  svg.begin(std::isnan(row.value) ? "missing" : "mean", row.words);
  if (std::isnan(row.value)) {
    draw_cross(svg, x.at(0), y, 4, kInk);
    return svg.end();
  }
  if (std::isfinite(row.low) && std::isfinite(row.high)) {
    const double from = x.at(row.low), to = x.at(row.high), end_height = row.of_group ? 5 : 3;
    const ShapeStyle& line = row.of_group ? kInk : kWithin;
    svg.line(from, y, to, y, line);
    for (const double end : {from, to}) svg.line(end, y - end_height, end, y + end_height, line);
  }
  svg.circle(x.at(row.value), y, row.of_group ? 4.5 : 3, kInkFill);
  svg.end();
}

void draw_forest_column(Svg& svg, const Forest& forest, const ForestColumn& column, bool named, const Panel& panel) {
  const Range range = forest_range(column.rows);
  const Scale x{range.low, range.high, panel.left, panel.right};
  draw_grid_columns(svg, panel, x, kForestTicks);
  draw_x_axis(svg, panel, x, column.x_title, kForestTicks);
  svg.line(x.at(0), panel.top, x.at(0), panel.bottom, kRule);
  if (!column.title.empty()) svg.text(panel.left, panel.top - 8, column.title, strong(kLabel));
  for (std::size_t i = 0; i < column.rows.size(); ++i)
    draw_forest_row(svg, forest, column.rows[i], named, panel, x,
                    panel.top + forest.row * (static_cast<double>(i) + 0.5));
}

}  // namespace

Svg draw_forest(const Forest& forest, bool side_by_side) {
  const double above = kForestTop + (forest.columns.front().title.empty() ? 0 : kForestTitle);
  const double rows = forest.row * static_cast<double>(forest.columns.front().rows.size());
  const double step_x = forest.plot + forest.numbers + forest.between, step_y = above + rows + kForestBelow;
  const double count = static_cast<double>(forest.columns.size());
  Svg svg(side_by_side ? forest.id : forest.id + "-narrow",
          forest.names + (side_by_side ? count : 1) * step_x - forest.between + kForestRight,
          (side_by_side ? 1 : count) * step_y, forest.title, forest.description);
  for (std::size_t i = 0; i < forest.columns.size(); ++i) {
    const double place = static_cast<double>(i);
    const double left = forest.names + (side_by_side ? place * step_x : 0);
    const double top = above + (side_by_side ? 0 : place * step_y);
    draw_forest_column(svg, forest, forest.columns[i], i == 0 || !side_by_side,
                       {left, top, left + forest.plot, top + rows});
  }
  return svg;
}

}  // namespace jnd
