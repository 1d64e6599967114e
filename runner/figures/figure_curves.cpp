// The share of an answer over the levels, with the fitted curve: a panel for every condition and standard.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kCurveLeft = 62, kCurveWidth = 250, kCurveHeight = 170, kCurveGap = 46, kCurveTop = 30,
                 kCurveBottom = 56;
constexpr std::size_t kCurveColumns = 3;

Range levels_of(const TaskCurveRow& row) {
  double low = row.curve.points.front().x, high = row.curve.points.back().x;
  for (const double x : row.curve.x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  return round_range(low, high, 5);
}

void draw_curve(Svg& svg, const Panel& panel, const TaskCurveRow& row, const Protocol& protocol, bool y_title) {
  const Range levels = levels_of(row);
  const Scale x{levels.low, levels.high, panel.left, panel.right};
  const Scale y{0, 1, panel.bottom, panel.top};
  draw_grid_rows(svg, panel, y, 5);
  draw_y_axis(svg, panel, y, y_title ? "share" : "", 5);
  draw_x_axis(svg, panel, x, fmt::format("{} ({})", protocol.stimulus.quantity, unit_of(protocol)), 5);
  const Series& series = protocol.series[static_cast<std::size_t>(row.standard)];
  if (task_of(protocol.task.kind).has_standard() && x.inside(series.standard))
    svg.line(x.at(series.standard), panel.top, x.at(series.standard), panel.bottom, kRule);
  std::vector<SvgPoint> corners;
  for (std::size_t i = 0; i < row.curve.x.size(); ++i)
    corners.emplace_back(x.at(row.curve.x[i]), y.at(std::clamp(row.curve.fitted[i], 0.0, 1.0)));
  if (corners.size() > 1) svg.polyline(corners, condition_line(row.condition));
  for (const TaskCurve::Point& point : row.curve.points) {
    if (point.n == 0) continue;
    svg.begin("", fmt::format("{:g} {}: {} of {}", point.x, unit_of(protocol), point.said, point.n));
    draw_marker(svg, row.condition, x.at(point.x), y.at(static_cast<double>(point.said) / point.n), 3.5,
                condition_fill(row.condition));
    svg.end();
  }
  const std::string title = protocol.series.size() > 1
                                ? fmt::format("{}, {}", condition_name(protocol, row.condition), series.name)
                                : condition_name(protocol, row.condition);
  svg.text(panel.left, panel.top - 8, title, strong(kLabel));
}

// Panels in rows from the left.
Svg draw_curves(const std::vector<TaskCurveRow>& curves, const Protocol& protocol, const std::string& title,
                std::size_t most_columns) {
  const bool narrow = most_columns == 1;
  const std::size_t columns = std::min(most_columns, curves.size());
  const std::size_t rows = (curves.size() + columns - 1) / columns;
  const double step_x = kCurveWidth + kCurveGap, step_y = kCurveHeight + kCurveTop + kCurveBottom;
  Svg svg(narrow ? "figure-curves-narrow" : "figure-curves",
          std::max(narrow ? 0.0 : 420.0, kCurveLeft + static_cast<double>(columns) * step_x),
          static_cast<double>(rows) * step_y, title,
          "A panel for every condition and standard, all participants together.");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::size_t column = i % columns, row = i / columns;
    const double left = kCurveLeft + static_cast<double>(column) * step_x;
    const double top = kCurveTop + static_cast<double>(row) * step_y;
    draw_curve(svg, {left, top, left + kCurveWidth, top + kCurveHeight}, curves[i], protocol, column == 0);
  }
  return svg;
}

}  // namespace

std::vector<Figure> curve_figures(const StudyResults& results, const Protocol& protocol) {
  const std::vector<TaskCurveRow>& curves = results.task.curves;
  if (curves.empty()) return {};
  const std::string title = fmt::format("Share of \"{}\" over the levels", curves.front().curve.said);
  return {
      {"curves", title,
       "All participants together; the curve is fitted to the same answers (methods). The dashed line is the standard. "
       "Every participant's own estimates are in the table.",
       draw_curves(curves, protocol, title, kCurveColumns), draw_curves(curves, protocol, title, 1)}};
}

}  // namespace jnd
