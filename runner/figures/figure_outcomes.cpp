// Times and ratings by condition.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/moments.h"
#include "data/methods/markdown_text.h"
#include "protocols/planning/allotment.h"
#include "runner/figures/figure.h"
#include "runner/figures/figure_conditions.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

// Where groups get different conditions: those who get this one.
ConditionColumn column_of_groups(const OutcomeComparison& outcome, std::size_t place, const Protocol& protocol) {
  ConditionColumn column;
  column.condition = static_cast<int>(place);
  std::vector<double> values;
  for (const ParticipantValues& one : outcome.everyone) {
    if (!has_condition(protocol, one.group, column.condition)) continue;
    ++column.participants;
    if (!std::isfinite(one.values[place])) continue;
    values.push_back(one.values[place]);
    column.points.push_back({values.back(), one.participant});
  }
  column.edges = {{EdgeCount::Side::none, column.participants - static_cast<int>(values.size()), "no value"}};
  const MeanEstimate mean = mean_with_ci(values);
  if (mean.n > 0) column.mean = mean.mean;
  if (std::isfinite(mean.ci_low)) column.interval = {mean.mean, mean.ci_low, mean.ci_high};
  if (!values.empty()) column.median = median_of(values);
  return column;
}

ConditionColumn column_of(const OutcomeComparison& outcome, std::size_t place) {
  ConditionColumn column;
  column.condition = static_cast<int>(place);
  column.participants = static_cast<int>(outcome.table.n + outcome.left_out.size());
  const std::vector<double> values = outcome.table.column(place);
  for (std::size_t i = 0; i < values.size(); ++i) column.points.push_back({values[i], outcome.participants[i]});
  column.edges = {{EdgeCount::Side::none, static_cast<int>(outcome.left_out.size()), "left out"}};
  const MeanEstimate mean = mean_with_ci(values);
  if (mean.n > 0) column.mean = mean.mean;
  if (std::isfinite(mean.ci_low)) column.interval = {mean.mean, mean.ci_low, mean.ci_high};
  if (place < outcome.within.size()) {
    const ConditionSummary& summary = outcome.within[place];
    if (std::isfinite(summary.ci_within_low))
      column.within = {summary.mean, summary.ci_within_low, summary.ci_within_high};
  }
  if (!values.empty()) column.median = median_of(values);
  return column;
}

ConditionFigure figure_of(const OutcomeComparison& outcome, const Protocol& protocol, int decimals) {
  ConditionFigure figure;
  figure.decimals = decimals;
  figure.unit = outcome.unit.empty() ? "" : " " + outcome.unit;
  for (std::size_t place = 0; place < protocol.conditions.size() && place < outcome.table.k; ++place) {
    figure.columns.push_back(outcome.crossed ? column_of(outcome, place) : column_of_groups(outcome, place, protocol));
    const ConditionColumn& column = figure.columns.back();
    if (column.mean)
      figure.description +=
          fmt::format("{}: mean {}{}, median {}, {} of {} participants. ", condition_text(protocol, column.condition),
                      number_text(*column.mean, 2), figure.unit, number_text(*column.median, 2), column.points.size(),
                      column.participants);
  }
  return figure;
}

// "Left out: P03 (no answer), P07 (no answer)." Empty where none is.
std::string left_out_text(const OutcomeComparison& outcome) {
  constexpr std::size_t kMostNamed = 20;
  std::string names;
  for (std::size_t i = 0; i < outcome.left_out.size() && i < kMostNamed; ++i)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", outcome.left_out[i].participant,
                         outcome.left_out[i].reason);
  if (outcome.left_out.size() > kMostNamed) names += fmt::format(" and {} more", outcome.left_out.size() - kMostNamed);
  return names.empty() ? names : " Left out: " + names + ".";
}

bool has_no_participants(const OutcomeComparison& outcome) {
  return outcome.everyone.empty() || outcome.table.k == 0;
}

// What the marks are.
std::string_view marks_of(const ConditionFigure& figure) {
  const bool within = std::any_of(figure.columns.begin(), figure.columns.end(),
                                  [](const ConditionColumn& column) { return column.within.has_value(); });
  return within ? "Every participant, with the median, the mean and its 95 % confidence interval (Student t) and the "
                  "within-subject interval (Cousineau-Morey) for comparing conditions."
                : "Every participant, with the median, the mean and its 95 % confidence interval (Student t).";
}

}  // namespace

std::vector<Figure> outcome_figures(const StudyResults& results, const Protocol& protocol) {
  if (results.registered() == nullptr || !results.task.cells.empty()) return {};  // of pairs that is the JND's
  const OutcomeComparison& outcome = *results.registered();
  const bool negative =
      std::any_of(outcome.everyone.begin(), outcome.everyone.end(), [&](const ParticipantValues& one) {
        return (outcome.crossed ? one.missing.empty() : true) &&
               std::any_of(one.values.begin(), one.values.end(), [](double value) { return value < 0; });
      });
  if (negative || has_no_participants(outcome)) return {};  // the picture is for quantities that are never negative
  ConditionFigure figure = figure_of(outcome, protocol, 3);
  figure.id = "outcome";
  figure.title = fmt::format("{} by condition", capitalised(outcome.title));
  figure.y_title = outcome.unit.empty() ? outcome.title : fmt::format("{} ({})", outcome.title, outcome.unit);
  figure.joined = true;
  const std::string caption = fmt::format("{}. {}{}", results.task.outcomes[results.task.registered].meaning,
                                          marks_of(figure), left_out_text(outcome));
  return {{figure.id, figure.title, caption, draw_condition_figure(figure, protocol)}};
}

std::vector<Figure> time_figures(const StudyResults& results, const Protocol& protocol) {
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (outcome.outcome != "trial_time" || outcome.question || has_no_participants(outcome)) continue;
    ConditionFigure figure = figure_of(outcome, protocol, 2);
    figure.id = "time";
    figure.title = "Time per trial by condition";
    figure.y_title = fmt::format("time per trial ({})", outcome.unit);
    figure.joined = true;
    figure.from_zero = false;
    const std::string caption =
        fmt::format("Mean time per counted trial. {}{}", marks_of(figure), left_out_text(outcome));
    return {{figure.id, figure.title, caption, draw_condition_figure(figure, protocol)}};
  }
  return {};
}

std::vector<Figure> rating_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<Figure> figures;
  for (const OutcomeComparison& outcome : results.comparisons) {
    if (!outcome.question || has_no_participants(outcome)) continue;
    const auto question = std::find_if(protocol.questions.begin(), protocol.questions.end(),
                                       [&](const Question& one) { return one.id == outcome.outcome; });
    ConditionFigure figure = figure_of(outcome, protocol, 1);
    figure.id = fmt::format("rating-{}", figures.size() + 1);
    const bool rated = question != protocol.questions.end() && question->kind == Question::Kind::rating;
    figure.title = fmt::format("{} by condition: {}", rated ? "Ratings" : "Answers", outcome.outcome);
    figure.y_title = rated ? "rating" : "answer";
    std::string scale;
    if (rated && question->max > question->min) {
      // Half a step of room, so that the ratings at the ends of the scale can be seen whole.
      figure.scale = {question->min - 0.5, question->max + 0.5};
      if (question->max - question->min <= 12) figure.ticks = 12;
      scale = fmt::format(" Scale from {:g}{} to {:g}{}.", question->min,
                          question->low_label.empty() ? "" : " (" + question->low_label + ")", question->max,
                          question->high_label.empty() ? "" : " (" + question->high_label + ")");
    }
    for (ConditionColumn& column : figure.columns)
      for (const PublishedValue& value : protocol.published)
        // A published rating that names no question belongs to the first that was asked.
        if ((value.question.empty() ? figures.empty() : value.question == outcome.outcome) &&
            value.quantity == "rating" && value.condition == condition_text(protocol, column.condition)) {
          column.published = value.value;
          column.published_half_width = value.ci95_half_width;
        }
    const std::string caption = fmt::format("“{}”{} {} Points beside one another are equal answers.{}", outcome.title,
                                            scale, marks_of(figure), left_out_text(outcome));
    figures.push_back({figure.id, figure.title, caption, draw_condition_figure(figure, protocol)});
  }
  return figures;
}

}  // namespace jnd
