#include "data/results/study_contrasts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "analysis/group/p_adjust.h"

namespace jnd {

namespace {

MeanEstimate difference_of(const WithinTable& table, const Contrast& contrast) {
  std::vector<double> differences;
  for (std::size_t row = 0; row < table.n; ++row)
    differences.push_back(table.at(row, static_cast<std::size_t>(contrast.a)) -
                          table.at(row, static_cast<std::size_t>(contrast.b)));
  return mean_with_ci(differences);
}

// The registered one, before its p is corrected.
ContrastRow hierarchical_row(const Contrast& contrast, const StudyHierarchical& model) {
  ContrastRow row;
  row.a = contrast.a;
  row.b = contrast.b;
  row.outcome = kHierarchicalScale;
  row.registered = true;
  const auto found = std::find_if(model.ratios.begin(), model.ratios.end(), [&](const HierarchicalRatio& one) {
    return std::minmax(one.a, one.b) == std::minmax(contrast.a, contrast.b);
  });
  row.difference = {0, kNaN, kNaN, kNaN, kNaN};
  if (found == model.ratios.end()) {
    row.refused = model.reason.empty() ? "a condition has no trials" : model.reason;
    return row;
  }
  row.difference.n = found->participants;
  if (model.status == HierarchicalStatus::ok)
    row.p = found->p;
  else
    row.refused = model.reason;
  if (row.refused.empty() && std::isnan(row.p))
    row.refused = found->defined ? "the search for its test took too long" : "the answers of a condition tell no JND";
  if (!found->defined) return row;
  const double turned = found->a == contrast.a ? 1 : -1;
  row.difference.mean = turned * std::log(found->ratio);
  std::tie(row.difference.ci_low, row.difference.ci_high) =
      std::minmax({turned * std::log(found->ci_low), turned * std::log(found->ci_high)});
  return row;
}

}  // namespace

std::vector<ContrastRow> hierarchical_contrasts(const std::vector<ContrastRow>& rows, const StudyHierarchical& model,
                                                const Protocol& protocol) {
  const std::vector<Contrast>& contrasts = protocol.analysis.contrasts;
  std::vector<ContrastRow> registered;
  std::vector<double> p;
  for (const Contrast& contrast : contrasts) {
    registered.push_back(hierarchical_row(contrast, model));
    p.push_back(registered.back().p);
  }
  p = holm(p);
  std::vector<ContrastRow> all;
  std::size_t place = 0;  // of the contrast
  for (ContrastRow row : rows) {
    if (row.registered) {  // the first row of its contrast
      registered[place].p = p[place];
      registered[place].participants = row.participants;
      registered[place].difference_source = row.difference_source;
      all.push_back(std::move(registered[place++]));
    }
    row.registered = false;
    row.p = kNaN;
    row.refused.clear();
    all.push_back(std::move(row));
  }
  return all;
}

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
