// Would another model say something else? The median JND under each.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kNames = 440, kPlot = 320, kVerdict = 225, kSensitivityRow = 26;

std::string verdict_of(const SensitivityRow& row) {
  if (row.registered) return "registered";
  if (!row.refused.empty()) return "no test";
  return row.same_conclusion ? "same conclusion" : "other conclusion";
}

// Zero to the largest median, unless one lies far beyond the registered ones.
Range range_of(const std::vector<SensitivityRow>& rows) {
  double registered = 0, largest = 0;
  for (const SensitivityRow& row : rows)
    for (const TaskGroupRow& group : row.group)
      if (std::isfinite(group.median)) {
        largest = std::max(largest, group.median);
        if (row.registered) registered = std::max(registered, group.median);
      }
  const double high = registered > 0 ? std::min(largest, 4 * registered) : largest;
  return round_range(0, high > 0 ? high : 1, 6);
}

void draw_row(Svg& svg, const SensitivityRow& row, const Panel& panel, const Scale& x, double y) {
  if (row.registered) svg.rectangle(8, y - kSensitivityRow / 2, svg.width() - 16, kSensitivityRow, kBand);
  TextStyle name = anchored(kLabel, "end");
  name.bold = row.registered;
  name.size = 11;
  svg.text(panel.left - 10, y + 4, fitted(describe(row.method), name.size, kNames - 24), name);
  svg.line(panel.left, y, panel.right, y, kGrid);
  const int conditions = static_cast<int>(row.group.size());
  for (int condition = 0; condition < conditions; ++condition) {
    const double median = row.group[static_cast<std::size_t>(condition)].median;
    if (std::isnan(median)) continue;
    // Equal medians of two conditions stay apart.
    const double aside = conditions > 1 ? 8.0 * (condition / (conditions - 1.0) - 0.5) : 0;
    if (x.inside(median)) {
      draw_marker(svg, condition, x.at(median), y + aside, 4.2, condition_fill(condition));
    } else {
      svg.begin("edge");
      svg.polygon({{panel.right - 4, y + aside - 4}, {panel.right + 5, y + aside}, {panel.right - 4, y + aside + 4}},
                  condition_fill(condition));
      svg.end();
    }
  }
  TextStyle verdict = kMuted;
  verdict.bold = row.registered;
  std::string used;
  for (const TaskGroupRow& group : row.group) used += fmt::format("{}{}", used.empty() ? "" : "/", group.mean.n);
  svg.text(panel.right + 14, y + 4,
           fitted(fmt::format("{} of {}; {}", used, row.participants, verdict_of(row)), verdict.size, kVerdict - 16),
           verdict);
}

std::string description_of(const std::vector<SensitivityRow>& rows, const Protocol& protocol) {
  std::string text;
  for (const SensitivityRow& row : rows) {
    text += describe(row.method) + ": ";
    for (const TaskGroupRow& group : row.group)
      text += fmt::format("{} {}, ", condition_text(protocol, group.condition), size_text(group.median));
    text += verdict_of(row) + ". ";
  }
  return text;
}

}  // namespace

std::vector<Figure> sensitivity_figures(const StudyResults& results, const Protocol& protocol) {
  const std::vector<SensitivityRow>& rows = results.sensitivity;
  if (rows.empty()) return {};
  const std::string title = "Median JND under every model and method";
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < protocol.conditions.size(); ++i)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(i), condition_title(protocol.conditions[i])});
  const double width = kNames + kPlot + kVerdict;
  const double top = 8 + draw_legend(nullptr, legend, 0, 0, width - 20) + 8;
  const Panel panel{kNames, top, kNames + kPlot, top + kSensitivityRow * static_cast<double>(rows.size())};
  const Range range = range_of(rows);
  const Scale x{range.low, range.high, panel.left, panel.right};
  Svg svg("figure-sensitivity", width, panel.bottom + 48, title, description_of(rows, protocol));
  draw_legend(&svg, legend, 12, 8, width - 20);
  for (std::size_t i = 0; i < rows.size(); ++i)
    draw_row(svg, rows[i], panel, x, top + kSensitivityRow * (static_cast<double>(i) + 0.5));
  draw_x_axis(svg, panel, x, fmt::format("median JND ({})", unit_of(protocol)), 6);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  return {
      {"sensitivity", title,
       fmt::format(
           "The median counts participants without sensitivity as infinite (an arrow at the right edge, as "
           "is a median beyond the scale); at the ceiling there is none to draw. At the right: how many participants "
           "have a JND, by condition, and whether every registered test decides as under the registered "
           "method (alpha {:g}).",
           protocol.analysis.tests.alpha),
       svg}};
}

}  // namespace jnd
