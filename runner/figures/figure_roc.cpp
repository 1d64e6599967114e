// Hit rate against false-alarm rate, with lines of equal d'.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "analysis/numerics/normal.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kRocLeft = 58, kRocSide = 150, kRocGap = 34, kRocTop = 30, kRocBetween = 30, kRocBottom = 52;
constexpr double kRocNarrowBetween = 44;
constexpr std::size_t kMostRocColumns = 5, kNarrowRocColumns = 2;

// How many participants have these rates.
using Rates = std::map<std::pair<double, double>, int>;

Rates rates_of(const TaskResults& analysis, int condition, int series) {
  Rates rates;
  for (const CellResult& cell : analysis.cells) {
    const Counts& counts = cell.counts;
    if (cell.condition != condition || cell.series != series || counts.n_diff == 0 || counts.n_same == 0) continue;
    ++rates[{static_cast<double>(counts.false_alarms) / counts.n_same,
             static_cast<double>(counts.hits) / counts.n_diff}];
  }
  return rates;
}

// Of the yes-no model: z(H) - z(F) = d'.
void draw_equal_dprime(Svg& svg, const Scale& x, const Scale& y, double dprime) {
  constexpr int kSteps = 60;
  std::vector<SvgPoint> corners;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    corners.emplace_back(x.at(share), y.at(normal_cdf(dprime + normal_quantile(share))));
  }
  svg.polyline(corners, dprime == 0 ? kRule : kFaint);
}

// named: the lines.
void draw_roc(Svg& svg, const Panel& panel, const Rates& rates, int condition, bool y_labels, bool x_labels,
              bool named) {
  const Scale x{0, 1, panel.left, panel.right}, y{0, 1, panel.bottom, panel.top};
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  for (const int dprime : {0, 1, 2, 3}) {
    draw_equal_dprime(svg, x, y, dprime);
    // On the other diagonal, where both rates are as far from a half.
    if (named)
      svg.text(x.at(normal_cdf(-dprime / 2.0)) + 3, y.at(normal_cdf(dprime / 2.0)) + 10, fmt::format("{}", dprime),
               kMuted);
  }
  if (y_labels) draw_y_axis(svg, panel, y, "", 2);
  if (x_labels) draw_x_axis(svg, panel, x, "", 2);
  constexpr double kOne = 2.6, kMost = 10;  // radii: the area grows with the number
  for (const auto& [at, count] : rates) {
    svg.begin("point", fmt::format("hit rate {:.2f}, false-alarm rate {:.2f}: {}", at.second, at.first,
                                   counted(count, "participant")));
    draw_marker(svg, condition, x.at(at.first), y.at(at.second), std::min(kOne * std::sqrt(count), kMost),
                condition_fill(condition));
    svg.end();
  }
}

struct RocPanel {
  int condition = 0, series = 0;
};

std::string difference_text(const Series& series, const Protocol& protocol) {
  return fmt::format("{} {}", size_text(std::abs(series.pair[1] - series.pair[0])), unit_of(protocol));
}

// A column for each condition and a row for each series; on a phone one after the other, two a row, each with its name.
Svg draw_roc_panels(const TaskResults& analysis, const Protocol& protocol, const std::string& title, bool narrow) {
  std::vector<RocPanel> panels;
  for (std::size_t series = 0; series < protocol.series.size(); ++series)
    for (std::size_t condition = 0; condition < protocol.conditions.size(); ++condition)
      panels.push_back({static_cast<int>(condition), static_cast<int>(series)});
  const std::size_t columns = narrow ? std::min(kNarrowRocColumns, panels.size()) : protocol.conditions.size();
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const double between = narrow ? kRocNarrowBetween : kRocBetween;
  const double right = kRocLeft + static_cast<double>(columns) * (kRocSide + kRocGap);
  const double bottom = kRocTop + static_cast<double>(rows) * (kRocSide + between) - between;
  Svg svg(narrow ? "figure-roc-narrow" : "figure-roc", narrow ? right : std::max(420.0, right + 90),
          bottom + kRocBottom, title, "A panel for every condition and series; lines of d' 0, 1, 2 and 3. ");
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const std::size_t row = i / columns, column = i % columns;
    const RocPanel& panel = panels[i];
    const double left = kRocLeft + static_cast<double>(column) * (kRocSide + kRocGap);
    const double top = kRocTop + static_cast<double>(row) * (kRocSide + between);
    const Series& series = protocol.series[static_cast<std::size_t>(panel.series)];
    draw_roc(svg, {left, top, left + kRocSide, top + kRocSide}, rates_of(analysis, panel.condition, panel.series),
             panel.condition, column == 0, i + columns >= panels.size(), row + 1 == rows && column == 0);
    std::string name = condition_text(protocol, panel.condition);
    if (narrow) name += ", " + difference_text(series, protocol);
    if (narrow || row == 0) svg.text(left, top - 10, fitted(name, kLabel.size, kRocSide), strong(kLabel));
    if (!narrow && column == 0)
      svg.text(right - kRocGap + 10, top + kRocSide / 2, difference_text(series, protocol), kMuted);
  }
  TextStyle upwards = anchored(kLabel, "middle");
  upwards.upwards = true;
  svg.text(16, (kRocTop + bottom) / 2, "hit rate", upwards);
  svg.text((kRocLeft + right - kRocGap) / 2, bottom + 42, "false-alarm rate", anchored(kLabel, "middle"));
  return svg;
}

}  // namespace

std::vector<Figure> roc_figures(const StudyResults& results, const Protocol& protocol) {
  if (results.task.cells.empty() || protocol.conditions.size() > kMostRocColumns) return {};
  const std::string title = "Hits against false alarms";
  return {
      {"roc", title,
       "Raw rates of every participant, a panel for each condition and stiffness difference; larger marks are several "
       "participants at one place. Lines of equal d' of the yes-no model: 0 (dotted), 1, 2 and 3. Towards the lower "
       "left: a criterion that leans to \"same\".",
       draw_roc_panels(results.task, protocol, title, false), draw_roc_panels(results.task, protocol, title, true)}};
}

}  // namespace jnd
