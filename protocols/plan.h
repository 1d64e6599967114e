// The plan of one participant: a pure function of (protocol, participant number, study seed).
#pragma once

#include <cstdint>
#include <vector>

#include "protocols/protocol.h"

namespace jnd {

struct Plan {
  int participant = 0;                             // number, from 1
  std::uint64_t seed = 0;                          // of the study
  std::vector<int> series_order;                   // places in Protocol::series
  std::vector<std::vector<int>> condition_orders;  // for each series in presented order: places in Protocol::conditions
  std::vector<Trial> trials;                       // practice rounds first (all that may be needed), then the main part
};

// Throws std::invalid_argument where participant < 1; a protocol that was loaded never fails otherwise.
Plan make_plan(const Protocol& protocol, int participant, std::uint64_t seed);

// How many trials the main part has: practice is not counted.
int main_trial_count(const Plan& plan) noexcept;

}  // namespace jnd
