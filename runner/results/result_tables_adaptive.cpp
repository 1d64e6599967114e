// Tables of a study whose answers set the levels: thresholds of the conditions, and of everybody.
#include <cmath>

#include <fmt/format.h>

#include "data/results/adaptive_results.h"
#include "runner/results/result_table_parts.h"
#include "runner/terminal/number_text.h"

namespace jnd {

namespace {

std::string level_text(double level, const Protocol& protocol) {
  return number_text(level, protocol.stimulus.unit == StiffnessUnit::n_per_m ? 1 : 3);
}

// Of QUEST the posterior's standard deviation is of a logarithm: as a factor.
std::string sd_text(double sd, const Protocol& protocol) {
  if (std::isnan(sd)) return "-";
  return by_staircase(protocol) ? level_text(sd, protocol) : fmt::format("x/ {:.2f}", std::pow(10, sd));
}

std::string what_a_threshold_is(const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  return fmt::format(
      "Threshold: the difference from {:g} {} of which \"different\" is said in {:.1f} %; {}",
      protocol.stimulus.reference, to_string(protocol.stimulus.unit), 100 * adaptive_target(procedure),
      by_staircase(protocol)
          ? fmt::format("mean of the last {} reversals of each track", procedure.averaged_reversals / 2 * 2)
          : std::string("10 to the mean of the posterior of log10, its sd as a factor"));
}

}  // namespace

ResultTable adaptive_group_table(const AdaptiveResults& results, const Protocol& protocol) {
  ResultTable table{"group", "Thresholds of the conditions", what_a_threshold_is(protocol), {}, {}, {}};
  table.columns = {{"condition"},          {fmt::format("mean threshold {}", to_string(protocol.stimulus.unit)), true},
                   {"sd", true},           {"Weber", true},
                   {"false alarms", true}, {"n used", true}};
  for (const AdaptiveGroup& group : results.group)
    table.rows.push_back({condition_name(protocol, group.condition), level_text(group.mean, protocol),
                          level_text(group.sd, protocol), percent_text(group.mean / protocol.stimulus.reference),
                          percent_text(group.false_alarms), fmt::format("{} of {}", group.n, group.of)});
  table.remarks.emplace_back(
      "a threshold moves with the criterion: compare conditions where the false alarms are alike");
  if (protocol.design.procedure->catch_share == 0)
    table.remarks.emplace_back("without catch trials there is no false-alarm rate, and no d'");
  return table;
}

ResultTable adaptive_rows_table(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  ResultTable table{"participants", "Participants", "", {}, {}, {}};
  table.columns = {{"participant"},
                   {"condition"},
                   {"track", true},
                   {"trials", true},
                   {"hits", true},
                   {"catch", true},
                   {"false alarms", true},
                   {by_staircase(protocol) ? "reversals" : "posterior of", true},
                   {fmt::format("threshold {}", to_string(protocol.stimulus.unit)), true},
                   {"sd", true},
                   {"Weber", true},
                   {"status"}};
  for (const AdaptiveRow& row : results.rows) {
    if (row.track != 0 && !tracks) continue;
    table.rows.push_back(
        {row.participant, condition_name(protocol, row.condition), row.track == 0 ? "all" : std::to_string(row.track),
         std::to_string(row.trials), std::to_string(row.hits), std::to_string(row.catch_trials),
         percent_text(row.false_alarm_rate),
         !by_staircase(protocol) ? fmt::format("{} trials", row.threshold.n)
         : row.track == 0        ? fmt::format("{} averaged", row.threshold.n)
                                 : std::to_string(row.reversals.size()),
         level_text(row.threshold.threshold, protocol), sd_text(row.threshold.sd, protocol), percent_text(row.weber),
         fmt::format("{}{}", to_string(row.threshold.status), row.finished ? "" : ", not finished")});
  }
  return table;
}

}  // namespace jnd
