// One picture for everything that has a value for every participant and condition: all points, the mean with its
// intervals, the median, published values, and counted marks at the edges for who has no value. For quantities that are
// never negative.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/group/group.h"
#include "protocols/protocol.h"
#include "runner/drawing/svg.h"

namespace jnd {

struct PlottedInterval {
  double mean = 0, low = 0, high = 0;  // all finite, or the interval is not given
};

struct PlottedPoint {
  double value = 0;         // finite, >= 0
  std::string participant;  // whose it is: points of one participant are joined
};

// Who has no value, and why.
struct EdgeCount {
  enum class Side { above, below, none } side = Side::none;  // beyond the scale, or nowhere
  int count = 0;
  std::string what;  // "no sensitivity"
};

struct ConditionColumn {
  int condition = 0;  // place in Protocol::conditions
  std::vector<PlottedPoint> points;
  std::vector<EdgeCount> edges;  // entries with count 0 are not drawn
  int participants = 0;          // everyone, with a value or not
  std::optional<double> mean;
  std::optional<PlottedInterval> interval;  // 95 % of the mean
  std::optional<PlottedInterval> within;    // 95 %, Cousineau-Morey
  std::optional<double> median;             // finite
  std::optional<double> published;
  std::optional<double> published_half_width;
};

struct ConditionFigure {
  std::string id, title, description;
  std::string y_title;                             // with its unit
  std::string unit;                                // after the values in tooltips
  int decimals = 1;                                // of tooltips
  std::optional<std::pair<double, double>> scale;  // of ratings; without it what the values need
  int ticks = 6;                                   // about
  bool from_zero = true;                           // without a scale: whether it begins at 0
  double right_factor = 0;                         // of a second scale, in percent; 0: none
  std::string right_title;
  bool joined = false;  // points of one participant, where they are few enough
  std::vector<ConditionColumn> columns;
};

// Values far beyond the others (three times the third quartile) do not flatten the picture: they stand at the upper
// edge as arrows, counted.
Svg draw_condition_figure(const ConditionFigure& figure, const Protocol& protocol);

// Sideways offsets of points at these heights (pixels), so that circles of this radius do not cover each other as far
// as
// +-half_width allows; beyond that they lie close. Deterministic.
std::vector<double> swarm_offsets(const std::vector<double>& heights, double radius, double half_width);

}  // namespace jnd
