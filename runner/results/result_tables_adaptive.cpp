// Tables of a study whose answers set the levels: thresholds of the conditions, and of every participant.
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/result_fields.h"
#include "protocols/planning/track_threshold.h"
#include "runner/results/field_output.h"
#include "runner/results/result_format.h"
#include "runner/results/result_table_parts.h"
#include "runner/terminal/number_text.h"

namespace jnd {

namespace {

std::string what_a_threshold_is(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  const std::string_view unit = to_string(protocol.stimulus.unit);
  const ThresholdSource source = threshold_source(protocol);
  if (source == ThresholdSource::answers)
    return fmt::format(
        "Threshold: the JND, the difference from {:g} {} at d' = 1; exp of the mean of the posterior of ln JND, given all "
        "answers of a condition, its sd as a factor",
        protocol.stimulus.reference, unit);
  return fmt::format(
      "Threshold: the difference from {:g} {} of which \"different\" is said in {:.1f} %; {}",
      protocol.stimulus.reference, unit, 100 * adaptive_target(procedure).value_or(kNaN),
      source == ThresholdSource::reversals
          ? fmt::format("mean of the last {} reversals of each track", procedure.averaged_reversals / 2 * 2)
          : std::string("10 to the mean of the posterior of log10, its sd as a factor"));
}

}  // namespace

ResultTable adaptive_group_table(const AdaptiveResults& results, const Protocol& protocol) {
  ResultTable table{"group", "Thresholds of the conditions", what_a_threshold_is(protocol), {}, {}, {}};
  const TableMaker of(adaptive_group_fields(protocol));
  const auto weber = [&](const AdaptiveGroup& row) { return percent_text(row.mean / protocol.stimulus.reference); };
  table = of(std::move(table),
             {of("condition"), of("threshold_mean"), of("threshold_sd"), of.words("Weber", weber, true),
              of("false_alarm_rate"), of.share("n", "of", "n used")},
             results.group);
  // The response model has a criterion of its own.
  if (threshold_source(protocol) != ThresholdSource::answers)
    table.footnotes.emplace_back(
        "a threshold moves with the criterion: compare conditions where the false alarms are alike");
  if (protocol.design.procedure->catch_share == 0)
    table.footnotes.emplace_back("without catch trials there is no false-alarm rate, and no d'");
  return table;
}

ResultTable adaptive_rows_table(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  using Row = AdaptiveRow;
  const ThresholdSource source = threshold_source(protocol);
  const bool reversals = source == ThresholdSource::reversals;
  const TableMaker of(track_fields(protocol));
  const auto track = [&](const Row& row) { return row.track == 0 ? "all" : of.text("track", row); };
  const auto behind = [&](const Row& row) {
    return !reversals       ? fmt::format("{} trials", row.threshold.n)
           : row.track == 0 ? fmt::format("{} averaged", row.threshold.n)
                            : std::to_string(row.reversals.size());
  };
  // A posterior's standard deviation is of a logarithm: as a factor.
  const auto factor = [&](const Row& row) {
    const double sd = row.threshold.sd;
    return std::isnan(sd)
               ? "-"
               : fmt::format("x/ {:.2f}", source == ThresholdSource::quest ? std::pow(10, sd) : std::exp(sd));
  };
  const auto status = [&](const Row& row) {
    return joined(of.text("status", row) + (row.finished ? "" : ", not finished"), tracks_words(row.threshold.tracks));
  };
  std::vector<Row> rows = results.rows;
  if (!tracks) std::erase_if(rows, [](const Row& row) { return row.track != 0; });
  std::vector<TableColumn<Row>> columns = {of("participant")};
  if (!protocol.groups.empty()) columns.push_back(of("group"));
  columns.insert(columns.end(),
                 {of("condition"), of.words("track", track, true), of("trials"), of("hits"), of("catch_trials"),
                  of("false_alarm_rate"), of.words(reversals ? "reversals" : "posterior of", behind, true),
                  of("threshold"), reversals ? of("sd") : of.words("sd", factor, true)});
  if (source == ThresholdSource::answers) columns.push_back(of.range("ci_low", "ci_high", "95 %"));
  columns.insert(columns.end(), {of("weber"), of.words("status", status)});
  return of({"participants", "Participants", "", {}, {}, {}}, columns, rows);
}

}  // namespace jnd
