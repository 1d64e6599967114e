#include "runner/figures/figure_conditions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "runner/figures/figure_condition_layout.h"

namespace jnd {

namespace {

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
