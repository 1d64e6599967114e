// Figure 5 of Chinello et al. 2017: the JND by condition.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runner/figures/figure.h"
#include "runner/figures/figure_conditions.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr std::size_t kJnd = 1;  // among the outcomes of pairs

std::vector<EdgeCount> edges_of(const TaskGroupRow& row) {
  using Side = EdgeCount::Side;
  const auto count = [&row](const char* status) {
    const auto found = row.without.find(status);
    return found == row.without.end() ? 0 : found->second;
  };
  return {{Side::above, count("no_sensitivity"), "no sensitivity"},
          {Side::below, count("ceiling"), "ceiling"},
          {Side::none, count("no_information"), "no information"}};
}

std::string median_words(const TaskGroupRow& row) {
  return row.middle == Beyond::below ? "ceiling" : row.median_n == 0 ? "no_information" : size_text(row.median);
}

void add_published(ConditionColumn& column, const Protocol& protocol) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition_text(protocol, column.condition) && value.quantity == "jnd") {
      column.published = value.value;
      column.published_half_width = value.ci95_half_width;
      return;
    }
}

ConditionColumn column_of(const TaskResults& task, const TaskGroupRow& row, const Protocol& protocol) {
  ConditionColumn column;
  column.condition = row.condition;
  column.participants = row.participants;
  column.edges = edges_of(row);
  for (const TaskEstimateRow& one : task.estimates)
    if (const auto& jnd = one.estimates.values[kJnd].value; jnd && one.condition == row.condition)
      column.points.push_back({*jnd, one.participant});
  if (std::isfinite(row.mean.mean)) column.mean = row.mean.mean;
  if (std::isfinite(row.mean.ci_low)) column.interval = {row.mean.mean, row.mean.ci_low, row.mean.ci_high};
  if (std::isfinite(row.within_low))
    column.within = {(row.within_low + row.within_high) / 2, row.within_low, row.within_high};
  if (std::isfinite(row.median)) column.median = row.median;
  add_published(column, protocol);
  return column;
}

std::string caption_of(const StudyResults& results, const std::vector<const TaskGroupRow*>& rows,
                       const Protocol& protocol) {
  const PairMethod& pairs = results.task.pairs;
  std::string text = fmt::format(
      "JND ({}) of every participant by condition, with the mean and its 95 % confidence interval (Student t) over "
      "those who have a JND. Method: {}, through the origin of the {} stiffness differences. ",
      unit_of(protocol), describe(pairs.method), to_string(pairs.by));
  if (const int complete = rows.front()->within_n; complete > 1)
    text += fmt::format(
        "The within-subject interval (Cousineau-Morey) is for comparing conditions; it rests on the {} of {} "
        "participants with a JND under every condition. ",
        complete, results.attendance.participants);
  text +=
      "The median counts participants without sensitivity as infinite and those at the ceiling as below every JND. "
      "Participants without a JND stand at the edge, counted.";
  for (const TaskGroupRow* row : rows)
    if (row->participants > 0 && !std::isfinite(row->median))
      text += fmt::format(" {}: the median is {}, so it is not drawn.", condition_text(protocol, row->condition),
                          median_words(*row));
  return text;
}

std::string description_of(const std::vector<const TaskGroupRow*>& rows, const Protocol& protocol) {
  std::string text;
  for (const TaskGroupRow* row : rows) {
    const double spread = (row->mean.ci_high - row->mean.ci_low) / 2;
    text += fmt::format("{}: mean {} {}, 95 % CI {}, median {}, {} of {} participants. ",
                        condition_text(protocol, row->condition), size_text(row->mean.mean), unit_of(protocol),
                        range_text(row->mean.ci_low, row->mean.ci_high, decimals_of_spread(spread)), median_words(*row),
                        row->mean.n, row->participants);
  }
  return text;
}

}  // namespace

std::vector<Figure> jnd_figures(const StudyResults& results, const Protocol& protocol) {
  if (results.task.cells.empty()) return {};
  std::vector<const TaskGroupRow*> rows;
  for (const TaskGroupRow& row : results.task.group)
    if (row.outcome == kJnd) rows.push_back(&row);
  ConditionFigure figure;
  figure.id = "jnd";
  figure.title = "JND by condition";
  figure.description = description_of(rows, protocol);
  figure.y_title = fmt::format("JND ({})", unit_of(protocol));
  figure.unit = fmt::format(" {}", unit_of(protocol));
  figure.decimals = 1;
  if (protocol.stimulus.reference > 0) {
    figure.right_factor = 100 / protocol.stimulus.reference;
    figure.right_title = "Weber fraction";
  }
  figure.joined = true;
  for (const TaskGroupRow* row : rows) figure.columns.push_back(column_of(results.task, *row, protocol));
  return {{figure.id, figure.title, caption_of(results, rows, protocol), draw_condition_figure(figure, protocol)}};
}

}  // namespace jnd
