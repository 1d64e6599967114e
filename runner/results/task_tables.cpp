// The tables and the JSON of what a task measures.
#include <algorithm>

#include <fmt/format.h>

#include "data/fields/task_fields.h"
#include "runner/results/analysis_text.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"
#include "runner/terminal/number_text.h"

namespace jnd {
namespace {

using Json = nlohmann::ordered_json;

bool has_several_standards(const Protocol& protocol) {
  return protocol.series.size() > 1;
}

// What is told of a participant's numbers.
std::string words_about(const TaskEstimateRow& row) {
  std::string text = row.estimates.status == "ok" ? "" : row.estimates.status;
  if (row.excluded > 0) text = joined(text, fmt::format("{} excluded", row.excluded));
  if (row.missing > 0) text = joined(text, fmt::format("{} not done", row.missing));
  return joined(text, tracks_words(row.estimates.tracks));
}

}  // namespace

ResultTable task_estimates_table(const TaskResults& results, const Protocol& protocol) {
  const TableMaker of(task_estimate_fields(protocol));
  std::vector<TableColumn<TaskEstimateRow>> columns = {of("participant")};
  if (!protocol.groups.empty()) columns.push_back(of("group"));
  columns.push_back(of("condition"));
  if (has_several_standards(protocol)) columns.push_back(of("standard"));
  columns.push_back(of("trials"));
  for (std::size_t i = 0; i < results.outcomes.size(); ++i) {
    const std::string key(results.outcomes[i].key);
    columns.push_back(of(key));
    if (i == results.registered) columns.push_back(of.range(key + "_ci95_low", key + "_ci95_high"));
  }
  columns.push_back(of("mean_trial_s"));
  columns.push_back(of.words("cautions", words_about));
  ResultTable table = of({"participants", "Participants", {}, {}, {}, {}}, columns, results.estimates);
  for (std::size_t i = table.rows.size(); i-- > 1;)  // a participant is named once
    if (table.rows[i].front() == table.rows[i - 1].front()) table.rows[i].front().clear();
  return table;
}

ResultTable task_group_table(const StudyResults& results, const TaskResults& measured, const Protocol& protocol) {
  const Attendance& attendance = attendance_of(results);
  const TableMaker of(task_group_fields(protocol, attendance.kind));
  std::vector<TableColumn<TaskGroupRow>> columns = {of("condition")};
  if (has_several_standards(protocol)) columns.push_back(of("standard"));
  columns.push_back(of.words("measure", [&](const TaskGroupRow& row) {
    const TaskOutcome& outcome = measured.outcomes[row.outcome];
    return fmt::format("{}{}{}{}", outcome.title, outcome.unit.empty() ? "" : " ", outcome.unit,
                       row.outcome == measured.registered ? " *" : "");
  }));
  columns.insert(columns.end(), {of.share("n_used", "participants", "n used"), of("mean"),
                                 of.range("ci95_low", "ci95_high"), of("sd"), of("median")});
  const auto published = [&](const TaskGroupRow& row) -> std::string {
    for (const PublishedValue& value : protocol.published)
      if (value.condition == condition_name(protocol, row.condition) &&
          value.quantity == measured.outcomes[row.outcome].key)
        return fmt::format("{:.4g}", value.value);
    return "";
  };
  if (!protocol.published.empty()) columns.push_back(of.words("published", published, true));
  ResultTable table =
      of({"group",
          fmt::format("Group ({}, {})", to_string(attendance.kind), counted(attendance.participants, "participant")),
          "*: the registered outcome; means with Student's 95 % interval",
          {},
          {},
          {}},
         columns, measured.group);
  for (const auto& [reason, trials] : measured.exclusions)
    table.footnotes.push_back(fmt::format("excluded by the registered rule {}: {} trials", reason, trials));
  return table;
}

namespace {

// Of a Weber fraction the difference behind it is looked at.
std::string_view proportional_title(const TaskResults& results) {
  const TaskOutcome& outcome = results.outcomes[results.registered];
  return outcome.of_standard ? "just-noticeable difference" : outcome.title;
}

}  // namespace

ResultTable proportion_table(const TaskResults& results, const Protocol& protocol) {
  const TableMaker of(proportion_fields(protocol));
  return of({"proportion",
             fmt::format("Is the {} proportional to the standard?", proportional_title(results)),
             "slope of its logarithm on that of the standard, of each participant; 1: Weber's law",
             {},
             {},
             {}},
            {of("condition"), of("n_used"), of("exponent"), of.range("ci95_low", "ci95_high"), of("p")},
            results.proportion);
}

ResultTable task_counts_table(const TaskResults& results, const Protocol& protocol) {
  const TableMaker of(task_count_fields(protocol));
  std::vector<TableColumn<TaskCountRow>> columns;
  for (const auto& field : task_count_fields(protocol))
    if (field.key != "kind") columns.push_back(of(field.key));
  return of({"cells", "Answers", "how often each answer was given to each arrangement of stimuli", {}, {}, {}}, columns,
            results.counts);
}

nlohmann::ordered_json task_json(const StudyResults& results, const TaskResults& measured, const Protocol& protocol) {
  const Attendance& attendance = attendance_of(results);
  Json out = {{"kind", to_string(attendance.kind)},
              {"protocol_sha256", protocol.sha256},
              {"task", to_string(protocol.task.kind)},
              {"unit", to_string(protocol.stimulus.unit)},
              {"outcome", measured.outcomes[measured.registered].key},
              {"participants", Json::array()},
              {"group", Json::array()},
              {"proportion", Json::array()},
              {"answers", Json::array()},
              {"exclusions", measured.exclusions},
              {"heads", heads_json(attendance)}};
  const auto estimates = task_estimate_fields(protocol);
  for (const TaskEstimateRow& row : measured.estimates) out["participants"].push_back(json_of(estimates, row, {"*"}));
  const auto groups = task_group_fields(protocol, attendance.kind);
  for (const TaskGroupRow& row : measured.group) out["group"].push_back(json_of(groups, row, {"*"}));
  const auto proportions = proportion_fields(protocol);
  for (const ProportionRow& row : measured.proportion) out["proportion"].push_back(json_of(proportions, row, {"*"}));
  const auto counts = task_count_fields(protocol);
  for (const TaskCountRow& row : measured.counts) out["answers"].push_back(json_of(counts, row, {"*"}));
  return out;
}

}  // namespace jnd
