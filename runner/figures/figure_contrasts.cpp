// The registered contrasts: each difference with its interval, against no difference.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/figures/figure.h"
#include "runner/figures/figure_axis.h"
#include "runner/figures/figure_style.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kContrastNames = 190, kContrastPlot = 380, kContrastNumbers = 250, kContrastRow = 34,
                 kContrastTop = 14, kContrastBelow = 52;

std::string contrast_title(const ContrastRow& row, const Protocol& protocol) {
  return fmt::format("{} − {}", condition_text(protocol, row.a), condition_text(protocol, row.b));
}

std::string numbers_of(const ContrastRow& row, const ContrastScale& scale) {
  const MeanEstimate& difference = row.difference;
  if (std::isnan(difference.mean)) return "no difference to estimate";
  std::string text = number_text(scale.factor * difference.mean, scale.decimals);
  if (std::isfinite(difference.ci_low))
    text += fmt::format(
        " ({})", range_text(scale.factor * difference.ci_low, scale.factor * difference.ci_high, scale.decimals));
  return text + (std::isnan(row.p) ? ", no test" : fmt::format(", p = {}", p_value_text(row.p)));
}

// With zero in it.
Range contrast_range(const std::vector<ContrastRow>& rows, double factor) {
  double low = 0, high = 0;
  for (const ContrastRow& row : rows)
    for (const double end : {row.difference.mean, row.difference.ci_low, row.difference.ci_high})
      if (std::isfinite(end)) {
        low = std::min(low, factor * end);
        high = std::max(high, factor * end);
      }
  return round_range(low, high, 6);
}

void draw_contrast(Svg& svg, const ContrastRow& row, const ContrastScale& scale, const Panel& panel, const Scale& x,
                   double y, const Protocol& protocol) {
  svg.text(panel.left - 12, y + 4, fitted(contrast_title(row, protocol), kLabel.size, kContrastNames - 24),
           anchored(kLabel, "end"));
  TextStyle numbers = kMuted;
  svg.text(panel.right + 14, y + 4, fitted(numbers_of(row, scale), numbers.size, kContrastNumbers - 16), numbers);
  const MeanEstimate& difference = row.difference;
  if (std::isnan(difference.mean)) return draw_cross(svg, x.at(0), y, 4, kInk);
  svg.begin("mean", fmt::format("{}: {}; n = {} of {}", contrast_title(row, protocol), numbers_of(row, scale),
                                difference.n, row.participants));
  if (std::isfinite(difference.ci_low)) {
    const double from = x.at(scale.factor * difference.ci_low), to = x.at(scale.factor * difference.ci_high);
    svg.line(from, y, to, y, kInk);
    for (const double end : {from, to}) svg.line(end, y - 5, end, y + 5, kInk);
  }
  svg.circle(x.at(scale.factor * difference.mean), y, 4.5, kInkFill);
  svg.end();
}

}  // namespace

std::vector<Figure> contrast_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<ContrastRow> rows = contrasts_of(results, protocol);
  std::erase_if(rows, [](const ContrastRow& row) { return !row.registered; });
  if (rows.empty()) return {};
  const OutcomeComparison& tested = results.comparisons.front();
  const ContrastScale scale = contrast_scale(rows.front(), tested, protocol);
  const double height = kContrastRow * static_cast<double>(rows.size());
  const Panel panel{kContrastNames, kContrastTop, kContrastNames + kContrastPlot, kContrastTop + height};
  const Range range = contrast_range(rows, scale.factor);
  const Scale x{range.low, range.high, panel.left, panel.right};
  std::string description;
  for (const ContrastRow& row : rows)
    description += fmt::format("{}: {}. ", contrast_title(row, protocol), numbers_of(row, scale));
  const std::string title = "Registered contrasts";
  Svg svg("figure-contrasts", kContrastNames + kContrastPlot + kContrastNumbers, panel.bottom + kContrastBelow, title,
          description);
  draw_grid_columns(svg, panel, x, 6);
  draw_x_axis(svg, panel, x, fmt::format("difference in {}", scale.name), 6);
  svg.line(x.at(0), panel.top, x.at(0), panel.bottom, kRule);
  for (std::size_t i = 0; i < rows.size(); ++i)
    draw_contrast(svg, rows[i], scale, panel, x, panel.top + kContrastRow * (static_cast<double>(i) + 0.5), protocol);
  return {
      {"contrasts", title,
       fmt::format("Mean paired difference of each registered contrast on the scale on which it is tested ({}), with "
                   "its 95 % confidence interval (Student t, not corrected for the number of contrasts); p as "
                   "registered. The dotted line is no difference.",
                   scale.name),
       std::move(svg)}};
}

}  // namespace jnd
