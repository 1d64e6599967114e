#include "runner/power/power_figure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"

namespace jnd {

namespace {

constexpr double kLeft = 62, kRight = 16, kTop = 34, kPanelWidth = 210, kPanelHeight = 150, kBetween = 26, kRowGap = 44,
                 kLegendRow = 24;
constexpr std::size_t kMostColumns = 4;  // contrasts beside one another

enum class Axis { participants, trials, effect };

double on_axis(const PowerDesign& design, Axis axis) {
  switch (axis) {
    case Axis::participants:
      return design.participants;
    case Axis::trials:
      return design.trials;
    case Axis::effect:
      break;
  }
  return design.effect;
}

std::string axis_title(Axis axis) {
  switch (axis) {
    case Axis::participants:
      return "participants";
    case Axis::trials:
      return "trials of a cell";
    case Axis::effect:
      break;
  }
  return "effect (1: as planned)";
}

Axis axis_of(const PowerQuestion& question) {
  Axis axis = Axis::participants;
  std::size_t most = question.participants.size();
  if (question.trials.size() > most) {
    axis = Axis::trials;
    most = question.trials.size();
  }
  return question.effects.size() > most ? Axis::effect : axis;
}

// What a row of panels has in common: "18 participants, effect 1".
std::string row_title(const PowerDesign& design, Axis axis) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (axis != Axis::participants) add(fmt::format("{} participants", design.participants));
  if (axis != Axis::trials && design.trials > 0) add(fmt::format("{} trials", design.trials));
  if (axis != Axis::effect) add(fmt::format("effect {:g}", design.effect));
  return text;
}

// One analysis: its points from the left, with bars, joined. The analyses stand a little beside one another.
void draw_curve(Svg& svg, const Scale& x, const Scale& y, std::vector<const ContrastSummary*> rows, Axis axis,
                int analysis, int analyses) {
  std::sort(rows.begin(), rows.end(), [axis](const ContrastSummary* a, const ContrastSummary* b) {
    return on_axis(a->design, axis) < on_axis(b->design, axis);
  });
  const double beside = 5.0 * (analysis - 0.5 * (analyses - 1));
  std::vector<SvgPoint> corners;
  std::erase_if(rows, [](const ContrastSummary* row) { return std::isnan(row->power.value); });  // it has no such test
  for (const ContrastSummary* row : rows)
    corners.emplace_back(x.at(on_axis(row->design, axis)) + beside, y.at(row->power.value));
  if (corners.size() > 1) svg.polyline(corners, condition_line(analysis));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Simulated& power = rows[i]->power;
    svg.begin("point", fmt::format("{}, {} participants{}, effect {:g}: {}",
                                   word_of(kPowerAnalysisWords, rows[i]->analysis), rows[i]->design.participants,
                                   rows[i]->design.trials > 0 ? fmt::format(", {} trials", rows[i]->design.trials) : "",
                                   rows[i]->design.effect, share_text(power)));
    svg.line(corners[i].first, y.clipped(power.low), corners[i].first, y.clipped(power.high), condition_line(analysis));
    draw_marker(svg, analysis, corners[i].first, corners[i].second, 4, condition_fill(analysis));
    svg.end();
  }
}

}  // namespace

Svg power_figure(const PowerResult& result) {
  const PowerQuestion& question = result.question;
  const Axis axis = axis_of(question);
  const std::vector<ContrastSummary> rows = contrast_summaries(result);
  // By what they have in common, then the contrast, then the analysis.
  using Common = std::tuple<int, int, double>;
  std::map<Common, std::map<std::size_t, std::map<PowerAnalysis, std::vector<const ContrastSummary*>>>> panels;
  for (const ContrastSummary& row : rows) {
    const PowerDesign& design = row.design;
    const Common common{axis == Axis::participants ? 0 : design.participants, axis == Axis::trials ? 0 : design.trials,
                        axis == Axis::effect ? 0 : design.effect};
    panels[common][row.contrast][row.analysis].push_back(&row);
  }
  const std::size_t contrasts = question.tests(), columns = std::min(contrasts, kMostColumns);
  const std::size_t lines = (contrasts + columns - 1) / columns;  // of panels for a row of designs
  const double width =
      kLeft + static_cast<double>(columns) * kPanelWidth + static_cast<double>(columns - 1) * kBetween + kRight;
  std::vector<LegendEntry> legend;
  for (std::size_t a = 0; a < question.analyses.size(); ++a)
    legend.push_back({LegendEntry::Kind::condition, static_cast<int>(a),
                      std::string(word_of(kPowerAnalysisWords, question.analyses[a]))});
  const double block = static_cast<double>(lines) * (kPanelHeight + kRowGap) + 32;
  const double height = kTop + kLegendRow + static_cast<double>(panels.size()) * block;
  Svg svg("power", width, height, fmt::format("Power: {}", result.protocol.title),
          fmt::format("Share of {} simulated studies in which a contrast is significant at {:g}, by {}.",
                      result.tally.studies, result.protocol.analysis.tests.alpha, axis_title(axis)));
  draw_legend(&svg, legend, kLeft, 10, width - kLeft - kRight);
  double low = kInf, high = -kInf;
  for (const ContrastSummary& row : rows) {
    low = std::min(low, on_axis(row.design, axis));
    high = std::max(high, on_axis(row.design, axis));
  }
  const double room = high > low ? 0.08 * (high - low) : 1;
  double top = kTop + kLegendRow;
  for (const auto& [common, by_contrast] : panels) {
    const ContrastSummary& first = *by_contrast.begin()->second.begin()->second.front();
    svg.text(kLeft, top - 4, row_title(first.design, axis), strong(kLabel));
    for (const auto& [contrast, by_analysis] : by_contrast) {
      const std::size_t column = contrast % columns, line = contrast / columns;
      const double left = kLeft + static_cast<double>(column) * (kPanelWidth + kBetween);
      const double panel_top = top + 20 + static_cast<double>(line) * (kPanelHeight + kRowGap);
      const Panel panel{left, panel_top, left + kPanelWidth, panel_top + kPanelHeight};
      const Scale x{low - room, high + room, panel.left, panel.right}, y{0, 1, panel.bottom, panel.top};
      draw_grid_rows(svg, panel, y, 5);
      svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
      svg.line(panel.left, y.at(question.wanted), panel.right, y.at(question.wanted), kRule);
      if (column == 0) draw_y_axis(svg, panel, y, "power", 5);
      const bool foot = contrast + columns >= contrasts;
      if (foot) draw_x_axis(svg, panel, x, axis_title(axis), 4);
      const double ratio = by_analysis.begin()->second.front()->ratio;
      const bool told = !std::isnan(ratio) && axis != Axis::effect;
      svg.text(
          panel.left, panel.top - 5,
          fitted(contrast_name(result, contrast) + (told ? fmt::format(", ratio {:.2f}", ratio) : ""), 11, kPanelWidth),
          kMuted);
      for (std::size_t a = 0; a < question.analyses.size(); ++a)
        draw_curve(svg, x, y, by_analysis.at(question.analyses[a]), axis, static_cast<int>(a),
                   static_cast<int>(question.analyses.size()));
    }
    top += block;
  }
  return svg;
}

}  // namespace jnd
