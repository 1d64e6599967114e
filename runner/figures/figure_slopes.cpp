// d' against the stiffness difference, with the line that the JND is read from.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "analysis/detection/differencing.h"
#include "analysis/detection/independent_observation.h"
#include "analysis/numerics/special_values.h"
#include "data/blocks/common_fields.h"
#include "protocols/protocol.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

struct SlopePoint {
  double difference = 0;  // > 0, in the study's unit
  double dprime = 0;      // of the registered model; infinite at a rate of 0 or 1, NaN where a class is missing
  std::string words;      // tooltip
};

// One participant under one condition.
struct SlopeCurve {
  int condition = 0;
  std::vector<SlopePoint> points;
  double slope = 0;  // NaN: no line; inf at the ceiling
  std::string status = "ok";
};

struct SlopePanel {
  std::string title;  // the participant
  std::vector<SlopeCurve> curves;
  std::string undefined = {};  // who has no JND: "V no_sensitivity"
};

struct SlopeScales {
  Range difference, dprime;
  int conditions = 1;  // among which points are moved sideways
};

struct PanelParts {
  bool y_labels = true, x_labels = true, points_named = true;
};

double dprime_of(const CellResult& cell, const Protocol& protocol) {
  if (protocol.analysis.model == "differencing") return differencing_fit(cell.counts).dprime;
  if (protocol.analysis.model == "independent-observation") return unit_slope_dprime(cell.yes_no.dprime);
  return cell.yes_no.dprime;
}

std::string words_of(const CellResult& cell, double dprime, const Protocol& protocol) {
  return fmt::format("{}, {}, {} {}: d' {}, hits {} of {}, false alarms {} of {}", cell.participant,
                     condition_text(protocol, cell.condition), size_text(cell.difference), unit_of(protocol),
                     number_text(dprime, 2), cell.counts.hits, cell.counts.n_diff, cell.counts.false_alarms,
                     cell.counts.n_same);
}

std::string undefined_of(const SlopePanel& panel, const Protocol& protocol) {
  std::string undefined;
  for (const std::string_view what : {"no_sensitivity", "ceiling", "no_information"}) {
    std::string names;
    std::size_t count = 0;
    for (const SlopeCurve& curve : panel.curves)
      if (curve.status == what) {
        names = joined(names, condition_text(protocol, curve.condition));
        ++count;
      }
    if (count == 0) continue;
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

// One for each participant, in the analysis's order.
std::vector<SlopePanel> slope_panels(const TaskResults& analysis, const Protocol& protocol) {
  const std::size_t series = protocol.series.size();
  std::vector<SlopePanel> panels;
  for (std::size_t i = 0; i < analysis.estimates.size(); ++i) {
    const TaskEstimateRow& row = analysis.estimates[i];
    if (i == 0 || analysis.estimates[i - 1].participant != row.participant) panels.push_back({row.participant, {}});
    SlopeCurve curve{row.condition, {}, row.estimates.values.front().value.value_or(kNaN), row.estimates.status};
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
    if (curve.status == "no_sensitivity") style.dash = "4 3";
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

std::string caption_of(const TaskResults& analysis, const Protocol& protocol, bool compact) {
  std::string text = fmt::format(
      "d' of every {} against the {} stiffness difference, with the fitted line through the origin ({}). {}",
      compact ? "participant and series" : "series", to_string(analysis.pairs.by), describe(analysis.pairs.method),
      is_maximum_likelihood(analysis.pairs.method.method)
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
  if (results.task.cells.empty()) return {};
  const TaskResults& analysis = results.task;
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
