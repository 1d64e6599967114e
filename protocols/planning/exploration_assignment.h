// Who explores what when: orders of conditions and objects, and their assignment to participants.
//
// Conditions have the order that the design asks for. Objects have the orders of a Williams square, the same in each of
// a participant's conditions, so that the conditions are compared over equal orders. The two factors are assigned as
// series and conditions of trials are (protocols/planning/order.h): with A orders of conditions and B of objects, every
// lcm(A, B) participants use each order of either equally often, so that each object comes first equally often, and all
// A B pairs occur before any repeats.
#pragma once

#include <cstdint>
#include <vector>

#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"

namespace jnd {

class ExplorationAssignment {
 public:
  // protocol: as loaded, with the paradigm explore. session: from 1.
  ExplorationAssignment(const Protocol& protocol, std::uint64_t study_seed, int session = 1);

  // participant: from 1. Places in Protocol::conditions and Exploration::objects.
  std::vector<int> condition_order(int participant) const;
  std::vector<int> object_order(int participant) const;
  // Blocks of conditions, in each the objects for equal parts of the duration.
  std::vector<ExplorationSlot> slots(int participant) const;

  // Every so many participants each order has been used equally often, and each pair of orders once; 0: random orders.
  int group_size() const noexcept;
  int pair_count() const noexcept;

 private:
  const Protocol& protocol_;
  std::uint64_t seed_;
  int session_;
  SessionTurn turn_;
  OrderList condition_list_, object_list_;
};

}  // namespace jnd
