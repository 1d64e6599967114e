#include "runner/results/adaptive_text.h"

#include <cmath>

#include <fmt/format.h>

#include "data/results/adaptive_results.h"
#include "runner/results/analysis_text.h"
#include "runner/results/result_table_parts.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const AdaptiveRow& row, const Protocol& protocol) {
  const auto rate = [](int count, int of) { return json_number(of > 0 ? static_cast<double>(count) / of : NAN); };
  Json out = {{"participant", row.participant},
              {"kind", to_string(row.kind)},
              {"condition", condition_name(protocol, row.condition)},
              {"track", row.track == 0 ? Json(nullptr) : Json(row.track)},
              {"finished", row.finished},
              {"trials", row.trials},
              {"hits", row.hits},
              {"hit_rate", rate(row.hits, row.trials)},
              {"catch_trials", row.catch_trials},
              {"false_alarms", row.false_alarms},
              {"false_alarm_rate", json_number(row.false_alarm_rate)},
              {"threshold", json_number(row.threshold.threshold)},
              {by_staircase(protocol) ? "sd" : "sd_log10", json_number(row.threshold.sd)},
              {"n", row.threshold.n},
              {"weber", json_number(row.weber)},
              {"status", to_string(row.threshold.status)}};
  if (row.track != 0) out["levels"] = row.levels;
  if (row.track != 0 && by_staircase(protocol)) out["reversals"] = row.reversals;
  return out;
}

}  // namespace

std::string to_text(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  return fmt::format("{}\n{}{}", bold(printable(protocol.title)), text_of(adaptive_group_table(results, protocol)),
                     text_of(adaptive_rows_table(results, protocol, tracks)));
}

Json to_json(const AdaptiveResults& results, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  Json out = {{"kind", to_string(results.kind)},
              {"protocol_sha256", protocol.sha256},
              {"unit", to_string(protocol.stimulus.unit)},
              {"reference", protocol.stimulus.reference},
              {"procedure",
               {{"kind", by_staircase(protocol) ? "staircase" : "quest"},
                {"target", json_number(adaptive_target(procedure))},
                {"clamp", procedure.clamp},
                {"catch_share", procedure.catch_share}}}};
  out["group"] = Json::array();
  for (const AdaptiveGroup& group : results.group)
    out["group"].push_back({{"condition", condition_name(protocol, group.condition)},
                            {"n", group.n},
                            {"of", group.of},
                            {"threshold_mean", json_number(group.mean)},
                            {"threshold_sd", json_number(group.sd)},
                            {"false_alarm_rate", json_number(group.false_alarms)}});
  out["rows"] = Json::array();
  for (const AdaptiveRow& row : results.rows) out["rows"].push_back(json_of(row, protocol));
  return out;
}

}  // namespace jnd
