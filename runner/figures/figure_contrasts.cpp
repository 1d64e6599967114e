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

std::string numbers_of(const ContrastRow& row) {
  const MeanEstimate& difference = row.difference;
  if (std::isnan(difference.mean)) return "no difference to estimate";
  const bool closed = std::isfinite(difference.ci_low) && std::isfinite(difference.ci_high);
  const int decimals = closed ? decimals_of_spread((difference.ci_high - difference.ci_low) / 2)
                              : decimals_of_size(std::abs(difference.mean));
  std::string text = number_text(difference.mean, decimals);
  if (!std::isnan(difference.ci_low))
    text += fmt::format(" ({})", range_text(difference.ci_low, difference.ci_high, decimals));
  return fmt::format("{}, {}{}", text, p_text(row.p),
                     std::isnan(row.p_registered) ? "" : ", registered " + p_text(row.p_registered));
}

}  // namespace

std::vector<Figure> contrast_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<ContrastRow> rows = results.contrasts;
  std::erase_if(rows, [](const ContrastRow& row) { return !row.registered; });
  if (rows.empty()) return {};
  const std::string scale =
      rows.front().unit.empty() ? rows.front().title : fmt::format("{}, {}", rows.front().title, rows.front().unit);
  Forest forest;
  forest.id = "figure-contrasts";
  forest.title = "Registered contrasts";
  ForestColumn& column = forest.columns.emplace_back();
  column.x_title = fmt::format("difference in {}", scale);
  for (const ContrastRow& row : rows) {
    const std::string name = contrast_title(row, protocol), numbers = numbers_of(row);
    const MeanEstimate& difference = row.difference;
    forest.description += fmt::format("{}: {}. ", name, numbers);
    column.rows.push_back({name, difference.mean, difference.ci_low, difference.ci_high, numbers,
                           fmt::format("{}: {}; n = {} of {}", name, numbers, difference.n, row.participants)});
  }
  return {
      {"contrasts", forest.title,
       fmt::format(
           "{} ({}), with its 95 % confidence interval and the p that belongs to it ({}, not corrected for the number "
           "of contrasts), and the registered p. The dotted line is no difference.",
           protocol.analysis.hierarchical
               ? "Each registered contrast as the logarithm of the ratio of two JNDs"
               : "Mean paired difference of each registered contrast on the scale on which it is tested",
           scale, protocol.analysis.hierarchical ? "profile likelihood" : "Student t"),
       draw_forest(forest)}};
}

}  // namespace jnd
