#include "data/results/study_contrasts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "analysis/group/p_adjust.h"
#include "analysis/group/post_hoc.h"

namespace jnd {

namespace {

// Of paired differences, with what belongs together: Student's interval and t test.
void set_difference(ContrastRow& row, const std::vector<double>& differences) {
  row.difference = mean_with_ci(differences);
  row.p = paired_t(differences, std::vector<double>(differences.size(), 0)).p;
}

std::vector<double> complete_differences(const WithinTable& table, const Contrast& contrast) {
  std::vector<double> differences;
  for (std::size_t row = 0; row < table.n; ++row)
    differences.push_back(table.at(row, static_cast<std::size_t>(contrast.a)) -
                          table.at(row, static_cast<std::size_t>(contrast.b)));
  return differences;
}

// The registered one, before its p is corrected.
ContrastRow hierarchical_row(const Contrast& contrast, const StudyHierarchical& model) {
  ContrastRow row;
  row.a = contrast.a;
  row.b = contrast.b;
  row.outcome = kHierarchicalScale;
  row.title = "ln JND (hierarchical model)";
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

// In the model's rows what the registered ones know of who took part; these lose their p.
std::vector<ContrastRow> hierarchical_rows(std::vector<ContrastRow>& registered, const StudyHierarchical& model,
                                           const Protocol& protocol) {
  std::vector<ContrastRow> rows;
  std::vector<double> p;
  for (const Contrast& contrast : protocol.analysis.contrasts) {
    rows.push_back(hierarchical_row(contrast, model));
    p.push_back(rows.back().p);
  }
  p = holm(p);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].p_registered = p[i];
    rows[i].participants = registered[i].participants;
    rows[i].difference_source = registered[i].difference_source;
    registered[i].registered = false;
    registered[i].p_registered = kNaN;
    registered[i].refused.clear();
  }
  return rows;
}

// Place of the JND among the outcomes, where it is not what is compared as it is.
std::size_t jnd_beside(const TaskResults& task) {
  std::size_t place = 0;
  while (place < task.outcomes.size() && task.outcomes[place].key != "jnd") ++place;
  return place == task.registered && !task.logarithm ? task.outcomes.size() : place;
}

// Of everyone who has a JND under both conditions.
ContrastRow jnd_row(const Contrast& contrast, const TaskResults& task, std::size_t jnd, const Protocol& protocol) {
  ContrastRow row;
  row.a = contrast.a;
  row.b = contrast.b;
  row.outcome = task.outcomes[jnd].key;
  row.title = compared_title(task.outcomes[jnd], protocol);
  row.unit = task.outcomes[jnd].unit;
  row.standard = compared_standard(protocol);
  std::vector<double> differences;
  for (const ParticipantRows& one : by_participant(task.estimates, protocol.conditions.size())) {
    const TaskEstimateRow *a = one.of[static_cast<std::size_t>(contrast.a)],
                          *b = one.of[static_cast<std::size_t>(contrast.b)];
    if (a == nullptr || b == nullptr) continue;
    ++row.participants;
    const double difference = outcome_value(*a, jnd, protocol) - outcome_value(*b, jnd, protocol);
    if (std::isfinite(difference)) differences.push_back(difference);
  }
  set_difference(row, differences);
  return row;
}

}  // namespace

std::vector<ContrastRow> contrast_rows(const OutcomeComparison& registered, const Protocol& protocol) {
  const std::vector<Contrast>& contrasts = protocol.analysis.contrasts;
  std::vector<double> p;
  if (registered.crossed && registered.refused.empty()) p = contrast_p(registered.comparison, protocol.analysis);
  std::vector<ContrastWithin> within;
  // Where somebody has no value in one condition, contrasts of the others are tested all the same.
  const bool each_alone = !registered.crossed || (!registered.refused.empty() && !registered.left_out.empty());
  if (each_alone) within = contrasts_within(registered, protocol);
  std::vector<ContrastRow> rows;
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    ContrastRow& row = rows.emplace_back();
    row.a = contrasts[i].a;
    row.b = contrasts[i].b;
    row.outcome = registered.outcome;
    row.title = registered.title;
    row.unit = registered.unit;
    row.standard = registered.standard;
    row.registered = true;
    if (each_alone) {
      row.participants = within[i].participants;
      set_difference(row, within[i].differences);
      row.p_registered = within[i].p;
      row.refused = within[i].refused;
      continue;
    }
    row.participants = static_cast<int>(registered.table.n + registered.left_out.size());
    set_difference(row, complete_differences(registered.table, contrasts[i]));
    row.refused = registered.refused;
    if (i < p.size()) row.p_registered = p[i];
  }
  return rows;
}

std::vector<ContrastRow> contrast_rows(const TaskResults& task, const OutcomeComparison& registered,
                                       const StudyHierarchical* model, const Protocol& protocol) {
  const std::vector<Contrast>& contrasts = protocol.analysis.contrasts;
  std::vector<ContrastRow> on_scale = contrast_rows(registered, protocol), rows;
  const std::size_t jnd = jnd_beside(task);
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    std::vector<DifferenceSource> sources;
    for (const TaskGroupRow& row : task.group)
      if (row.condition == contrasts[i].a || row.condition == contrasts[i].b) sources.push_back(row.difference_source);
    on_scale[i].difference_source = combined(sources);
  }
  std::vector<ContrastRow> by_model;
  if (model != nullptr && protocol.analysis.hierarchical) by_model = hierarchical_rows(on_scale, *model, protocol);
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    const DifferenceSource source = on_scale[i].difference_source;
    if (i < by_model.size()) rows.push_back(std::move(by_model[i]));
    rows.push_back(std::move(on_scale[i]));
    if (jnd == task.outcomes.size()) continue;
    rows.push_back(jnd_row(contrasts[i], task, jnd, protocol));
    rows.back().difference_source = source;
  }
  return rows;
}

}  // namespace jnd
