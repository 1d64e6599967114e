#include "runner/screen/force_pane.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "runner/screen/screen_text.h"
#include "runner/terminal/plot.h"
#include "runner/words/words.h"

namespace jnd {

namespace {

constexpr double kMillimetres = 1000;
constexpr int kPlotColumns = 40;               // the least that a plot takes
constexpr int kLeastPlot = 4, kMostPlot = 10;  // rows of its area
constexpr int kAround = 3;                     // rows for its label, its axis and the numbers there

// "index  2.31 N of 2.40 N asked, 4.6 mm deep   peak 2.40 N, 4.8 mm deep"
Row device_row(const Area& area, const ForceTrace::Device& device, bool in_metres) {
  Row row = {span(area, 1, device.name, kBold)};
  int column = 3 + columns_of(device.name);
  const auto add = [&](const std::string& text, Style style) {
    row.push_back(span(area, column, text, style));
    column += columns_of(text) + 3;
  };
  if (device.samples.empty()) {
    add(tr("no force yet"), kDim);
    return row;
  }
  const ForceTrace::Sample& now = device.samples.back();
  add(in_metres
          ? tr("{:5.2f} N of {:5.2f} N asked, {:4.1f} mm deep", now.measured_n, now.asked_n, now.depth * kMillimetres)
          : tr("{:5.2f} N of {:5.2f} N asked, {:5.3f} rad deep", now.measured_n, now.asked_n, now.depth),
      {});
  add(peak_text(device, in_metres), kDim);
  return row;
}

PlotSeries curve(const ForceTrace& trace, const ForceTrace::Device& device, const std::string& name,
                 double ForceTrace::Sample::*value, double factor) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  PlotSeries series{.name = name, .x = {}, .y = {}};
  for (const ForceTrace::Sample& sample : device.samples) {
    if (sample.begins) {
      series.x.push_back(kGap);
      series.y.push_back(kGap);
    }
    series.x.push_back(1e-9 * static_cast<double>(sample.time_ns - trace.now_ns()));
    series.y.push_back(factor * sample.*value);
  }
  return series;
}

std::vector<std::string> plotted(const std::vector<PlotSeries>& series, const std::string& label, int rows,
                                 const Canvas& canvas) {
  PlotOptions options;
  options.y_label = label;
  options.rows = rows;
  options.from_zero = true;
  options.x_range = {-ForceTrace::kKept_s, 0};
  std::vector<std::string> lines;
  const std::string text = line_plot(series, options, canvas);
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return lines;
}

// Force at the left, depth at the right, over the last seconds.
std::vector<Row> plot_rows(const Area& area, const ForceTrace& trace, int rows) {
  const Canvas canvas{.columns = area.columns / 2, .unicode = area.unicode};
  std::vector<PlotSeries> force, depth;
  for (const ForceTrace::Device& device : trace.devices()) {
    force.push_back(curve(trace, device, device.name, &ForceTrace::Sample::measured_n, 1));
    depth.push_back(
        curve(trace, device, device.name, &ForceTrace::Sample::depth, trace.in_metres() ? kMillimetres : 1));
  }
  // Of one device also what is asked of it: where the governor takes some of it away, the curves part.
  if (force.size() == 1) {
    force.front().name = tr("measured");
    force.push_back(curve(trace, trace.devices().front(), tr("asked"), &ForceTrace::Sample::asked_n, 1));
  }
  const std::vector<std::string> left = plotted(force, tr("force N (5 s)"), rows, canvas);
  const std::vector<std::string> right =
      plotted(depth, trace.in_metres() ? tr("depth mm (5 s)") : tr("depth rad (5 s)"), rows, canvas);
  std::vector<Row> out;
  const std::size_t lines = static_cast<std::size_t>(rows) + static_cast<std::size_t>(kAround);
  for (std::size_t i = 0; i < lines; ++i) {
    Row row;
    if (i < left.size()) row.push_back({0, clipped(left[i], canvas.columns, area.unicode), {}});
    if (i < right.size()) row.push_back({canvas.columns, clipped(right[i], canvas.columns, area.unicode), {}});
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace

std::vector<Row> force_rows(const Area& area, const ForceTrace& trace, int room) {
  std::vector<Row> rows;
  const auto lines = static_cast<int>(trace.devices().size());
  const bool any = std::any_of(trace.devices().begin(), trace.devices().end(),
                               [](const ForceTrace::Device& device) { return !device.samples.empty(); });
  const int plot = std::min(room - lines - kAround, kMostPlot);
  if (plot >= kLeastPlot && area.columns >= 2 * kPlotColumns && any) rows = plot_rows(area, trace, plot);
  for (const ForceTrace::Device& device : trace.devices())
    if (static_cast<int>(rows.size()) < room) rows.push_back(device_row(area, device, trace.in_metres()));
  return rows;
}

}  // namespace jnd
