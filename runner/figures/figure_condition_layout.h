// Where everything of a condition figure stands, before anything is drawn. Used by figure_conditions.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure_conditions.h"

namespace jnd {

inline constexpr double kConditionsLeft = 74;  // of the panel: room for the y axis
inline constexpr std::string_view kOffTheScale = "off the scale";

// The lines below a condition's name: its label, where it says more.
std::vector<std::string> label_lines(const Condition& condition, double slot);

struct ConditionLayout {
  std::vector<LegendEntry> legend;
  double width = 0, height = 0;
  double slot = 0, label_lines = 0;         // of a column
  double strip_above = 0, strip_below = 0;  // heights of the edges' strips
  Panel panel;
  Scale scale;
  std::vector<EdgeCount> beyond;  // by column: values off the scale
};

ConditionLayout layout_of(const ConditionFigure& figure, const Protocol& protocol);

}  // namespace jnd
