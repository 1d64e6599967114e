// How well a cohort is balanced: what its plans, taken together, present how often.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

// Main trials of one condition in one series, over all participants.
struct CellBalance {
  int series = 0, condition = 0;  // places in the protocol
  std::array<int, 4> pairs{};     // (a, a), (b, b), (a, b), (b, a) with pair [a, b]
  int same = 0, different = 0;
  int participants = 0;               // who get the condition
  int least_same = 0, most_same = 0;  // of a single one
  // Of the tasks that have no pairs: how often each arrangement of stimuli comes, and each class of the task.
  std::map<std::vector<double>, int> arrangements{};
  std::vector<int> targets{};
};

struct OrderUse {
  std::vector<int> order;  // places in the protocol, as presented
  int participants = 0;
};

struct CohortBalance {
  std::optional<int> group;     // whose members alone are counted, place in Protocol::groups
  int participants = 0;         // counted
  std::vector<int> conditions;  // that they get: places in the protocol
  int session = 1;
  std::uint64_t seed = 0;
  std::vector<CellBalance> cells;          // series by series, conditions within
  std::vector<OrderUse> series_orders;     // those used, most used first
  std::vector<OrderUse> condition_orders;  // of the first presented series
  int different_pairs_of_orders = 0;       // (series order, condition order) that occur
  int most_used_pair = 0;                  // participants who share the commonest one
  // [condition][position]: participants' series in which the condition stands there; empty for mixed conditions.
  std::vector<std::vector<int>> condition_positions;
  std::vector<std::vector<int>> series_positions;  // [series][position]
  // [a][b]: how often condition a comes directly before b within a series; empty for mixed conditions.
  std::vector<std::vector<int>> condition_transitions;
  // With the paradigm explore, which has no series: [object][position], conditions' turns of all participants.
  std::vector<std::vector<int>> object_positions;
  std::vector<OrderUse> object_orders;
  int same = 0, different = 0;  // all main trials
  int group_size = 1;           // orders of each factor are equally used at its multiples; 0: random orders
  int pair_count = 1;           // pairs of orders are equally used at its multiples; 0: random orders
};

// The plans of participants 1..participants in their first session, or a later one; with a group, of its members among
// them. Throws std::invalid_argument where participants < 1 or session < 1.
CohortBalance balance_of_cohort(const Protocol& protocol, int participants, std::uint64_t seed, int session = 1,
                                std::optional<int> group = std::nullopt);

// How many participants it takes until each order of series and conditions, or of objects, has been used equally often
// in every group; 0: random orders.
int balanced_at(const Protocol& protocol);

// For people: at most 100 columns wide.
std::string to_text(const CohortBalance& balance, const Protocol& protocol);

}  // namespace jnd
