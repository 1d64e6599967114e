#include "runner/results/analysis_text.h"

#include <fmt/format.h>

#include "data/methods/verdict_text.h"
#include "runner/terminal/terminal.h"

namespace jnd {

using Json = nlohmann::ordered_json;

std::string answer_text(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol) {
  std::string text;
  for (const Block& block : blocks)
    if (const ResultTable table = answer_of(block); !table.rows.empty()) text += text_of(table);
  if (const std::string verdict = verdict_text(results, protocol); !verdict.empty())
    text += paragraph(verdict, "", bold) + "\n";
  return text;
}

std::string cautions_text(const StudyResults& results) {
  std::string text;
  for (const std::string& one : results.deviations) text += paragraph("deviation: " + one, "", warn);
  for (const std::string& one : results.cautions) text += paragraph("caution: " + one, "", warn);
  return text.empty() ? text : text + "\n";
}

std::string who_took_part(const StudyResults& results, const Protocol& protocol) {
  const Attendance& attendance = results.attendance;
  return fmt::format("{} {} participant{} ({} planned){}", attendance.participants, to_string(attendance.kind),
                     attendance.participants == 1 ? "" : "s", protocol.design.participants,
                     results.task.outcomes.empty() ? " after free interaction" : "");
}

Json to_json(const StudyResults& results, const std::vector<Block>& blocks, const Protocol& protocol) {
  const TaskResults& task = results.task;
  Json out = {{"kind", to_string(results.attendance.kind)},
              {"protocol_sha256", protocol.sha256},
              {"task", to_string(protocol.task.kind)},
              {"unit", to_string(protocol.stimulus.unit)},
              {"participants", results.attendance.participants},
              {"outcome", task.outcomes.empty() ? Json(nullptr) : Json(task.outcomes[task.registered].key)},
              {"verdict", verdict_text(results, protocol)},
              {"deviations", results.deviations},
              {"cautions", results.cautions},
              {"exclusions", task.exclusions},
              {"events_verified", results.chains.events},
              {"study_head", results.chains.study_head},
              {"heads", Json::array()}};
  if (!task.cells.empty()) {
    out["stiffness"] = to_string(task.pairs.by);
    out["registered_stiffness"] = to_string(registered_source(protocol));
  }
  for (const SessionHead& head : results.attendance.heads)
    out["heads"].push_back({{"participant", head.participant},
                            {"session", head.session},
                            {"closed", head.closed},
                            {"hash", head.hash.empty() ? Json(nullptr) : Json(head.hash)}});
  for (const Block& block : blocks) out[block.id] = json_rows(block);
  if (results.hierarchical) {
    const StudyHierarchical& model = *results.hierarchical;
    out["hierarchical_reason"] = model.reason.empty() ? Json(nullptr) : Json(model.reason);
    out["hierarchical_cautions"] = model.cautions;
  }
  return out;
}

}  // namespace jnd
