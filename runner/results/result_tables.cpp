#include "runner/results/result_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "data/fields/result_fields.h"
#include "data/results/threshold_method.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"
#include "runner/results/result_tables_questionnaire.h"
#include "runner/terminal/number_text.h"

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

std::vector<std::string> left_out_notes(const StudyAnalysis& analysis, const Protocol& protocol) {
  std::vector<std::string> notes;
  for (const GroupResult& row : analysis.group) {
    const JndGroup& jnd = row.jnd;
    const int left_out = jnd.no_sensitivity + jnd.ceiling + jnd.no_information;
    if (left_out == 0) continue;
    notes.push_back(fmt::format(
        "{}: the mean leaves out {} of {} ({} no_sensitivity, {} ceiling, {} no_information); the median keeps {} of "
        "them",
        condition_text(protocol, row.condition), left_out, jnd.n, jnd.no_sensitivity, jnd.ceiling, jnd.no_information,
        jnd.no_sensitivity + jnd.ceiling));
  }
  for (const GroupResult& row : analysis.group)
    if (const std::string caution = source_caution(row.difference_source, analysis); !caution.empty() && row.jnd.n > 0)
      notes.push_back(fmt::format("{}: {}: nothing was delivered that has a stiffness to fit",
                                  condition_text(protocol, row.condition), caution));
  for (const auto& [reason, trials] : analysis.exclusions)
    notes.push_back(fmt::format("excluded by the registered rule {}: {} trials", reason, trials));
  return notes;
}

}  // namespace

ResultTable participants_table(const StudyAnalysis& analysis, const Protocol& protocol) {
  ResultTable table{"participants", "Participants", method_note(analysis, protocol), {}, {}, {}};
  if (analysis.intervals) table.note += "; " + interval_note(analysis);
  const TableMaker of(threshold_fields(protocol));
  std::vector<TableColumn<ThresholdResult>> columns = {of("participant")};
  if (!protocol.groups.empty()) columns.push_back(of("group"));
  columns.insert(columns.end(), {of("condition"), of("slope"), of("jnd"), of.range("ci_low", "ci_high"), of("weber"),
                                 of("mean_trial_s"), of.words("cautions", [&](const ThresholdResult& row) {
                                   return joined(cautions_text(row.jnd),
                                                 source_caution(row.difference_source, analysis));
                                 })});
  table = of(std::move(table), columns, analysis.thresholds);
  // A participant is named once.
  for (std::size_t i = table.rows.size(); i-- > 1;)
    if (table.rows[i].front() == table.rows[i - 1].front()) table.rows[i].front().clear();
  return table;
}

ResultTable cells_table(const StudyAnalysis& analysis, const Protocol& protocol) {
  const auto cautions = [&](const CellResult& cell) {
    std::string note = cell.yes_no.status == RateStatus::ok ? "" : std::string(to_string(cell.yes_no.status));
    if (cell.excluded > 0) note = joined(note, fmt::format("{} excluded", cell.excluded));
    if (cell.missing > 0) note = joined(note, fmt::format("{} not done", cell.missing));
    if (cell.without_fit > 0 && cell.delivered_difference.n > 0)
      note = joined(note, fmt::format("{} without a delivered difference", cell.without_fit));
    return joined(note, source_caution(cell.difference_source, analysis));
  };
  const TableMaker of(cell_fields(protocol));
  return of({"cells",
             "Cells",
             fmt::format("yes-no d' = z(H) - z(F) on {} rates, raw rates beside them; 95 % CI after Gourevitch "
                         "and Galanter; c > 0 leans to \"same\"; stiffness differences as asked and as delivered",
                         protocol.analysis.correction),
             {},
             {},
             {}},
            {of("participant"), of("condition"), of("series"), of(in_unit("difference_", protocol)),
             of(in_unit("delivered_difference_", protocol)), of.share("hits", "n_diff", "hits", "/"),
             of.share("false_alarms", "n_same", "false alarms", "/"), of("raw_hit_rate"), of("raw_false_alarm_rate"),
             of("hit_rate"), of("false_alarm_rate"), of("z_hit"), of("z_false_alarm"), of("dprime"),
             of.range("ci_low", "ci_high"), of("criterion"), of.words("cautions", cautions)},
            analysis.cells);
}

ResultTable group_table(const StudyAnalysis& analysis, const Protocol& protocol) {
  const TableMaker of(group_fields(protocol, analysis.attendance.kind));
  using Row = GroupResult;
  const auto median = [&](const Row& row) { return median_text(row.jnd.median_status, row.jnd.median_jnd, protocol); };
  const auto geometric = [&](const Row& row) { return stiffness_text(std::exp(row.jnd.mean_log_jnd.mean), protocol); };
  const auto source_jnd = [&](const Row& row) { return published_jnd(protocol, of.text("condition", row)); };
  const auto source_weber = [&](const Row& row) {
    const PublishedValue* weber = published(protocol, of.text("condition", row), "weber");
    return weber == nullptr ? "" : percent_text(weber->value);
  };
  std::vector<TableColumn<Row>> columns = {of("condition"),
                                           of.share("n_used", "n", "n used"),
                                           of("jnd.mean"),
                                           of.range("jnd.ci_low", "jnd.ci_high"),
                                           of.words("median", median, true),
                                           of.words("exp(mean log)", geometric, true),
                                           of("inverse_mean_slope"),
                                           of("weber.mean")};
  const auto has = [](const auto& words) { return [words](const Row& row) { return !words(row).empty(); }; };
  if (std::any_of(analysis.group.begin(), analysis.group.end(), has(source_jnd)) ||
      std::any_of(analysis.group.begin(), analysis.group.end(), has(source_weber))) {
    columns.push_back(of.words("published JND", source_jnd, true));
    columns.push_back(of.words("Weber", source_weber, true));
  }
  return of({"group",
             fmt::format("Group ({}, {})", to_string(analysis.attendance.kind),
                         counted(analysis.attendance.participants, "participant")),
             method_note(analysis, protocol),
             {},
             {},
             left_out_notes(analysis, protocol)},
            columns, analysis.group);
}

namespace {

// In the order in which they are read.
struct TablesOf {
  const StudyResults& results;
  const Protocol& protocol;

  std::vector<ResultTable> operator()(const ConstantResults& measured) const {
    const StudyAnalysis& analysis = measured.analysis;
    return {participants_table(analysis, protocol),
            hierarchical_people_table(results, protocol),
            group_table(analysis, protocol),
            contrasts_table(results, protocol),
            groups_table(results, protocol),
            between_table(results, protocol),
            omnibus_table(results, protocol),
            pairs_table(results, protocol),
            series_table(measured, protocol),
            hierarchical_table(results, protocol),
            hierarchical_ratios_table(results, protocol),
            hierarchical_check_table(results, protocol),
            hierarchical_variants_table(results, protocol),
            hierarchical_variant_jnds_table(results, protocol),
            sensitivity_table(measured, protocol),
            sureness_table(measured, protocol),
            behaviour_table(measured, protocol),
            cues_table(measured, protocol),
            items_table(results, protocol),
            ratings_table(results, protocol),
            cells_table(analysis, protocol)};
  }
  std::vector<ResultTable> operator()(const AdaptiveResults& measured) const {
    return {adaptive_rows_table(measured, protocol, true),
            hierarchical_people_table(results, protocol),
            adaptive_group_table(measured, protocol),
            contrasts_table(results, protocol),
            groups_table(results, protocol),
            between_table(results, protocol),
            omnibus_table(results, protocol),
            pairs_table(results, protocol),
            hierarchical_table(results, protocol),
            hierarchical_ratios_table(results, protocol),
            hierarchical_check_table(results, protocol),
            hierarchical_variants_table(results, protocol),
            hierarchical_variant_jnds_table(results, protocol),
            items_table(results, protocol),
            ratings_table(results, protocol)};
  }
  std::vector<ResultTable> operator()(const MeasuredTask& measured) const {
    return {task_estimates_table(measured.task, protocol),
            hierarchical_people_table(results, protocol),
            task_group_table(results, measured.task, protocol),
            contrasts_table(results, protocol),
            groups_table(results, protocol),
            between_table(results, protocol),
            omnibus_table(results, protocol),
            pairs_table(results, protocol),
            hierarchical_table(results, protocol),
            hierarchical_ratios_table(results, protocol),
            hierarchical_check_table(results, protocol),
            hierarchical_variants_table(results, protocol),
            hierarchical_variant_jnds_table(results, protocol),
            proportion_table(measured.task, protocol),
            items_table(results, protocol),
            ratings_table(results, protocol),
            task_counts_table(measured.task, protocol)};
  }
  std::vector<ResultTable> operator()(const ExplorationResults& measured) const {
    return questionnaire_tables(results.questionnaire, measured, protocol);
  }
};

}  // namespace

Section section_of(const ResultTable& table) {
  constexpr std::array<std::pair<std::string_view, Section>, 20> kSections = {
      {{"participants", Section::participants},
       {"group", Section::participants},
       {"contrasts", Section::tests},
       {"groups", Section::tests},
       {"between", Section::tests},
       {"tests", Section::tests},
       {"pairs", Section::tests},
       {"series", Section::tests},
       {"hierarchical-people", Section::participants},
       {"hierarchical", Section::tests},
       {"hierarchical-ratios", Section::tests},
       {"hierarchical-check", Section::tests},
       {"hierarchical-variants", Section::tests},
       {"hierarchical-variant-jnds", Section::tests},
       {"proportion", Section::tests},
       {"sensitivity", Section::models},
       {"models", Section::models},
       {"behaviour", Section::behaviour},
       {"cues", Section::behaviour},
       {"sureness", Section::behaviour}}};
  for (const auto& [id, section] : kSections)
    if (table.id == id) return section;
  return table.id == "cells" ? Section::cells : Section::questions;
}

std::vector<ResultTable> result_tables(const StudyResults& results, const Protocol& protocol) {
  std::vector<ResultTable> tables = std::visit(TablesOf{results, protocol}, results.measured);
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

}  // namespace jnd
