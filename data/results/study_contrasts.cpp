#include "data/results/study_contrasts.h"

#include <cstddef>

namespace jnd {

namespace {

MeanEstimate difference_of(const WithinTable& table, const Contrast& contrast) {
  std::vector<double> differences;
  for (std::size_t row = 0; row < table.n; ++row)
    differences.push_back(table.at(row, static_cast<std::size_t>(contrast.a)) -
                          table.at(row, static_cast<std::size_t>(contrast.b)));
  return mean_with_ci(differences);
}

}  // namespace

std::vector<ContrastRow> contrast_rows(const std::vector<ContrastResult>& jnds, const OutcomeComparison& registered,
                                       const Protocol& protocol) {
  const std::vector<Contrast>& contrasts = protocol.analysis.contrasts;
  const std::string jnd(to_string(Outcome::jnd));
  std::vector<double> p;
  if (registered.crossed && registered.refused.empty()) p = contrast_p(registered.comparison, protocol.analysis);
  std::vector<ContrastWithin> within;
  // Where somebody has no value in one condition, contrasts of the others are tested all the same.
  const bool each_alone = !registered.crossed || (!registered.refused.empty() && !registered.left_out.empty());
  if (each_alone) within = contrasts_within(registered, protocol);
  std::vector<ContrastRow> rows;
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    ContrastRow row;
    row.a = contrasts[i].a;
    row.b = contrasts[i].b;
    row.participants =
        each_alone ? within[i].participants : static_cast<int>(registered.table.n + registered.left_out.size());
    // Of an adaptive study there is no other scale than its thresholds'.
    const bool has_jnds = i < jnds.size();
    if (has_jnds) row.difference_source = jnds[i].difference_source;

    ContrastRow tested = row;
    tested.outcome = registered.outcome;
    tested.unit = registered.unit;
    tested.registered = true;
    tested.refused = registered.refused;
    // Where tests on the JND are refused the differences of those who have both are there all the same.
    tested.difference =
        registered.outcome == jnd && has_jnds ? jnds[i].difference : difference_of(registered.table, contrasts[i]);
    if (i < p.size()) tested.p = p[i];
    if (each_alone) {
      tested.difference = mean_with_ci(within[i].differences);
      tested.p = within[i].p;
      tested.refused = within[i].refused;
    }
    rows.push_back(std::move(tested));
    if (registered.outcome == jnd || !has_jnds) continue;

    row.outcome = jnd;
    row.unit = to_string(protocol.stimulus.unit);
    row.difference = jnds[i].difference;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace jnd
