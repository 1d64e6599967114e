// Axes of figures: values to pixels, round ticks, labels. The ticks of linear ones are those of the terminal's plots
// (plot.h).
#pragma once

#include <string>
#include <vector>

#include "runner/drawing/svg.h"

namespace jnd {

// From values to pixels. For a y axis low_pixel is below high_pixel on the page, so greater.
struct Scale {
  double low = 0, high = 1;  // low < high, finite
  double low_pixel = 0, high_pixel = 1;
  bool logarithmic = false;  // with low > 0: equal ratios are equally far apart; of values > 0
  double at(double value) const;
  // Not beyond the ends. Infinities go to them; NaN is the caller's to keep away.
  double clipped(double value) const;
  bool inside(double value) const { return value >= low && value <= high; }
};

// low..high widened to whole ticks of about `wanted` steps, so that no mark lies on the frame. low = high gets a range
// around it. Both must be finite.
struct Range {
  double low = 0, high = 1;
};
Range round_range(double low, double high, int wanted);

// A little more than low..high, 0 < low <= high, for a logarithmic scale.
Range ratio_range(double low, double high);

// Of a logarithmic scale about as many as its decades need, whatever is wanted.
std::vector<double> ticks_of(const Scale& scale, int wanted);
// All of them with as many decimals as the finest one needs.
std::vector<std::string> tick_labels(const std::vector<double>& ticks);

// The rectangle that data are drawn in.
struct Panel {
  double left = 0, top = 0, right = 0, bottom = 0;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};

// Grid lines across the panel at the ticks of its y scale, and of its x scale.
void draw_grid_rows(Svg& svg, const Panel& panel, const Scale& scale, int wanted);
void draw_grid_columns(Svg& svg, const Panel& panel, const Scale& scale, int wanted);
// Ticks and their labels at the left of the panel; title upwards beside them, where not empty.
void draw_y_axis(Svg& svg, const Panel& panel, const Scale& scale, const std::string& title, int wanted);
// The same below the panel.
void draw_x_axis(Svg& svg, const Panel& panel, const Scale& scale, const std::string& title, int wanted);
// Ticks and labels at the right: the same places under another name, value * factor + suffix (" %").
void draw_right_axis(Svg& svg, const Panel& panel, const Scale& scale, double factor, const std::string& suffix,
                     const std::string& title, int wanted);

}  // namespace jnd
