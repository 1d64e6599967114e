// The axes of text pictures: where their ticks are, and how they are written. Used by plot.cpp and heat_map.cpp only.
// Pure functions.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "runner/terminal/plot.h"

namespace jnd {

inline constexpr int kNarrowestPlot = 40, kWidestPlot = 100;  // columns

// Low to high, in the axis's own scale.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  double scaled(double value) const { return logarithmic ? std::log10(value) : value; }
  // 0..1 from low to high.
  double share(double value) const { return (scaled(value) - scaled(low)) / (scaled(high) - scaled(low)); }
};

// The character or dot, of `count` in a row, that a share of the row falls on.
inline int place(double share, int count) {
  return std::clamp(static_cast<int>(std::lround(share * (count - 1))), 0, count - 1);
}

std::vector<double> ticks_of(const Axis& axis, int wanted);
std::string tick_text(double value, double step);

std::string padded_left(const std::string& text, std::size_t width);
// Ended by a newline.
std::string centred_under(const std::string& label, std::size_t gutter, int columns);

// The labels of an x axis under their ticks; one that would touch its neighbour is left out.
struct XAxisText {
  std::string rule, labels;
};
XAxisText x_axis(const Axis& axis, int columns, bool unicode);

}  // namespace jnd
