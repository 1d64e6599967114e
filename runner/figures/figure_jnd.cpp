// Figure 5 of Chinello et al. 2017: the JND by condition.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/group/compare.h"
#include "runner/figures/figure.h"
#include "runner/figures/figure_conditions.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

// The JNDs of those who have one under every condition.
WithinTable complete_jnds(const StudyAnalysis& analysis, std::size_t conditions) {
  WithinTable table{0, conditions, {}};
  for (const ParticipantRows<ThresholdResult>& one : by_participant(analysis.thresholds, conditions)) {
    if (!std::all_of(one.of.begin(), one.of.end(),
                     [](const ThresholdResult* row) { return row != nullptr && row->jnd.status == JndStatus::ok; }))
      continue;
    for (const ThresholdResult* row : one.of) table.values.push_back(row->jnd.jnd);
    ++table.n;
  }
  return table;
}

std::vector<EdgeCount> edges_of(const JndGroup& jnd) {
  using Side = EdgeCount::Side;
  return {{Side::above, jnd.no_sensitivity, "no sensitivity"},
          {Side::below, jnd.ceiling, "ceiling"},
          {Side::none, jnd.no_information, "no information"}};
}

void add_published(ConditionColumn& column, const Protocol& protocol) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition_text(protocol, column.condition) && value.quantity == "jnd") {
      column.published = value.value;
      column.published_half_width = value.ci95_half_width;
      return;
    }
}

ConditionColumn column_of(const StudyAnalysis& analysis, const GroupResult& row, const Protocol& protocol) {
  ConditionColumn column;
  column.condition = row.condition;
  column.participants = row.jnd.n;
  column.edges = edges_of(row.jnd);
  for (const ThresholdResult& one : analysis.thresholds)
    if (one.condition == row.condition && one.jnd.status == JndStatus::ok)
      column.points.push_back({one.jnd.jnd, one.participant});
  const MeanEstimate& mean = row.jnd.mean_jnd;
  if (std::isfinite(mean.mean)) column.mean = mean.mean;
  if (std::isfinite(mean.ci_low)) column.interval = {mean.mean, mean.ci_low, mean.ci_high};
  if (std::isfinite(row.jnd.median_jnd)) column.median = row.jnd.median_jnd;
  add_published(column, protocol);
  return column;
}

std::string caption_of(const StudyAnalysis& analysis, const Protocol& protocol, std::size_t complete) {
  std::string text = fmt::format(
      "JND ({}) of every participant by condition, with the mean and its 95 % confidence interval (Student t) over "
      "those who have a JND. Method: {}, through the origin of the {} stiffness differences. ",
      unit_of(protocol), describe(analysis.method), to_string(analysis.by));
  if (complete > 1)
    text += fmt::format(
        "The within-subject interval (Cousineau-Morey) is for comparing conditions; it rests on the {} of {} "
        "participants "
        "with a JND under every condition. ",
        complete, analysis.attendance.participants);
  text +=
      "The median counts participants without sensitivity as infinite and those at the ceiling as below every JND. "
      "Participants without a JND stand at the edge, counted.";
  for (const GroupResult& row : analysis.group)
    if (row.jnd.n > 0 && row.jnd.median_status != JndStatus::ok)
      text += fmt::format(" {}: the median is {}, so it is not drawn.", condition_text(protocol, row.condition),
                          median_text(row.jnd.median_status, row.jnd.median_jnd, protocol));
  return text;
}

std::string description_of(const StudyAnalysis& analysis, const Protocol& protocol) {
  std::string text;
  for (const GroupResult& row : analysis.group)
    text += fmt::format(
        "{}: mean {} {}, 95 % CI {}, median {}, {} of {} participants. ", condition_text(protocol, row.condition),
        stiffness_text(row.jnd.mean_jnd.mean, protocol), unit_of(protocol),
        range_text(row.jnd.mean_jnd.ci_low, row.jnd.mean_jnd.ci_high, stiffness_decimals(protocol)),
        median_text(row.jnd.median_status, row.jnd.median_jnd, protocol), row.jnd.mean_jnd.n, row.jnd.n);
  return text;
}

}  // namespace

std::vector<Figure> jnd_figures(const StudyResults& results, const Protocol& protocol) {
  const auto* constant = std::get_if<ConstantResults>(&results.measured);
  if (constant == nullptr) return {};
  const StudyAnalysis& analysis = constant->analysis;
  if (analysis.thresholds.empty()) return {};
  ConditionFigure figure;
  figure.id = "jnd";
  figure.title = "JND by condition";
  figure.description = description_of(analysis, protocol);
  figure.y_title = fmt::format("JND ({})", unit_of(protocol));
  figure.unit = fmt::format(" {}", unit_of(protocol));
  figure.decimals = stiffness_decimals(protocol);
  if (protocol.stimulus.reference > 0) {
    figure.right_factor = 100 / protocol.stimulus.reference;
    figure.right_title = "Weber fraction";
  }
  figure.joined = true;
  for (const GroupResult& row : analysis.group) figure.columns.push_back(column_of(analysis, row, protocol));
  const WithinTable complete = complete_jnds(analysis, protocol.conditions.size());
  if (complete.n > 1 && complete.k > 1) {
    const Comparison comparison = compare(complete);
    for (ConditionColumn& column : figure.columns) {
      const ConditionSummary& summary = comparison.conditions[static_cast<std::size_t>(column.condition)];
      if (std::isfinite(summary.ci_within_low))
        column.within = {summary.mean, summary.ci_within_low, summary.ci_within_high};
    }
  }
  return {
      {figure.id, figure.title, caption_of(analysis, protocol, complete.n), draw_condition_figure(figure, protocol)}};
}

}  // namespace jnd
