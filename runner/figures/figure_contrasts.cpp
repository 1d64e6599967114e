// The registered contrasts: each difference with its interval, against no difference.
#include <cmath>

#include <fmt/format.h>

#include "data/blocks/common_fields.h"
#include "runner/drawing/figure_forest.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

std::string contrast_title(const ContrastRow& row, const Protocol& protocol) {
  return fmt::format("{} − {}", condition_text(protocol, row.a), condition_text(protocol, row.b));
}

// As the table has it: slopes are read per 100 N/m.
MeanEstimate shown_difference(const ContrastRow& row, const Protocol& protocol) {
  MeanEstimate difference = row.difference;
  const double factor = row.outcome == "slope" ? slope_step(protocol) : 1;
  for (double* const number : {&difference.mean, &difference.ci_low, &difference.ci_high}) *number *= factor;
  return difference;
}

std::string numbers_of(const ContrastRow& row, const MeanEstimate& difference) {
  if (std::isnan(difference.mean)) return "no difference to estimate";
  const bool closed = std::isfinite(difference.ci_low) && std::isfinite(difference.ci_high);
  const int decimals = closed ? decimals_of_spread((difference.ci_high - difference.ci_low) / 2)
                              : decimals_of_size(std::abs(difference.mean));
  std::string text = number_text(difference.mean, decimals);
  if (!std::isnan(difference.ci_low))
    text += fmt::format(" ({})", range_text(difference.ci_low, difference.ci_high, decimals));
  return fmt::format("{}, {}", text, p_text(row.p));
}

}  // namespace

std::vector<Figure> contrast_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<ContrastRow> rows = results.contrasts;
  std::erase_if(rows, [](const ContrastRow& row) { return !row.registered; });
  if (rows.empty()) return {};
  const ContrastRow& first = rows.front();
  const std::string scale = first.outcome == "slope"
                                ? fmt::format("d' per {} {}", slope_step(protocol), unit_of(protocol))
                                : first.title + (first.unit.empty() ? "" : ", " + first.unit);
  Forest forest;
  forest.id = "figure-contrasts";
  forest.title = "Registered contrasts";
  ForestColumn& column = forest.columns.emplace_back();
  column.x_title = fmt::format("difference in {}", scale);
  for (const ContrastRow& row : rows) {
    const MeanEstimate difference = shown_difference(row, protocol);
    const std::string name = contrast_title(row, protocol), numbers = numbers_of(row, difference);
    const std::string registered = std::isnan(row.p_registered) ? "" : ", registered " + p_text(row.p_registered);
    forest.description += fmt::format("{}: {}{}. ", name, numbers, registered);
    column.rows.push_back(
        {name, difference.mean, difference.ci_low, difference.ci_high, numbers,
         fmt::format("{}: {}{}; n = {} of {}", name, numbers, registered, difference.n, row.participants)});
  }
  return {
      {"contrasts", forest.title,
       fmt::format(
           "{} ({}), with its 95 % confidence interval and the p that belongs to it ({}, not corrected for the number "
           "of contrasts). The dotted line is no difference.",
           protocol.analysis.hierarchical
               ? "Each registered contrast as the logarithm of the ratio of two JNDs"
               : "Mean paired difference of each registered contrast on the scale on which it is tested",
           scale, protocol.analysis.hierarchical ? "profile likelihood" : "Student t"),
       draw_forest(forest)}};
}

}  // namespace jnd
