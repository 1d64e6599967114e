#include "runner/figures/figure_condition_layout.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kPanelHeight = 330, kStrip = 40;

// The upper end of the scale: everything, unless a few values would flatten the rest.
double upper_end(const ConditionFigure& figure) {
  std::vector<double> values;
  double wanted = 0, kept = 0;
  for (const ConditionColumn& column : figure.columns) {
    for (const PlottedPoint& point : column.points) values.push_back(point.value);
    if (column.mean) wanted = std::max(wanted, *column.mean);
    if (column.interval) wanted = std::max(wanted, column.interval->high);
    if (column.within) wanted = std::max(wanted, column.within->high);
    if (column.median) kept = std::max(kept, *column.median);
    if (column.published) kept = std::max(kept, *column.published + column.published_half_width.value_or(0));
  }
  if (values.empty()) return std::max({wanted, kept, 1.0});
  std::sort(values.begin(), values.end());
  const double third_quartile =
      values[(values.size() * 3) / 4 >= values.size() ? values.size() - 1 : (values.size() * 3) / 4];
  const double cap = std::max(3 * third_quartile, kept);
  return std::max(kept, std::min(std::max(wanted, values.back()), cap));
}

Range range_of(const ConditionFigure& figure) {
  if (figure.scale) return {figure.scale->first, figure.scale->second};
  double lowest = kInf;
  for (const ConditionColumn& column : figure.columns) {
    for (const PlottedPoint& point : column.points) lowest = std::min(lowest, point.value);
    if (column.interval) lowest = std::min(lowest, column.interval->low);
  }
  const double high = upper_end(figure);
  const double low = figure.from_zero || !std::isfinite(lowest) ? std::min(0.0, lowest) : lowest;
  // An interval's lower end below 0 is cut there: none of these quantities can be negative.
  return round_range(std::max(0.0, low), std::max(high, low + 1e-6), 6);
}

bool has_edge(const ConditionFigure& figure, bool above) {
  for (const ConditionColumn& column : figure.columns)
    for (const EdgeCount& edge : column.edges)
      if (edge.count > 0 && (edge.side == EdgeCount::Side::above) == above) return true;
  return false;
}

std::vector<LegendEntry> legend_of(const ConditionFigure& figure) {
  using Kind = LegendEntry::Kind;
  std::vector<LegendEntry> legend;
  if (figure.columns.empty()) return legend;
  const auto any = [&](auto has) { return std::any_of(figure.columns.begin(), figure.columns.end(), has); };
  legend.push_back({Kind::condition, figure.columns.front().condition, "one participant"});
  if (any([](const ConditionColumn& column) { return column.median.has_value(); }))
    legend.push_back({Kind::median, 0, "median"});
  if (any([](const ConditionColumn& column) { return column.mean.has_value(); }))
    legend.push_back({Kind::interval, 0, "mean, 95 % CI"});
  if (any([](const ConditionColumn& column) { return column.within.has_value(); }))
    legend.push_back({Kind::within, 0, "within-subject 95 % CI"});
  if (any([](const ConditionColumn& column) { return column.published.has_value(); }))
    legend.push_back({Kind::published, 0, "published"});
  return legend;
}

}  // namespace

std::vector<std::string> label_lines(const Condition& condition, double slot) {
  if (condition.label.empty() || condition.label == condition.name) return {};
  return wrapped(condition.label, kMuted.size, slot - 10, 3);
}

ConditionLayout layout_of(const ConditionFigure& figure, const Protocol& protocol) {
  ConditionLayout layout;
  const double columns = std::max<double>(1, static_cast<double>(figure.columns.size()));
  const double right = figure.right_factor > 0 ? 74 : 18;
  layout.width = std::max(460.0, kConditionsLeft + columns * std::clamp(600 / columns, 84.0, 190.0) + right);
  layout.legend = legend_of(figure);
  const double legend_height = draw_legend(nullptr, layout.legend, 0, 0, layout.width - kConditionsLeft - 10);
  const Range range = range_of(figure);
  bool any_beyond = false;
  for (const ConditionColumn& column : figure.columns) {
    EdgeCount beyond{EdgeCount::Side::above, 0, std::string(kOffTheScale)};
    for (const PlottedPoint& point : column.points) beyond.count += point.value > range.high ? 1 : 0;
    any_beyond = any_beyond || beyond.count > 0;
    layout.beyond.push_back(beyond);
  }
  layout.strip_above = any_beyond || has_edge(figure, true) ? kStrip : 0;
  layout.strip_below = has_edge(figure, false) ? kStrip : 0;
  const double top = 8 + legend_height + 6 + layout.strip_above;
  layout.panel = {kConditionsLeft, top, layout.width - right, top + kPanelHeight};
  layout.slot = layout.panel.width() / columns;
  layout.scale = {range.low, range.high, layout.panel.bottom, layout.panel.top};
  for (const ConditionColumn& column : figure.columns)
    layout.label_lines =
        std::max(layout.label_lines,
                 static_cast<double>(
                     label_lines(protocol.conditions[static_cast<std::size_t>(column.condition)], layout.slot).size()));
  layout.height = layout.panel.bottom + layout.strip_below + 18 + 15 * layout.label_lines + 28;
  return layout;
}

}  // namespace jnd
