#include "runner/results/adaptive_text.h"

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "data/fields/result_fields.h"
#include "protocols/planning/adaptive_run.h"
#include "protocols/planning/track_threshold.h"
#include "runner/results/analysis_text.h"
#include "runner/results/field_output.h"
#include "runner/results/result_table_parts.h"
#include "runner/terminal/json_output.h"
#include "runner/terminal/terminal.h"

namespace jnd {

using Json = nlohmann::ordered_json;

std::string to_text(const AdaptiveResults& results, const Protocol& protocol, bool tracks) {
  return fmt::format("{}\n{}{}", bold(printable(protocol.title)), text_of(adaptive_group_table(results, protocol)),
                     text_of(adaptive_rows_table(results, protocol, tracks)));
}

Json to_json(const AdaptiveResults& results, const Protocol& protocol) {
  const AdaptiveProcedure& procedure = *protocol.design.procedure;
  Json out = {{"kind", to_string(results.attendance.kind)},
              {"protocol_sha256", protocol.sha256},
              {"unit", to_string(protocol.stimulus.unit)},
              {"reference", protocol.stimulus.reference},
              {"procedure",
               {{"kind", to_string(procedure.kind)},
                {"target", json_number(adaptive_target(procedure).value_or(kNaN))},
                {"clamp", procedure.clamp},
                {"catch_share", procedure.catch_share}}}};
  if (procedure.joint_likelihood) out["procedure"]["threshold"] = "joint-likelihood";
  const auto groups = adaptive_group_fields(protocol);
  const auto tracks = track_fields(protocol);
  out["group"] = Json::array();
  for (const AdaptiveGroup& group : results.group) out["group"].push_back(json_of(groups, group, {"*"}));
  out["rows"] = Json::array();
  for (const AdaptiveRow& row : results.rows) {
    out["rows"].push_back(json_of(tracks, row, {"*"}));
    if (row.track != 0) out["rows"].back()["levels"] = row.levels;
    if (row.track != 0 && procedure.kind == AdaptiveProcedure::Kind::staircase)
      out["rows"].back()["reversals"] = row.reversals;
  }
  return out;
}

}  // namespace jnd
