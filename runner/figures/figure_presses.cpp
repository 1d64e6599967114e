// Force against depth of a few trials: the stiffness that was delivered is the slope.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/raw_trials/press_traces.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kPressLeft = 62, kPressWidth = 230, kPressHeight = 190, kPressGapX = 26, kPressGapY = 62,
                 kPressTop = 44, kPressBelow = 52;
constexpr std::size_t kPressColumns = 3;
constexpr double kMillimetres = 1000;

// Of the figure: depth in mm, or in rad.
double depth_factor(const Protocol& protocol) {
  return protocol.stimulus.unit == Unit::n_per_m ? kMillimetres : 1;
}

struct PressScales {
  Range depth, force;
};

PressScales press_scales(const std::vector<PressedTrial>& trials, double factor) {
  double depth = 0, least = 0, most = 0;
  for (const PressedTrial& trial : trials)
    for (const PressTrace& trace : trial.intervals)
      for (const PressTrace::Point& point : trace.points) {
        depth = std::max(depth, factor * point.depth);
        least = std::min(least, point.measured_n);
        most = std::max(most, point.measured_n);
      }
  return {round_range(0, depth > 0 ? depth : 1, 4), round_range(least, most > 0 ? most : 1, 4)};
}

// "400, 700 N/m, felt as 399.7, 698.2"; what was not felt as a stiffness is "none".
std::string press_words(const PressedTrial& trial, const Protocol& protocol) {
  std::string asked, felt;
  bool any = false;
  for (const PressTrace& trace : trial.intervals) {
    asked += fmt::format("{}{:g}", asked.empty() ? "" : ", ", trace.stimulus);
    felt += (felt.empty() ? "" : ", ") + (trace.delivered ? size_text(*trace.delivered) : "none");
    any = any || trace.delivered;
  }
  return fmt::format("{} {}{}", asked, unit_of(protocol), any ? ", felt as " + felt : ", no force");
}

bool is_limited(const PressedTrial& trial) {
  return std::any_of(trial.intervals.begin(), trial.intervals.end(), [](const PressTrace& one) { return one.limited; });
}

std::string name_of(const PressedTrial& trial, const Protocol& protocol) {
  return fmt::format("{}, {}, trial {}{}", trial.participant, condition_text(protocol, trial.condition), trial.trial,
                     is_limited(trial) ? ", limited" : "");
}

// From the origin with the slope that was asked for: where it leaves the panel it ends.
void draw_asked(Svg& svg, const PressTrace& trace, const Scale& x, const Scale& y, double factor) {
  const auto deepest = std::max_element(trace.points.begin(), trace.points.end(),
                                        [](const auto& a, const auto& b) { return a.depth < b.depth; });
  if (deepest == trace.points.end() || deepest->depth <= 0 || deepest->asked_n <= 0) return;
  const double slope = deepest->asked_n / (factor * deepest->depth);
  const double end = std::min(x.high, y.high / slope);
  svg.line(x.at(0), y.at(0), x.at(end), y.at(slope * end), kRule);
}

// A line for each press: the finger is out of the object between them.
void draw_press(Svg& svg, const PressTrace& trace, int condition, const Scale& x, const Scale& y, double factor) {
  ShapeStyle style = condition_line(condition);
  style.stroke_width = 1.3;
  if (trace.interval % 2 == 1) style.dash = "4 2";
  std::vector<SvgPoint> corners;
  const auto finish = [&] {
    if (corners.size() > 1) svg.polyline(corners, style);
    corners.clear();
  };
  for (const PressTrace::Point& point : trace.points) {
    if (point.depth <= 0 || !std::isfinite(point.measured_n))
      finish();
    else
      corners.emplace_back(x.at(factor * point.depth), y.at(point.measured_n));
  }
  finish();
}

void draw_trial(Svg& svg, const Panel& panel, const PressedTrial& trial, const PressScales& scales,
                const Protocol& protocol, double factor, bool y_labels) {
  const Scale x{scales.depth.low, scales.depth.high, panel.left, panel.right};
  const Scale y{scales.force.low, scales.force.high, panel.bottom, panel.top};
  svg.text(panel.left, panel.top - 32 + 8, fitted(name_of(trial, protocol), kLabel.size, panel.width()),
           strong(kLabel));
  const std::string words = press_words(trial, protocol);
  svg.text(panel.left, panel.top - 8, fitted(words, kMuted.size, panel.width()), kMuted);
  draw_grid_rows(svg, panel, y, 4);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  if (y_labels) draw_y_axis(svg, panel, y, "", 4);
  draw_x_axis(svg, panel, x, "", 4);
  svg.begin("", fmt::format("{}: {}", name_of(trial, protocol), words));
  for (const PressTrace& trace : trial.intervals) draw_asked(svg, trace, x, y, factor);
  for (const PressTrace& trace : trial.intervals) draw_press(svg, trace, trial.condition, x, y, factor);
  svg.end();
}

// Panels in rows from the left, all with the same scales.
Svg draw_presses(const std::vector<PressedTrial>& trials, const Protocol& protocol, const std::string& title,
                 std::size_t most_columns) {
  const double factor = depth_factor(protocol);
  const PressScales scales = press_scales(trials, factor);
  const std::size_t columns = std::min(most_columns, trials.size()), rows = (trials.size() + columns - 1) / columns;
  const double width = kPressLeft + static_cast<double>(columns) * (kPressWidth + kPressGapX);
  const double bottom = kPressTop + static_cast<double>(rows) * (kPressHeight + kPressGapY) - kPressGapY;
  std::string description;
  for (const PressedTrial& trial : trials)
    description += fmt::format("{}: {}. ", name_of(trial, protocol), press_words(trial, protocol));
  Svg svg(most_columns == 1 ? "figure-presses-narrow" : "figure-presses", width, bottom + kPressBelow, title,
          description);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const double left = kPressLeft + static_cast<double>(column) * (kPressWidth + kPressGapX);
    const double upper = kPressTop + static_cast<double>(row) * (kPressHeight + kPressGapY);
    draw_trial(svg, {left, upper, left + kPressWidth, upper + kPressHeight}, trials[i], scales, protocol, factor,
               column == 0);
  }
  TextStyle upwards = anchored(kLabel, "middle");
  upwards.upwards = true;
  svg.text(18, (kPressTop + bottom) / 2, "force measured (N)", upwards);
  svg.text((kPressLeft + width) / 2, bottom + 42, fmt::format("depth ({})", factor == 1 ? "rad" : "mm"),
           anchored(kLabel, "middle"));
  return svg;
}

}  // namespace

std::vector<Figure> press_figures(const ShownPresses& presses, const Protocol& protocol) {
  if (presses.trials.empty()) return {};
  const auto shown = static_cast<std::ptrdiff_t>(std::min(presses.trials.size(), kMostPresses));
  const std::vector<PressedTrial> trials(presses.trials.begin(), presses.trials.begin() + shown);
  const bool limited = std::any_of(trials.begin(), trials.end(), is_limited);
  const std::string title = "Force against depth";
  const std::string device = protocol.rig.fingers.empty() ? "" : fmt::format(", {}", protocol.rig.fingers.front());
  const std::string which =
      presses.chosen
          ? fmt::format("Chosen trials{}.", device)
          : fmt::format(
                "A trial of each condition of {}{}: the first whose ticks were kept, and where that can be, of "
                "two different objects.",
                trials.front().participant, device);
  return {{"presses", title,
           fmt::format(
               "{} Force against depth every 5 ms, the second interval dashed; the slope is the stiffness that was "
               "felt. Dotted: what was asked for.{}",
               which, limited ? " Limited: the force stays below that where a limit of the device was reached." : ""),
           draw_presses(trials, protocol, title, kPressColumns), draw_presses(trials, protocol, title, 1)}};
}

}  // namespace jnd
