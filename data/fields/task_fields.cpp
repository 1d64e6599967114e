#include "data/fields/task_fields.h"

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/between_fields.h"
#include "data/fields/result_fields.h"
#include "protocols/planning/track_threshold.h"

namespace jnd {
namespace {

constexpr const char* kTaskKinds = "real pilot simulated";

template <typename Row>
Field<Row> condition_of_row(const Protocol& protocol) {
  return {"condition", "condition", [&protocol](const Row& row) { return condition_name(protocol, row.condition); }};
}

template <typename Row>
Field<Row> series_of_row(const Protocol& protocol) {
  return {"standard", "name of the standard; \"all\" where the task has none",
          [&protocol](const Row& row) { return protocol.series[static_cast<std::size_t>(row.series)].name; }};
}

template <typename Row>
Field<Row> standard_of_row(const Protocol& protocol) {
  return {in_unit("standard_", protocol),
          "its value; empty where the task has none",
          [&protocol](const Row& row) -> std::optional<double> {
            if (!task_of(protocol.task.kind).has_standard() && !protocol.task.modulus) return std::nullopt;
            return protocol.series[static_cast<std::size_t>(row.series)].standard;
          },
          {.unit = to_string(protocol.stimulus.unit), .title = "value"}};
}

const TaskOutcome& outcome_at(const std::vector<TaskOutcome>& outcomes, std::size_t place) {
  return outcomes[place];
}

}  // namespace

Fields<TaskCountRow> task_count_fields(const Protocol& protocol) {
  using R = TaskCountRow;
  using F = Field<R>;
  const std::string unit(to_string(protocol.stimulus.unit));
  Fields<R> fields = {F("participant", "code of the participant", &R::participant),
                      F("kind", "kind of the sessions", &R::kind, {.levels = kTaskKinds}),
                      condition_of_row<R>(protocol), series_of_row<R>(protocol), standard_of_row<R>(protocol)};
  for (int i = 0; i < task_of(protocol.task.kind).intervals(protocol.task); ++i)
    fields.push_back(
        F(in_unit(fmt::format("stimulus_{}_", i + 1), protocol), fmt::format("asked in interval {}", i + 1),
          [i](const R& r) -> std::optional<double> {
            const auto place = static_cast<std::size_t>(i);
            return place < r.stimuli.size() ? std::optional(r.stimuli[place]) : std::nullopt;
          },
          {.unit = unit, .title = fmt::format("interval {}", i + 1), .digits = 4, .shown = Shown::compact}));
  std::string words;
  const bool adjusts = task_of(protocol.task.kind).adjusts();
  if (!adjusts)  // its answers only move what is presented
    for (const std::string& word : protocol.task.classes) words.append(words.empty() ? "" : " ").append(word);
  fields.push_back(F("target", "the answer that is correct; empty where none is",
                     [&protocol](const R& r) { return std::string(said_word(protocol.task, r.target)); },
                     {.levels = words, .title = "correct"}));
  fields.push_back(F("answer", "what was answered",
                     [&protocol](const R& r) {
                       return r.number ? FieldValue(*r.number)
                                       : FieldValue(std::string(said_word(protocol.task, r.said)));
                     },
                     {.levels = words, .type = words.empty() ? CellType::number : CellType::text}));
  if (protocol.task.sureness_levels > 0) fields.push_back(F("sureness", "how sure of it, from 1", &R::sureness));
  fields.push_back(F("n", "how often", &R::n));
  add_group_field(fields, protocol);
  return fields;
}

Fields<TaskEstimateRow> task_estimate_fields(const Protocol& protocol) {
  using R = TaskEstimateRow;
  using F = Field<R>;
  Fields<R> fields = {F("participant", "code of the participant", &R::participant),
                      F("kind", "kind of the sessions", &R::kind, {.levels = kTaskKinds}),
                      condition_of_row<R>(protocol),
                      series_of_row<R>(protocol),
                      standard_of_row<R>(protocol),
                      F("trials", "counted trials", &R::trials),
                      F("excluded", "trials left out by the registered rules", &R::excluded),
                      F("missing", "planned trials without an answer", &R::missing),
                      F("status", "what the estimates are; methods.md says what each status means",
                        [](const R& r) { return r.estimates.status; })};
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const TaskOutcome& outcome = outcomes[i];
    const std::string key(outcome.key), unit(outcome.unit), title(outcome.title);
    fields.push_back(
        F(key, outcome.meaning, [i](const R& r) { return r.estimates.values[i].value.value_or(kNaN); },
          {.unit = unit, .title = unit.empty() ? title : fmt::format("{} {}", title, unit), .shown = Shown::compact}));
    fields.push_back(F(key + "_ci95_low", "lower end of its 95 % interval; empty where it has none",
                       [i](const R& r) { return r.estimates.values[i].low.value_or(kNaN); },
                       {.unit = unit, .shown = Shown::compact}));
    fields.push_back(F(key + "_ci95_high", "upper end",
                       [i](const R& r) { return r.estimates.values[i].high.value_or(kNaN); },
                       {.unit = unit, .shown = Shown::compact}));
  }
  if (outcomes.back().key == kTrackThreshold) add_track_fields(fields, [](const R& r) { return r.estimates.tracks; });
  fields.push_back(F("median_response_time_s", "median of the times that the participant entered; empty without one",
                     &R::median_response_time_s, {.unit = "s"}));
  fields.push_back(F("mean_trial_s", "mean time of a counted trial; empty without one", &R::mean_trial_s,
                     {.unit = "s", .title = "s per trial", .digits = 1}));
  add_group_field(fields, protocol);
  return fields;
}

Fields<TaskGroupRow> task_group_fields(const Protocol& protocol, SessionKind kind) {
  using R = TaskGroupRow;
  using F = Field<R>;
  const std::vector<TaskOutcome> outcomes = measured_outcomes(protocol);
  const FieldTraits number{.shown = Shown::compact};
  return {condition_of_row<R>(protocol),
          series_of_row<R>(protocol),
          standard_of_row<R>(protocol),
          F("kind", "kind of the sessions", [kind](const R&) { return kind; }, {.levels = kTaskKinds}),
          F("outcome", "what was measured",
            [outcomes](const R& r) { return std::string(outcome_at(outcomes, r.outcome).key); }),
          F("unit", "unit of the numbers of this row; empty for none",
            [outcomes](const R& r) { return std::string(outcome_at(outcomes, r.outcome).unit); }),
          F("participants", "all participants", &R::participants),
          F("n_used", "those who have a value", [](const R& r) { return r.mean.n; }),
          F(
              "mean", "mean over them", [](const R& r) { return r.mean.mean; }, number),
          F(
              "sd", "standard deviation, n - 1", [](const R& r) { return r.mean.sd; }, number),
          F(
              "ci95_low", "lower end of Student's 95 % interval of the mean", [](const R& r) { return r.mean.ci_low; },
              number),
          F(
              "ci95_high", "upper end", [](const R& r) { return r.mean.ci_high; }, number),
          F("median", "median over them", &R::median, number)};
}

Fields<ProportionRow> proportion_fields(const Protocol& protocol) {
  using R = ProportionRow;
  using F = Field<R>;
  return {
      condition_of_row<R>(protocol),
      F("outcome", "what was measured", [&protocol](const R&) { return protocol.analysis.outcome; }),
      F("n_used", "participants who have a value at every standard", [](const R& r) { return r.exponent.n; }),
      F("exponent",
        "mean slope of its logarithm (of a Weber fraction: of its JND) on that of the standard; 1: proportional (Weber's law)",
        [](const R& r) { return r.exponent.mean; }),
      F("ci95_low", "lower end of Student's 95 % interval", [](const R& r) { return r.exponent.ci_low; }),
      F("ci95_high", "upper end", [](const R& r) { return r.exponent.ci_high; }),
      F("p", "of an exponent of 1, Student's t", &R::p, {.title = "p of 1", .shown = Shown::p_value})};
}

}  // namespace jnd
