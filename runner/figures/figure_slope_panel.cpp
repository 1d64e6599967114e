#include "runner/figures/figure_slope_panel.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/detection/differencing.h"
#include "analysis/detection/independent_observation.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

double dprime_of(const CellResult& cell, const Protocol& protocol) {
  if (protocol.analysis.model == "differencing") return differencing_fit(cell.counts).dprime;
  if (protocol.analysis.model == "independent-observation") return unit_slope_dprime(cell.yes_no.dprime);
  return cell.yes_no.dprime;
}

std::string words_of(const CellResult& cell, double dprime, const Protocol& protocol) {
  return fmt::format("{}, {}, {} {}: d' {}, hits {} of {}, false alarms {} of {}", cell.participant,
                     condition_text(protocol, cell.condition), stiffness_text(cell.difference, protocol),
                     unit_of(protocol), number_text(dprime, 2), cell.counts.hits, cell.counts.n_diff,
                     cell.counts.false_alarms, cell.counts.n_same);
}

std::string undefined_of(const SlopePanel& panel, const Protocol& protocol) {
  std::string undefined;
  for (const JndStatus status : {JndStatus::no_sensitivity, JndStatus::ceiling, JndStatus::no_information}) {
    std::string names;
    std::size_t count = 0;
    for (const SlopeCurve& curve : panel.curves)
      if (curve.status == status) {
        names = joined(names, condition_text(protocol, curve.condition));
        ++count;
      }
    if (count == 0) continue;
    const std::string_view what = to_string(status);
    undefined = joined(undefined, count == panel.curves.size() ? std::string(what) : fmt::format("{} {}", names, what));
  }
  return undefined;
}

// Where the line through the origin leaves the panel.
SvgPoint line_end(double slope, const Scale& x, const Scale& y) {
  if (std::isinf(slope)) return {x.at(0), slope > 0 ? y.high_pixel : y.low_pixel};
  const double at_right = slope * x.high;
  if (y.inside(at_right)) return {x.at(x.high), y.at(at_right)};
  const double edge = at_right > 0 ? y.high : y.low;
  return {x.at(edge / slope), y.at(edge)};
}

void draw_point(Svg& svg, const SlopePoint& point, int condition, double x, const Scale& y, double radius) {
  if (std::isnan(point.dprime)) return draw_cross(svg, x, y.low_pixel - 5, 4, condition_line(condition));
  const bool up = point.dprime > 0;
  if (std::isinf(point.dprime))
    return draw_arrow(svg, x, up ? y.high_pixel + 6 : y.low_pixel - 6, 3.6, up, condition_fill(condition));
  draw_marker(svg, condition, x, y.at(point.dprime), radius, condition_fill(condition));
}

}  // namespace

std::vector<SlopePanel> slope_panels(const StudyAnalysis& analysis, const Protocol& protocol) {
  const std::size_t series = protocol.series.size();
  std::vector<SlopePanel> panels;
  for (std::size_t i = 0; i < analysis.thresholds.size(); ++i) {
    const ThresholdResult& row = analysis.thresholds[i];
    if (i == 0 || analysis.thresholds[i - 1].participant != row.participant) panels.push_back({row.participant, {}});
    SlopeCurve curve{row.condition, {}, row.jnd.slope, row.jnd.status};
    for (std::size_t place = i * series; place < (i + 1) * series && place < analysis.cells.size(); ++place) {
      const CellResult& cell = analysis.cells[place];
      const double dprime = dprime_of(cell, protocol);
      curve.points.push_back({cell.difference, dprime, words_of(cell, dprime, protocol)});
    }
    panels.back().curves.push_back(std::move(curve));
  }
  for (SlopePanel& panel : panels) panel.undefined = undefined_of(panel, protocol);
  return panels;
}

SlopeScales slope_scales(const std::vector<SlopePanel>& panels) {
  double furthest = 0, low = 0, high = 1;
  int conditions = 1;
  for (const SlopePanel& panel : panels)
    for (const SlopeCurve& curve : panel.curves) {
      conditions = std::max(conditions, curve.condition + 1);
      for (const SlopePoint& point : curve.points) {
        furthest = std::max(furthest, point.difference);
        if (!std::isfinite(point.dprime)) continue;
        low = std::min(low, point.dprime);
        high = std::max(high, point.dprime);
      }
    }
  SlopeScales scales;
  scales.difference = {0, furthest > 0 ? 1.12 * furthest : 1};
  const double room = 0.06 * (high - low);
  scales.dprime = {low < 0 ? low - room : 0, high + room};
  scales.conditions = conditions;
  return scales;
}

void draw_slope_panel(Svg& svg, const Panel& panel, const SlopePanel& content, const SlopeScales& scales,
                      const PanelParts& parts) {
  const Scale x{scales.difference.low, scales.difference.high, panel.left, panel.right};
  const Scale y{scales.dprime.low, scales.dprime.high, panel.bottom, panel.top};
  svg.begin("panel");
  draw_grid_rows(svg, panel, y, 4);
  draw_grid_columns(svg, panel, x, 4);
  if (parts.y_labels) draw_y_axis(svg, panel, y, {}, 4);
  if (parts.x_labels) draw_x_axis(svg, panel, x, {}, 4);
  svg.line(panel.left, y.at(0), panel.right, y.at(0), kRule);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  const double radius = content.curves.size() > 60 ? 1.8 : parts.points_named ? 3.1 : 2.4;
  for (const SlopeCurve& curve : content.curves) {
    if (std::isnan(curve.slope)) continue;
    ShapeStyle style = condition_line(curve.condition);
    if (curve.status == JndStatus::no_sensitivity) style.dash = "4 3";
    if (!parts.points_named) {
      style.stroke_width = 0.7;
      style.opacity = 0.45;
    }
    const auto [end_x, end_y] = line_end(curve.slope, x, y);
    svg.line(x.at(0), y.at(0), end_x, end_y, style);
  }
  int person = 0;
  for (const SlopeCurve& curve : content.curves) {
    // In a panel of one participant the conditions stand apart, in one of a condition the participants.
    const double aside = parts.points_named ? 5.0 * (curve.condition - 0.5 * (scales.conditions - 1))
                                            : 9.0 * (2 * std::fmod(0.618033988749895 * ++person, 1.0) - 1);
    for (const SlopePoint& point : curve.points) {
      const double at = std::clamp(x.at(point.difference) + aside, panel.left + 4, panel.right - 4);
      if (parts.points_named) svg.begin("point", point.words);
      draw_point(svg, point, curve.condition, at, y, radius);
      if (parts.points_named) svg.end();
    }
  }
  svg.text(panel.left, panel.top - 6, fitted(content.title, kLabel.size, panel.width()), strong(kLabel));
  const double used = text_width(content.title, kLabel.size) * 1.1 + 8;
  if (!content.undefined.empty() && used < panel.width() - 30) {
    TextStyle style = anchored(kMuted, "end");
    style.size = 9.5;
    svg.text(panel.right, panel.top - 6, fitted(content.undefined, style.size, panel.width() - used), style);
  }
  svg.end();
}

}  // namespace jnd
