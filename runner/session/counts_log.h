// A session log that keeps counts and forgets the rest: for large simulations without a study.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/detection/counts.h"
#include "data/log/session_log.h"
#include "data/results/study_analysis.h"
#include "protocols/protocol.h"

namespace jnd {

class CountsLog final : public SessionLog {
 public:
  void append(std::string_view kind, const nlohmann::ordered_json& body, Stamp stamp) override;
  std::vector<Event> events() const override { return {}; }
  // By condition, then series, as the protocol lists them.
  std::vector<CellCounts> cells(const Protocol& protocol, const std::string& participant,
                                std::optional<int> group = std::nullopt) const;

 private:
  std::map<std::pair<std::string, std::string>, Counts> counts_;  // condition and series names
};

}  // namespace jnd
