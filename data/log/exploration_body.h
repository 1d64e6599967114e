// What an exploration.* event holds: free interaction with one object in one condition.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/planning/plan.h"
#include "protocols/protocol.h"
#include "protocols/vocabulary.h"

namespace jnd {

// One attempt at it, as far as it came.
struct ExplorationRecord {
  ExplorationSlot slot;
  int attempt = 1;
  std::string condition;  // names
  std::string object;
  bool devices = true;                      // false: bare hands
  double duration_s = 0;                    // that the participant really had, without pauses
  std::vector<Presentation> presentations;  // piece by piece; none with bare hands
  bool ended_early = false;                 // by the operator, who lets it count
  std::string words;                        // the operator's, where there are any
};

// Of a slot without an attempt so far.
ExplorationRecord exploration_of(const Protocol& protocol, const ExplorationSlot& slot, int attempt);

// exploration.completed.
nlohmann::ordered_json to_body(const ExplorationRecord& record, Unit unit);
// exploration.voided: what became of the attempt, without its pieces but for the one that ended it in a fault, with the
// last ticks before that.
// counts: it uses up one of the attempts; will_repeat: it comes again.
nlohmann::ordered_json voided_body(const ExplorationRecord& record, Unit unit, std::string_view reason, bool counts,
                                   bool will_repeat);
// Of a completed one. Throws nlohmann::json::exception and StorageError.
ExplorationRecord exploration_from(const nlohmann::ordered_json& body, Unit unit);

}  // namespace jnd
