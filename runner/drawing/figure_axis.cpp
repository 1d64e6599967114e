#include "runner/drawing/figure_axis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "runner/drawing/figure_style.h"
#include "runner/terminal/plot.h"

namespace jnd {

namespace {

constexpr double kTick = 4;
constexpr double kTickText = 11;

TextStyle tick_style(std::string_view anchor) {
  TextStyle style = anchored(kLabel, anchor);
  style.size = kTickText;
  return style;
}

double widest(const std::vector<std::string>& labels) {
  double width = 0;
  for (const std::string& label : labels) width = std::max(width, text_width(label, kTickText));
  return width;
}

// The fewest of 1, 3 / 1, 2, 5 / ... in every decade of which there are enough.
std::vector<double> ratio_ticks(double low, double high) {
  constexpr std::size_t kEnough = 4;
  const std::vector<std::vector<double>> ladders = {
      {1},
      {1, 3},
      {1, 2, 5},
      {1, 1.5, 2, 3, 5, 7},
      {1, 1.2, 1.4, 1.6, 1.8, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 9},
      {1,   1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2, 2.2, 2.4, 2.6, 2.8, 3,
       3.2, 3.4, 3.6, 3.8, 4,   4.5, 5,   5.5, 6,   6.5, 7, 7.5, 8,   8.5, 9,   9.5}};
  std::vector<double> ticks;
  const auto first = static_cast<int>(std::floor(std::log10(low))),
             last = static_cast<int>(std::floor(std::log10(high)));
  for (const std::vector<double>& ladder : ladders) {
    ticks.clear();
    for (int decade = first; decade <= last; ++decade)
      for (const double step : ladder)
        if (const double tick = step * std::pow(10, decade); tick >= low && tick <= high) ticks.push_back(tick);
    if (ticks.size() >= kEnough) break;
  }
  return ticks;
}

std::vector<std::string> labels_of(const Scale& scale, const std::vector<double>& ticks) {
  if (!scale.logarithmic) return tick_labels(ticks);
  std::vector<std::string> labels;
  for (const double tick : ticks) labels.push_back(fmt::format("{:.6g}", tick));
  return labels;
}

}  // namespace

double Scale::at(double value) const {
  const double share = logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return low_pixel + share * (high_pixel - low_pixel);
}

double Scale::clipped(double value) const {
  if (std::isnan(value)) throw std::logic_error("a figure has a value that is not a number");
  return at(std::clamp(value, low, high));
}

Range round_range(double low, double high, int wanted) {
  if (!std::isfinite(low) || !std::isfinite(high)) throw std::logic_error("an axis has no finite range");
  if (!(high > low)) {
    const double around = low == 0 ? 1 : 0.5 * std::abs(low);
    low -= around;
    high += around;
  }
  const std::vector<double> ticks = axis_ticks(low, high, wanted);
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : high - low;
  return {step * std::floor(low / step + 1e-9), step * std::ceil(high / step - 1e-9)};
}

Range ratio_range(double low, double high) {
  if (!(low > 0) || !std::isfinite(high)) throw std::logic_error("a logarithmic axis has no range above 0");
  constexpr double kRoom = 1.08;
  return {low / kRoom, high * kRoom};
}

std::vector<double> ticks_of(const Scale& scale, int wanted) {
  if (scale.logarithmic) return ratio_ticks(scale.low, scale.high);
  return axis_ticks(scale.low, scale.high, wanted);
}

std::vector<std::string> tick_labels(const std::vector<double>& ticks) {
  double largest = 0;
  for (const double tick : ticks) largest = std::max(largest, std::abs(tick));
  const double step = ticks.size() > 1 ? std::abs(ticks[1] - ticks[0]) : std::max(1.0, largest);
  std::vector<std::string> labels;
  if (largest >= 1e7 || step < 1e-6) {
    for (const double tick : ticks) labels.push_back(fmt::format("{:.3g}", std::abs(tick) < 1e-9 * step ? 0 : tick));
    return labels;
  }
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  for (const double tick : ticks) {
    const double value = std::abs(tick) < 1e-9 * step ? 0 : tick;
    std::string label = fmt::format("{:.{}f}", value, decimals);
    if (label.front() == '-') label.replace(0, 1, "−");
    labels.push_back(label);
  }
  return labels;
}

void draw_grid_rows(Svg& svg, const Panel& panel, const Scale& scale, int wanted) {
  for (const double tick : ticks_of(scale, wanted))
    svg.line(panel.left, scale.at(tick), panel.right, scale.at(tick), kGrid);
}

void draw_grid_columns(Svg& svg, const Panel& panel, const Scale& scale, int wanted) {
  for (const double tick : ticks_of(scale, wanted))
    svg.line(scale.at(tick), panel.top, scale.at(tick), panel.bottom, kGrid);
}

void draw_y_axis(Svg& svg, const Panel& panel, const Scale& scale, const std::string& title, int wanted) {
  const std::vector<double> ticks = ticks_of(scale, wanted);
  const std::vector<std::string> labels = labels_of(scale, ticks);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double y = scale.at(ticks[i]);
    svg.line(panel.left - kTick, y, panel.left, y, kFrame);
    svg.text(panel.left - kTick - 4, y + 4, labels[i], tick_style("end"));
  }
  if (title.empty()) return;
  TextStyle style = anchored(kLabel, "middle");
  style.upwards = true;
  svg.text(panel.left - kTick - 14 - widest(labels), (panel.top + panel.bottom) / 2, title, style);
}

void draw_x_axis(Svg& svg, const Panel& panel, const Scale& scale, const std::string& title, int wanted) {
  const std::vector<double> ticks = ticks_of(scale, wanted);
  const std::vector<std::string> labels = labels_of(scale, ticks);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double x = scale.at(ticks[i]);
    svg.line(x, panel.bottom, x, panel.bottom + kTick, kFrame);
    svg.text(x, panel.bottom + kTick + 12, labels[i], tick_style("middle"));
  }
  if (!title.empty())
    svg.text((panel.left + panel.right) / 2, panel.bottom + kTick + 30, title, anchored(kLabel, "middle"));
}

void draw_right_axis(Svg& svg, const Panel& panel, const Scale& scale, double factor, const std::string& suffix,
                     const std::string& title, int wanted) {
  Scale named = scale;
  named.low *= factor;
  named.high *= factor;
  const std::vector<double> ticks = ticks_of(named, wanted);
  std::vector<std::string> labels = labels_of(named, ticks);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    labels[i] += suffix;
    const double y = named.at(ticks[i]);
    svg.line(panel.right, y, panel.right + kTick, y, kFrame);
    svg.text(panel.right + kTick + 4, y + 4, labels[i], tick_style("start"));
  }
  TextStyle style = anchored(kLabel, "middle");
  style.upwards = true;
  svg.text(panel.right + kTick + 20 + widest(labels), (panel.top + panel.bottom) / 2, title, style);
}

}  // namespace jnd
