#include "runner/figures/figure_conditions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"

namespace jnd {

namespace {

constexpr double kConditionsLeft = 74;  // of the panel: room for the y axis
constexpr std::string_view kOffTheScale = "off the scale";

// Where everything stands, before anything is drawn.
struct ConditionLayout {
  std::vector<LegendEntry> legend;
  double width = 0, height = 0;
  double slot = 0, label_lines = 0;         // of a column
  double strip_above = 0, strip_below = 0;  // heights of the edges' strips
  Panel panel;
  Scale scale;
  std::vector<EdgeCount> beyond;  // by column: values off the scale
};

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

// The lines below a condition's name: its label, where it says more.
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

constexpr std::size_t kMostJoined = 40;  // participants

class Drawing {
 public:
  Drawing(const ConditionFigure& figure, const Protocol& protocol)
      : figure_(figure),
        protocol_(protocol),
        layout_(layout_of(figure, protocol)),
        panel_(layout_.panel),
        scale_(layout_.scale),
        slot_(layout_.slot),
        svg_("figure-" + figure.id, layout_.width, layout_.height, figure.title, figure.description) {}
  Svg finish();

 private:
  struct Placed {
    double x = 0, y = 0;
    const PlottedPoint* point = nullptr;
  };

  double centre(std::size_t column) const { return panel_.left + slot_ * (static_cast<double>(column) + 0.5); }
  double swarm_centre(std::size_t column) const { return centre(column) - 0.22 * slot_; }
  double swarm_half_width() const { return 0.17 * slot_; }
  const Condition& condition(const ConditionColumn& column) const {
    return protocol_.conditions[static_cast<std::size_t>(column.condition)];
  }
  double radius(std::size_t points) const { return points <= 30 ? 3.6 : points <= 100 ? 2.6 : 1.7; }
  std::vector<Placed> place_points(std::size_t place) const;
  void draw_points(std::size_t place, const std::vector<Placed>& points);
  void draw_joins(const std::vector<std::vector<Placed>>& placed);
  void draw_summary(std::size_t place);
  void draw_interval(double x, const PlottedInterval& interval, bool within);
  void draw_edges(std::size_t place, bool top);
  void draw_edge(const ConditionColumn& column, const EdgeCount& edge, double left, double width);
  void draw_foot(std::size_t place);
  void draw_axes();

  const ConditionFigure& figure_;
  const Protocol& protocol_;
  ConditionLayout layout_;
  Panel panel_;
  Scale scale_;
  double slot_;
  Svg svg_;
};

std::vector<Drawing::Placed> Drawing::place_points(std::size_t place) const {
  std::vector<double> heights;
  std::vector<Placed> placed;
  for (const PlottedPoint& point : figure_.columns[place].points)
    if (scale_.inside(point.value)) {
      heights.push_back(scale_.at(point.value));
      placed.push_back({0, heights.back(), &point});
    }
  const std::vector<double> offsets = swarm_offsets(heights, radius(heights.size()), swarm_half_width());
  for (std::size_t i = 0; i < placed.size(); ++i) placed[i].x = swarm_centre(place) + offsets[i];
  return placed;
}

void Drawing::draw_points(std::size_t place, const std::vector<Placed>& points) {
  const ConditionColumn& column = figure_.columns[place];
  ShapeStyle style = condition_fill(column.condition);
  style.opacity = 0.8;
  for (const Placed& placed : points) {
    svg_.begin("point", fmt::format("{}, {}: {:.{}f}{}", placed.point->participant, condition(column).name,
                                    placed.point->value, figure_.decimals, figure_.unit));
    draw_marker(svg_, column.condition, placed.x, placed.y, radius(points.size()), style);
    svg_.end();
  }
  if (!column.median || !scale_.inside(*column.median)) return;
  const double y = scale_.at(*column.median), wide = swarm_half_width() + 6;
  svg_.line(swarm_centre(place) - wide, y, swarm_centre(place) + wide, y, kMedian);
}

void Drawing::draw_joins(const std::vector<std::vector<Placed>>& placed) {
  if (!figure_.joined) return;
  std::map<std::string, std::vector<SvgPoint>> by_person;
  for (const std::vector<Placed>& column : placed)
    for (const Placed& one : column) by_person[one.point->participant].emplace_back(one.x, one.y);
  if (by_person.size() > kMostJoined) return;
  for (const auto& [person, points] : by_person)
    if (points.size() > 1) svg_.polyline(points, kFaint);
}

void Drawing::draw_interval(double x, const PlottedInterval& interval, bool within) {
  const ShapeStyle& style = within ? kWithin : kInk;
  const double cap = within ? 3.5 : 5;
  const double low = scale_.clipped(interval.low), high = scale_.clipped(interval.high);
  svg_.line(x, low, x, high, style);
  // No cap where the interval goes on beyond the scale.
  if (scale_.inside(interval.low)) svg_.line(x - cap, low, x + cap, low, style);
  if (scale_.inside(interval.high)) svg_.line(x - cap, high, x + cap, high, style);
}

void Drawing::draw_summary(std::size_t place) {
  const ConditionColumn& column = figure_.columns[place];
  const double x = centre(place) + 0.1 * slot_;
  if (column.interval) draw_interval(x, *column.interval, false);
  if (column.mean) {
    svg_.begin("mean",
               fmt::format("mean {}: {:.{}f}{}", condition(column).name, *column.mean, figure_.decimals, figure_.unit));
    if (scale_.inside(*column.mean))
      svg_.circle(x, scale_.at(*column.mean), 5, kInkFill);
    else
      draw_arrow(svg_, x, scale_.clipped(*column.mean) + (*column.mean > scale_.high ? 8 : -8), 5,
                 *column.mean > scale_.high, kInkFill);
    svg_.end();
  }
  if (column.within) draw_interval(centre(place) + 0.21 * slot_, *column.within, true);
  if (!column.published) return;
  std::optional<std::pair<double, double>> interval;
  if (column.published_half_width)
    interval = {scale_.clipped(*column.published - *column.published_half_width),
                scale_.clipped(*column.published + *column.published_half_width)};
  svg_.begin("published-value",
             fmt::format("published {}: {:g}{}", condition(column).name, *column.published, figure_.unit));
  draw_published(svg_, centre(place) + 0.34 * slot_, scale_.clipped(*column.published), interval);
  svg_.end();
}

void Drawing::draw_edge(const ConditionColumn& column, const EdgeCount& edge, double left, double width) {
  using Side = EdgeCount::Side;
  const bool top = edge.side == Side::above;
  const double middle = left + width / 2;
  const double marks_y = top ? panel_.top - 10 : panel_.bottom + 12;
  const double step = std::min(10.0, (width - 16) / std::max(1, edge.count - 1));
  svg_.begin("edge", fmt::format("{}: {} {}", condition(column).name, edge.count, edge.what));
  for (int i = 0; i < edge.count; ++i) {
    const double x = middle + step * (i - 0.5 * (edge.count - 1));
    if (edge.side == Side::none)
      draw_cross(svg_, x, marks_y, 4.5, condition_line(column.condition));
    else
      draw_arrow(svg_, x, marks_y, 4, top,
                 edge.what == kOffTheScale ? condition_fill(column.condition) : condition_hollow(column.condition));
  }
  svg_.end();
  const TextStyle style = anchored(kMuted, "middle");
  svg_.text(middle, top ? panel_.top - 23 : panel_.bottom + 32,
            fitted(fmt::format("{} {}", edge.count, edge.what), style.size, width - 2), style);
}

void Drawing::draw_edges(std::size_t place, bool top) {
  std::vector<EdgeCount> edges = figure_.columns[place].edges;
  edges.push_back(layout_.beyond[place]);
  std::erase_if(edges,
                [&](const EdgeCount& edge) { return edge.count == 0 || (edge.side == EdgeCount::Side::above) != top; });
  double left = centre(place) - slot_ / 2;
  const double part = slot_ / std::max<double>(1, static_cast<double>(edges.size()));
  for (const EdgeCount& edge : edges) {
    draw_edge(figure_.columns[place], edge, left, part);
    left += part;
  }
}

void Drawing::draw_foot(std::size_t place) {
  const ConditionColumn& column = figure_.columns[place];
  const Condition& named = condition(column);
  double y = panel_.bottom + layout_.strip_below + 18;
  TextStyle name = strong(anchored(kLabel, "middle"));
  name.size = 13;
  svg_.text(centre(place), y, fitted(named.name, name.size, slot_ - 8), name);
  const TextStyle muted = anchored(kMuted, "middle");
  svg_.text(centre(place), y += 16, fmt::format("n = {} of {}", column.points.size(), column.participants), muted);
  for (const std::string& line : label_lines(named, slot_)) svg_.text(centre(place), y += 15, line, muted);
}

void Drawing::draw_axes() {
  if (layout_.strip_above > 0)
    svg_.rectangle(panel_.left, panel_.top - layout_.strip_above, panel_.width(), layout_.strip_above, kBand);
  if (layout_.strip_below > 0) svg_.rectangle(panel_.left, panel_.bottom, panel_.width(), layout_.strip_below, kBand);
  draw_grid_rows(svg_, panel_, scale_, figure_.ticks);
  draw_y_axis(svg_, panel_, scale_, figure_.y_title, figure_.ticks);
  if (figure_.right_factor > 0)
    draw_right_axis(svg_, panel_, scale_, figure_.right_factor, " %", figure_.right_title, 6);
  svg_.rectangle(panel_.left, panel_.top, panel_.width(), panel_.height(), kFrame);
}

Svg Drawing::finish() {
  draw_legend(&svg_, layout_.legend, panel_.left, 8, layout_.width - kConditionsLeft - 10);
  draw_axes();
  std::vector<std::vector<Placed>> placed;
  for (std::size_t place = 0; place < figure_.columns.size(); ++place) placed.push_back(place_points(place));
  draw_joins(placed);
  for (std::size_t place = 0; place < figure_.columns.size(); ++place) {
    draw_points(place, placed[place]);
    draw_summary(place);
    draw_edges(place, true);
    draw_edges(place, false);
    draw_foot(place);
  }
  return svg_;
}

}  // namespace

Svg draw_condition_figure(const ConditionFigure& figure, const Protocol& protocol) {
  return Drawing(figure, protocol).finish();
}

// Where the points of a column go, so that every one can be seen.

namespace {

constexpr std::size_t kMostCompared = 2000;  // points a column; the search is quadratic

// Spread evenly over -1..1 whatever the number of points.
double golden_offset(std::size_t index) {
  const double share = std::fmod(0.5 + static_cast<double>(index) * 0.618033988749895, 1.0);
  return 2 * share - 1;
}

}  // namespace

std::vector<double> swarm_offsets(const std::vector<double>& heights, double radius, double half_width) {
  std::vector<std::size_t> order(heights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return heights[a] < heights[b]; });
  std::vector<double> offsets(heights.size(), 0);
  const double apart = 2 * radius + 0.6, step = radius / 2;
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t here = order[place];
    const auto is_free = [&](double offset) {
      for (std::size_t back = place; back-- > 0;) {
        const std::size_t other = order[back];
        const double down = heights[here] - heights[other];
        if (down >= apart) return true;
        if (std::hypot(down, offset - offsets[other]) < apart) return false;
      }
      return true;
    };
    bool placed = false;
    if (heights.size() <= kMostCompared)
      for (int tried = 0; !placed; ++tried) {
        // Alternately to the right and to the left, the first side alternating too.
        const int steps = (tried + 1) / 2;
        const double out = step * steps;
        if (out > half_width) break;
        const double offset = (tried % 2 == 0) == (place % 2 == 0) ? out : -out;
        if (!is_free(offset)) continue;
        offsets[here] = offset;
        placed = true;
      }
    if (!placed) offsets[here] = half_width * golden_offset(place);
  }
  return offsets;
}

}  // namespace jnd
