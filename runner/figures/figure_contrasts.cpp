// The registered contrasts: each difference with its interval, against no difference.
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_forest.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

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

}  // namespace

std::vector<Figure> contrast_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<ContrastRow> rows = contrasts_of(results, protocol);
  std::erase_if(rows, [](const ContrastRow& row) { return !row.registered; });
  if (rows.empty()) return {};
  const OutcomeComparison& tested = results.comparisons.front();
  const ContrastScale scale = contrast_scale(rows.front(), tested, protocol);
  Forest forest;
  forest.id = "figure-contrasts";
  forest.title = "Registered contrasts";
  ForestColumn& column = forest.columns.emplace_back();
  column.x_title = fmt::format("difference in {}", scale.name);
  for (const ContrastRow& row : rows) {
    const std::string name = contrast_title(row, protocol), numbers = numbers_of(row, scale);
    const MeanEstimate& difference = row.difference;
    forest.description += fmt::format("{}: {}. ", name, numbers);
    column.rows.push_back({name, scale.factor * difference.mean, scale.factor * difference.ci_low,
                           scale.factor * difference.ci_high, numbers,
                           fmt::format("{}: {}; n = {} of {}", name, numbers, difference.n, row.participants)});
  }
  return {
      {"contrasts", forest.title,
       fmt::format("{} ({}), with its 95 % confidence interval ({}, not corrected for the number of contrasts); p as "
                   "registered. The dotted line is no difference.",
                   protocol.analysis.hierarchical
                       ? "Each registered contrast as the logarithm of the ratio of two JNDs"
                       : "Mean paired difference of each registered contrast on the scale on which it is tested",
                   scale.name, protocol.analysis.hierarchical ? "profile likelihood" : "Student t"),
       draw_forest(forest)}};
}

}  // namespace jnd
