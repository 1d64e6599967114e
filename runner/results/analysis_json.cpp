#include <fmt/format.h>

#include "runner/results/analysis_text.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json cautions_json(const JndEstimate& estimate) {
  Json out = Json::array();
  for (const Caution caution : estimate.cautions) out.push_back(to_string(caution));
  return out;
}

std::string in_unit(const char* name, const Protocol& protocol) {
  return std::string(name).append(name_suffix(protocol.stimulus.unit));
}

Json cell_json(const CellResult& cell, const Protocol& protocol) {
  const Series& series = protocol.series[static_cast<std::size_t>(cell.series)];
  return {{"series", series.name},
          {in_unit("difference_", protocol), std::abs(series.pair[0] - series.pair[1])},
          {in_unit("delivered_difference_", protocol), json_number(cell.delivered_difference.mean)},
          {"n_delivered", cell.delivered_difference.n},
          {"n_without_fit", cell.without_fit},
          {in_unit("delivered_softer_", protocol), json_number(cell.delivered[0].mean)},
          {"n_softer", cell.delivered[0].n},
          {in_unit("delivered_stiffer_", protocol), json_number(cell.delivered[1].mean)},
          {"n_stiffer", cell.delivered[1].n},
          {"difference_source", to_string(cell.difference_source)},
          {"n_diff", cell.counts.n_diff},
          {"hits", cell.counts.hits},
          {"n_same", cell.counts.n_same},
          {"false_alarms", cell.counts.false_alarms},
          {"excluded", cell.excluded},
          {"missing", cell.missing},
          {"raw_hit_rate", json_number(cell.yes_no.raw_hit_rate)},
          {"raw_false_alarm_rate", json_number(cell.yes_no.raw_false_alarm_rate)},
          {"hit_rate", json_number(cell.yes_no.hit_rate)},
          {"false_alarm_rate", json_number(cell.yes_no.false_alarm_rate)},
          {"z_hit", json_number(cell.yes_no.z_hit)},
          {"z_false_alarm", json_number(cell.yes_no.z_false_alarm)},
          {"model", "yes-no"},  // whatever is registered: `--models all` has the others
          {"dprime", json_number(cell.yes_no.dprime)},
          {"se", json_number(cell.yes_no.se)},
          {"ci_low", json_number(cell.yes_no.ci_low)},
          {"ci_high", json_number(cell.yes_no.ci_high)},
          {"criterion", json_number(cell.yes_no.criterion)},
          {"ln_beta", json_number(cell.yes_no.ln_beta)},
          {"status", to_string(cell.yes_no.status)}};
}

Json group_json(const GroupResult& row, const Protocol& protocol) {
  const Condition& condition = protocol.conditions[static_cast<std::size_t>(row.condition)];
  Json out = {{"condition", condition.name},
              {"n_used", row.jnd.mean_jnd.n},
              {"n", row.jnd.n},
              {"difference_source", to_string(row.difference_source)},
              {"jnd", to_json(row.jnd.mean_jnd)},
              {"weber", to_json(row.jnd.mean_weber)},
              {"log_jnd", to_json(row.jnd.mean_log_jnd)},
              {"median_jnd", json_number(row.jnd.median_jnd)},
              {"median_status", to_string(row.jnd.median_status)},
              {"median_n", row.jnd.median_n},
              {"inverse_mean_slope", json_number(row.jnd.inverse_mean_slope)},
              {"slope_n", row.jnd.slope_n},
              {"no_sensitivity", row.jnd.no_sensitivity},
              {"ceiling", row.jnd.ceiling},
              {"no_information", row.jnd.no_information},
              {"published", Json::array()}};
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition.name && value.question.empty())
      out["published"].push_back({{"quantity", value.quantity}, {"value", value.value}});
  return out;
}

}  // namespace

Json to_json(const MeanEstimate& estimate) {
  return {{"n", estimate.n},
          {"mean", json_number(estimate.mean)},
          {"sd", json_number(estimate.sd)},
          {"ci_low", json_number(estimate.ci_low)},
          {"ci_high", json_number(estimate.ci_high)}};
}

Json to_json(const StudyAnalysis& analysis, const Protocol& protocol) {
  Json out = {{"kind", to_string(analysis.kind)},
              {"protocol_sha256", protocol.sha256},
              {"model", protocol.analysis.model},
              {"correction", protocol.analysis.correction},
              {"jnd_method", protocol.analysis.jnd_method},
              {"unit", to_string(protocol.stimulus.unit)},
              {"stiffness", to_string(analysis.by)},
              {"registered_stiffness", to_string(registered_source(protocol))},
              {in_unit("reference_", protocol), protocol.stimulus.reference},
              {"participants", Json::array()},
              {"group", Json::array()},
              {"exclusions", analysis.exclusions},
              {"heads", Json::array()}};
  // Cells come in the same order as thresholds: by participant, then condition.
  auto cell = analysis.cells.begin();
  for (const ThresholdResult& row : analysis.thresholds) {
    Json participant = {{"participant", row.participant},
                        {"condition", protocol.conditions[static_cast<std::size_t>(row.condition)].name},
                        {"slope", json_number(row.jnd.slope)},
                        {"jnd", json_number(row.jnd.jnd)},
                        {"weber", json_number(row.jnd.weber)},
                        {"ci_low", json_number(row.jnd.ci_low)},
                        {"ci_high", json_number(row.jnd.ci_high)},
                        {"slope_ci_low", json_number(row.jnd.slope_ci_low)},
                        {"slope_ci_high", json_number(row.jnd.slope_ci_high)},
                        {"method", to_string(row.jnd.method)},
                        {"status", to_string(row.jnd.status)},
                        {"cautions", cautions_json(row.jnd)},
                        {"series_used", row.jnd.series_used},
                        {"difference_source", to_string(row.difference_source)},
                        {"mean_trial_s", json_number(row.mean_trial_s)},
                        {"median_response_time_s", json_number(row.median_response_time_s)},
                        {"cells", Json::array()}};
    for (; cell != analysis.cells.end() && cell->participant == row.participant && cell->condition == row.condition;
         ++cell)
      participant["cells"].push_back(cell_json(*cell, protocol));
    out["participants"].push_back(participant);
  }
  for (const GroupResult& row : analysis.group) out["group"].push_back(group_json(row, protocol));
  for (const SessionHead& head : analysis.heads)
    out["heads"].push_back(
        {{"participant", head.participant}, {"session", head.session}, {"closed", head.closed}, {"hash", head.hash}});
  return out;
}

}  // namespace jnd
