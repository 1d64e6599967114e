#include "runner/session/counts_log.h"

#include "data/log/event_body.h"
#include "protocols/planning/allotment.h"
#include "protocols/tasks/same_different_task.h"

namespace jnd {

void CountsLog::append(std::string_view kind, const nlohmann::ordered_json& body, Stamp /*stamp*/) {
  if (kind != event_kind::kTrialCompleted || body.at("practice").get<bool>()) return;
  Counts& counts = counts_[{body.at("condition").get<std::string>(), body.at("series").get<std::string>()}];
  const int different = body.at("said").get<int>() == kClassDifferent ? 1 : 0;
  if (body.at("target").get<int>() == kClassSame) {
    ++counts.n_same;
    counts.false_alarms += different;
  } else {
    ++counts.n_diff;
    counts.hits += different;
  }
}

std::vector<CellCounts> CountsLog::cells(const Protocol& protocol, const std::string& participant,
                                         std::optional<int> group) const {
  std::vector<CellCounts> cells;
  for (const int condition : conditions_of(protocol, group)) {
    for (std::size_t series = 0; series < protocol.series.size(); ++series) {
      const auto found = counts_.find({condition_name(protocol, condition), protocol.series[series].name});
      cells.push_back(
          {participant, condition, static_cast<int>(series), found == counts_.end() ? Counts{} : found->second, group});
    }
  }
  return cells;
}

}  // namespace jnd
