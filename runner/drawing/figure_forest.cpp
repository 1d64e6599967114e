#include "runner/drawing/figure_forest.h"

#include <algorithm>
#include <cmath>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"

namespace jnd {

namespace {

constexpr double kForestTop = 14, kForestTitle = 18, kForestBelow = 52, kForestRight = 16;
constexpr int kForestTicks = 6;

// Where there is no difference.
double rule_of(const Forest& forest) {
  return forest.ratios ? 1 : 0;
}

Scale forest_scale(const Forest& forest, const std::vector<ForestRow>& rows, const Panel& panel) {
  double low = rule_of(forest), high = low;
  for (const ForestRow& row : rows)
    for (const double end : {row.value, row.low, row.high})
      if (std::isfinite(end) && (end > 0 || !forest.ratios)) {
        low = std::min(low, end);
        high = std::max(high, end);
      }
  const Range range = forest.ratios ? ratio_range(low, high) : round_range(low, high, kForestTicks);
  return {range.low, range.high, panel.left, panel.right, forest.ratios};
}

// An open end goes to the edge, without a cap.
void draw_forest_interval(Svg& svg, const Forest& forest, const ForestRow& row, const Scale& x, double y) {
  const bool any =
      forest.ratios ? !std::isnan(row.low) && !std::isnan(row.high) : std::isfinite(row.low) && std::isfinite(row.high);
  if (!any) return;
  const double end_height = row.of_group ? 5 : 3;
  const ShapeStyle& line = row.of_group ? kInk : kWithin;
  svg.line(x.clipped(row.low), y, x.clipped(row.high), y, line);
  for (const double end : {row.low, row.high})
    if (!forest.ratios || x.inside(end)) svg.line(x.clipped(end), y - end_height, x.clipped(end), y + end_height, line);
}

void draw_forest_row(Svg& svg, const Forest& forest, const ForestRow& row, bool named, const Panel& panel,
                     const Scale& x, double y) {
  if (named)
    svg.text(panel.left - 12, y + 4, fitted(row.name, kLabel.size, forest.names - 24), anchored(kLabel, "end"));
  if (forest.numbers > 0)
    svg.text(panel.right + 14, y + 4, fitted(row.numbers, kMuted.size, forest.numbers - 16), kMuted);
  svg.begin(std::isnan(row.value) ? "missing" : "mean", row.words);
  if (std::isnan(row.value)) {
    draw_cross(svg, x.at(rule_of(forest)), y, 4, kInk);
    return svg.end();
  }
  draw_forest_interval(svg, forest, row, x, y);
  svg.circle(x.at(row.value), y, row.of_group ? 4.5 : 3, kInkFill);
  svg.end();
}

void draw_forest_column(Svg& svg, const Forest& forest, const ForestColumn& column, bool named, const Panel& panel) {
  const Scale x = forest_scale(forest, column.rows, panel);
  draw_grid_columns(svg, panel, x, kForestTicks);
  draw_x_axis(svg, panel, x, column.x_title, kForestTicks);
  const double rule = x.at(rule_of(forest));
  svg.line(rule, panel.top, rule, panel.bottom, kRule);
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
