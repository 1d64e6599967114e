#include "protocols/planning/exploration_assignment.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "protocols/planning/order.h"
#include "protocols/random_stream.h"

namespace jnd {
namespace {

const Exploration& exploration_of(const Protocol& protocol) {
  if (!protocol.explore || protocol.explore->objects.empty())
    throw std::invalid_argument("the protocol has nothing to explore");
  return *protocol.explore;
}

}  // namespace

ExplorationAssignment::ExplorationAssignment(const Protocol& protocol, std::uint64_t study_seed, int session)
    : protocol_(protocol),
      seed_(study_seed),
      session_(session),
      turn_(turn_of(session)),
      condition_list_(order_list(protocol.design.condition_order, static_cast<int>(protocol.conditions.size()),
                                 study_seed, "conditions")),
      object_list_(order_list(Order::williams, static_cast<int>(exploration_of(protocol).objects.size()), study_seed,
                              "objects")) {}

int ExplorationAssignment::group_size() const noexcept {
  return condition_list_.empty() ? 0 : std::lcm(size_of(condition_list_), size_of(object_list_));
}

int ExplorationAssignment::pair_count() const noexcept {
  return condition_list_.empty() ? 0 : size_of(condition_list_) * size_of(object_list_);
}

std::vector<int> ExplorationAssignment::condition_order(int participant) const {
  std::vector<int> order;
  if (condition_list_.empty()) {
    order.resize(protocol_.conditions.size());
    std::iota(order.begin(), order.end(), 0);
    RandomStream(seed_, static_cast<std::uint64_t>(participant), session_purpose(session_, "order/conditions"))
        .shuffle(order);
    return order;
  }
  order = condition_list_[static_cast<std::size_t>((participant - 1 + turn_.places) % size_of(condition_list_))];
  if (turn_.backwards && protocol_.design.condition_order != Order::fixed) std::reverse(order.begin(), order.end());
  return order;
}

std::vector<int> ExplorationAssignment::object_order(int participant) const {
  const int group = std::lcm(size_of(condition_list_), size_of(object_list_));
  const std::int64_t i = participant - 1;
  std::vector<int> order =
      object_list_[static_cast<std::size_t>((i + i / group + turn_.places) % size_of(object_list_))];
  if (turn_.backwards) std::reverse(order.begin(), order.end());
  return order;
}

std::vector<ExplorationSlot> ExplorationAssignment::slots(int participant) const {
  const std::vector<int> objects = object_order(participant);
  const double duration_s = exploration_of(protocol_).duration_s / static_cast<double>(objects.size());
  std::vector<ExplorationSlot> slots;
  int block = 0;
  for (const int condition : condition_order(participant)) {
    ++block;
    for (const int object : objects)
      slots.push_back({static_cast<int>(slots.size()) + 1, block, condition, object, duration_s});
  }
  return slots;
}

}  // namespace jnd
