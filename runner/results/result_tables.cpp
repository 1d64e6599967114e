#include "runner/results/result_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "data/results/threshold_method.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"
#include "runner/results/result_tables_questionnaire.h"

namespace jnd {

namespace {

std::string cautions_text(const JndEstimate& estimate) {
  std::string text;
  if (estimate.status != JndStatus::ok) text = to_string(estimate.status);
  for (const Caution caution : estimate.cautions) {
    // Every participant of a short design has too few trials; a caution of the study says it once.
    if (caution != Caution::few_trials) text = joined(text, std::string(to_string(caution)));
  }
  return text;
}

const PublishedValue* published(const Protocol& protocol, const std::string& condition, const std::string& quantity) {
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.quantity == quantity) return &value;
  return nullptr;
}

std::string published_jnd(const Protocol& protocol, const std::string& condition) {
  const PublishedValue* value = published(protocol, condition, "jnd");
  if (value == nullptr) return "";
  if (value->ci95_half_width)
    return stiffness_text(value->value, protocol) + " ± " + stiffness_text(*value->ci95_half_width, protocol);
  return stiffness_text(value->value, protocol);
}

std::string method_note(const StudyAnalysis& analysis, const Protocol& protocol) {
  return fmt::format("JND: {}, through the origin of the {} stiffness differences; Weber fraction = JND / {:g} {}",
                     describe(analysis.method), to_string(analysis.by), protocol.stimulus.reference, unit_of(protocol));
}

std::string interval_note(const StudyAnalysis& analysis) {
  if (is_maximum_likelihood(analysis.method.method)) return "95 % CI: profile likelihood";
  if (analysis.intervals && analysis.method.method == JndMethod::least_squares)
    return "95 % CI: parametric bootstrap, 2000 replicates";
  return "no interval for this method";
}

std::vector<std::string> left_out_remarks(const StudyAnalysis& analysis, const Protocol& protocol) {
  std::vector<std::string> remarks;
  for (const GroupResult& row : analysis.group) {
    const JndGroup& jnd = row.jnd;
    const int left_out = jnd.no_sensitivity + jnd.ceiling + jnd.no_information;
    if (left_out == 0) continue;
    remarks.push_back(fmt::format(
        "{}: the mean leaves out {} of {} ({} no_sensitivity, {} ceiling, {} no_information); the median keeps {} of "
        "them",
        condition_text(protocol, row.condition), left_out, jnd.n, jnd.no_sensitivity, jnd.ceiling, jnd.no_information,
        jnd.no_sensitivity + jnd.ceiling));
  }
  for (const GroupResult& row : analysis.group)
    if (const std::string remark = source_remark(row.difference_source, analysis); !remark.empty() && row.jnd.n > 0)
      remarks.push_back(fmt::format("{}: {}: nothing was delivered that has a stiffness to fit",
                                    condition_text(protocol, row.condition), remark));
  for (const auto& [reason, trials] : analysis.exclusions)
    remarks.push_back(fmt::format("excluded by the registered rule {}: {} trials", reason, trials));
  return remarks;
}

}  // namespace

ResultTable participants_table(const StudyResults& results, const Protocol& protocol) {
  const StudyAnalysis& analysis = results.analysis;
  ResultTable table{"participants", "Participants", method_note(analysis, protocol), {}, {}, {}};
  if (analysis.intervals) table.note += "; " + interval_note(analysis);
  table.columns = {{"participant"},
                   {"condition"},
                   {fmt::format("d' per {} {}", slope_step(protocol), unit_of(protocol)), true},
                   {fmt::format("JND {}", unit_of(protocol)), true},
                   {"95 % CI", true},
                   {"Weber", true},
                   {"s a trial", true},
                   {"remarks"}};
  std::string last;
  for (const ThresholdResult& row : analysis.thresholds) {
    table.rows.push_back({row.participant == last ? "" : row.participant, condition_text(protocol, row.condition),
                          number_text(slope_step(protocol) * row.jnd.slope, 3), stiffness_text(row.jnd.jnd, protocol),
                          range_text(row.jnd.ci_low, row.jnd.ci_high, stiffness_decimals(protocol)),
                          percent_text(row.jnd.weber), number_text(row.mean_trial_s, 1),
                          joined(cautions_text(row.jnd), source_remark(row.difference_source, analysis))});
    last = row.participant;
  }
  return table;
}

ResultTable cells_table(const StudyResults& results, const Protocol& protocol) {
  const StudyAnalysis& analysis = results.analysis;
  ResultTable table{
      "cells",
      "Cells",
      fmt::format("yes-no d' = z(H) - z(F) on {} rates, raw rates beside them; 95 % CI after Gourevitch "
                  "and Galanter; c > 0 leans to \"same\"; stiffness differences as asked and as delivered",
                  protocol.analysis.correction),
      {},
      {},
      {}};
  table.columns = {{"participant"},
                   {"condition"},
                   {"series"},
                   {fmt::format("asked {}", unit_of(protocol)), true},
                   {"delivered", true},
                   {"hits", true},
                   {"false alarms", true},
                   {"raw H", true},
                   {"raw F", true},
                   {"H", true},
                   {"F", true},
                   {"z(H)", true},
                   {"z(F)", true},
                   {"d'", true},
                   {"95 % CI", true},
                   {"c", true},
                   {"remarks"}};
  for (const CellResult& cell : analysis.cells) {
    const YesNo& d = cell.yes_no;
    std::string note = d.status == RateStatus::ok ? "" : std::string(to_string(d.status));
    if (cell.excluded > 0) note = joined(note, fmt::format("{} excluded", cell.excluded));
    if (cell.missing > 0) note = joined(note, fmt::format("{} not done", cell.missing));
    if (cell.without_fit > 0 && cell.delivered_difference.n > 0)
      note = joined(note, fmt::format("{} without a delivered difference", cell.without_fit));
    note = joined(note, source_remark(cell.difference_source, analysis));
    const Series& series = protocol.series[static_cast<std::size_t>(cell.series)];
    table.rows.push_back({cell.participant, condition_text(protocol, cell.condition), series.name,
                          stiffness_text(std::abs(series.pair[1] - series.pair[0]), protocol),
                          stiffness_text(cell.delivered_difference.mean, protocol),
                          fmt::format("{}/{}", cell.counts.hits, cell.counts.n_diff),
                          fmt::format("{}/{}", cell.counts.false_alarms, cell.counts.n_same),
                          number_text(d.raw_hit_rate, 3), number_text(d.raw_false_alarm_rate, 3),
                          number_text(d.hit_rate, 3), number_text(d.false_alarm_rate, 3), number_text(d.z_hit, 3),
                          number_text(d.z_false_alarm, 3), number_text(d.dprime, 3), range_text(d.ci_low, d.ci_high, 2),
                          number_text(d.criterion, 3), note});
  }
  return table;
}

ResultTable group_table(const StudyResults& results, const Protocol& protocol) {
  const StudyAnalysis& analysis = results.analysis;
  ResultTable table{"group",
                    fmt::format("Group ({}, {} participants)", to_string(analysis.kind), analysis.participants),
                    method_note(analysis, protocol),
                    {},
                    {},
                    left_out_remarks(analysis, protocol)};
  table.columns = {{"condition"},           {"n used", true},        {"mean JND", true},     {"95 % CI", true},
                   {"median", true},        {"exp(mean log)", true}, {"1/mean slope", true}, {"mean Weber", true},
                   {"published JND", true}, {"Weber", true}};
  for (const GroupResult& row : analysis.group) {
    const std::string& condition = condition_text(protocol, row.condition);
    const JndGroup& jnd = row.jnd;
    const PublishedValue* weber = published(protocol, condition, "weber");
    table.rows.push_back({condition, fmt::format("{} of {}", jnd.mean_jnd.n, jnd.n),
                          stiffness_text(jnd.mean_jnd.mean, protocol),
                          range_text(jnd.mean_jnd.ci_low, jnd.mean_jnd.ci_high, stiffness_decimals(protocol)),
                          median_text(jnd.median_status, jnd.median_jnd, protocol),
                          stiffness_text(std::exp(jnd.mean_log_jnd.mean), protocol),
                          stiffness_text(jnd.inverse_mean_slope, protocol), percent_text(jnd.mean_weber.mean),
                          published_jnd(protocol, condition), weber == nullptr ? "" : percent_text(weber->value)});
  }
  const bool any_published = std::any_of(table.rows.begin(), table.rows.end(),
                                         [](const auto& row) { return !row[8].empty() || !row[9].empty(); });
  if (!any_published) {
    table.columns.resize(8);
    for (auto& row : table.rows) row.resize(8);
  }
  return table;
}

std::vector<ResultTable> result_tables(const StudyResults& results, const Protocol& protocol) {
  if (results.questionnaire) return questionnaire_tables(*results.questionnaire, protocol);
  std::vector<ResultTable> tables;
  if (results.adaptive) {
    tables.push_back(adaptive_rows_table(*results.adaptive, protocol, true));
    tables.push_back(adaptive_group_table(*results.adaptive, protocol));
    for (const auto make : {contrasts_table, omnibus_table, pairs_table, items_table, ratings_table}) {
      ResultTable table = make(results, protocol);
      if (!table.rows.empty()) tables.push_back(std::move(table));
    }
    return tables;
  }
  for (const auto make : {participants_table, group_table, contrasts_table, omnibus_table, pairs_table, series_table,
                          sensitivity_table, behaviour_table, cues_table, items_table, ratings_table, cells_table}) {
    ResultTable table = make(results, protocol);
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace jnd
