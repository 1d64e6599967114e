// The plan of one participant: a pure function of (protocol, participant number, study seed).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// Free interaction with one object in one condition.
struct ExplorationSlot {
  int index = 0;      // place in the plan, from 1
  int block = 0;      // from 1: a condition's turn
  int condition = 0;  // place in Protocol::conditions
  int object = 0;     // place in Exploration::objects
  double duration_s = 0;
  bool operator==(const ExplorationSlot&) const = default;
};

struct Plan {
  int session = 1;                                 // of the participant, from 1
  int participant = 0;                             // number, from 1
  std::uint64_t seed = 0;                          // of the study
  std::optional<int> group;                        // place in Protocol::groups; none where there are none
  std::vector<int> conditions;                     // that the participant gets: places in Protocol::conditions
  std::vector<int> series_order;                   // places in Protocol::series
  std::vector<std::vector<int>> condition_orders;  // for each series in presented order: places in Protocol::conditions
  std::vector<ExplorationSlot> explorations;       // with the paradigm explore, which has no trials
  std::vector<Trial> trials;                       // practice rounds first (all that may be needed), then the main part
};

// session: which of the participant's sessions; each has orders and trials of its own. Throws std::invalid_argument
// where participant < 1 or session < 1; a protocol that was loaded never fails otherwise.
Plan make_plan(const Protocol& protocol, int participant, std::uint64_t seed, int session = 1);

// What practice presents: its series, with a procedure the difference that it has of its own.
Series practice_series(const Practice& practice, const Protocol& protocol);

// How many trials the main part has: practice is not counted.
int main_trial_count(const Plan& plan) noexcept;

}  // namespace jnd
