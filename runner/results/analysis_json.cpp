#include <fmt/format.h>

#include "data/fields/result_fields.h"
#include "runner/results/analysis_text.h"
#include "runner/results/field_output.h"
#include "runner/terminal/json_output.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;

Json cautions_json(const JndEstimate& estimate) {
  Json out = Json::array();
  for (const Caution caution : estimate.cautions) out.push_back(to_string(caution));
  return out;
}

Json published_json(const Protocol& protocol, const std::string& condition) {
  Json out = Json::array();
  for (const PublishedValue& value : protocol.published)
    if (value.condition == condition && value.question.empty())
      out.push_back({{"quantity", value.quantity}, {"value", value.value}});
  return out;
}

}  // namespace

Json heads_json(const Attendance& attendance) {
  Json out = Json::array();
  for (const SessionHead& head : attendance.heads)
    out.push_back(
        {{"participant", head.participant}, {"session", head.session}, {"closed", head.closed}, {"hash", head.hash}});
  return out;
}

Json to_json(const StudyAnalysis& analysis, const Protocol& protocol) {
  Json out = {{"kind", to_string(analysis.attendance.kind)},
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
              {"heads", heads_json(analysis.attendance)}};
  const auto cells = cell_fields(protocol);
  const auto thresholds = threshold_fields(protocol);
  const auto groups = group_fields(protocol, analysis.attendance.kind);
  // Cells come in the same order as thresholds: by participant, then condition.
  auto cell = analysis.cells.begin();
  for (const ThresholdResult& row : analysis.thresholds) {
    Json participant = json_of(thresholds, row,
                               {"participant", "condition", "slope", "jnd", "weber", "ci_low", "ci_high",
                                "slope_ci_low", "slope_ci_high", "method", "status"});
    if (!protocol.groups.empty()) add_json(participant, thresholds, row, {"group"});
    participant["cautions"] = cautions_json(row.jnd);
    add_json(participant, thresholds, row,
             {"series_used", "difference_source", "mean_trial_s", "median_response_time_s"});
    participant["cells"] = Json::array();
    for (; cell != analysis.cells.end() && cell->participant == row.participant && cell->condition == row.condition;
         ++cell)
      participant["cells"].push_back(json_of(cells, *cell,
                                             {"series",
                                              in_unit("difference_", protocol),
                                              "delivered_difference_*",
                                              "n_delivered",
                                              "n_without_fit",
                                              "delivered_softer_*",
                                              "n_softer",
                                              "delivered_stiffer_*",
                                              "n_stiffer",
                                              "difference_source",
                                              "n_diff",
                                              "hits",
                                              "n_same",
                                              "false_alarms",
                                              "excluded",
                                              "missing",
                                              "raw_*",
                                              "hit_rate",
                                              "false_alarm_rate",
                                              "z_*",
                                              "model",
                                              "dprime",
                                              "se",
                                              "ci_*",
                                              "criterion",
                                              "ln_beta",
                                              "status"}));
    out["participants"].push_back(participant);
  }
  for (const GroupResult& row : analysis.group) {
    Json group = json_of(
        groups, row,
        {"condition", "n_used", "n", "difference_source", "jnd.*", "weber.*", "log_jnd.*", "median_jnd",
         "median_status", "median_n", "inverse_mean_slope", "slope_n", "no_sensitivity", "ceiling", "no_information"});
    group["published"] = published_json(protocol, condition_name(protocol, row.condition));
    out["group"].push_back(group);
  }
  return out;
}

}  // namespace jnd
