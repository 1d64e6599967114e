#include "protocols/planning/order.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"

namespace jnd {
namespace {

std::vector<int> counting(int k) {
  std::vector<int> items(static_cast<std::size_t>(k));
  std::iota(items.begin(), items.end(), 0);
  return items;
}

// An order of places in a list, as the list's own items.
std::vector<int> picked(std::vector<int> order, const std::vector<int>& items) {
  for (int& item : order) item = items[static_cast<std::size_t>(item)];
  return order;
}

bool is_assigned(Order order) noexcept {
  return order == Order::permuted || order == Order::williams;
}

}  // namespace

OrderList all_permutations(int k) {
  OrderList list;
  std::vector<int> items = counting(k);
  do list.push_back(items);
  while (std::next_permutation(items.begin(), items.end()));
  return list;
}

OrderList williams_square(int k) {
  if (k == 1) return {{0}};
  // 0, 1, k-1, 2, k-2, ...: the differences of neighbours are all different modulo k.
  std::vector<int> first(static_cast<std::size_t>(k));
  for (int j = 0; j < k; ++j) first[static_cast<std::size_t>(j)] = j % 2 == 1 ? (j + 1) / 2 : (k - j / 2) % k;
  OrderList list;
  for (int row = 0; row < k; ++row) {
    std::vector<int> sequence = first;
    for (int& item : sequence) item = (item + row) % k;
    list.push_back(std::move(sequence));
  }
  if (k % 2 == 1) {  // the mirror image supplies the differences that an odd k lacks
    for (int row = 0; row < k; ++row) {
      std::vector<int> mirrored = list[static_cast<std::size_t>(row)];
      std::reverse(mirrored.begin(), mirrored.end());
      list.push_back(std::move(mirrored));
    }
  }
  return list;
}

// The names of streams are part of every plan: they never change.
OrderList order_list(Order order, int k, std::uint64_t study_seed, const std::string& factor) {
  OrderList list;
  switch (order) {
    case Order::fixed:
      return {counting(k)};
    case Order::random:
      return {};
    case Order::permuted:
      list = all_permutations(k);
      break;
    case Order::williams: {
      std::vector<int> labels = counting(k);
      RandomStream(study_seed, 0, "labels/" + factor).shuffle(labels);
      list = williams_square(k);
      for (std::vector<int>& row : list)
        for (int& item : row) item = labels[static_cast<std::size_t>(item)];
      break;
    }
  }
  RandomStream(study_seed, 0, "orders/" + factor).shuffle(list);
  return list;
}

SessionTurn turn_of(int session) noexcept {
  return {(session - 1) / 2, session % 2 == 0};
}

std::string session_purpose(int session, const std::string& name) {
  return session == 1 ? name : "session/" + std::to_string(session) + "/" + name;
}

OrderAssignment::OrderAssignment(const Protocol& protocol, std::uint64_t study_seed, int session,
                                 std::optional<int> group)
    : series_count_(static_cast<int>(protocol.series.size())),
      groups_(group_count(protocol)),
      conditions_(conditions_of(protocol, group)),
      per_series_(protocol.design.per_series),
      seed_(study_seed),
      session_(session),
      turn_(turn_of(session)),
      series_backwards_(turn_.backwards && is_assigned(protocol.design.series_order)),
      conditions_backwards_(turn_.backwards && is_assigned(protocol.design.condition_order)),
      series_list_(order_list(protocol.design.series_order, series_count_, study_seed, "series")),
      condition_list_(
          order_list(protocol.design.condition_order, static_cast<int>(conditions_.size()), study_seed, "conditions")) {
  for (std::vector<int>& order : condition_list_) order = picked(order, conditions_);
  for (const Series& series : protocol.series) series_names_.push_back(series.name);
}

int OrderAssignment::series_place(int participant) const noexcept {
  return ((participant - 1) / groups_ + turn_.places) % size_of(series_list_);
}

int OrderAssignment::condition_place(int participant) const noexcept {
  const int i = (participant - 1) / groups_;
  return static_cast<int>((static_cast<std::int64_t>(i) + i / group_size() + turn_.places) % size_of(condition_list_));
}

int OrderAssignment::group_size() const noexcept {
  return std::lcm(size_of(series_list_), size_of(condition_list_));
}

int OrderAssignment::pair_count() const noexcept {
  return size_of(series_list_) * size_of(condition_list_);
}

std::vector<int> OrderAssignment::series_order(int participant) const {
  if (!series_list_.empty()) {
    std::vector<int> assigned = series_list_[static_cast<std::size_t>(series_place(participant))];
    if (series_backwards_) std::reverse(assigned.begin(), assigned.end());
    return assigned;
  }
  std::vector<int> order = counting(series_count_);
  RandomStream(seed_, static_cast<std::uint64_t>(participant), session_purpose(session_, "order/series"))
      .shuffle(order);
  return order;
}

std::vector<std::vector<int>> OrderAssignment::condition_orders(int participant,
                                                                const std::vector<int>& series_order) const {
  std::vector<std::vector<int>> orders;
  for (std::size_t j = 0; j < series_order.size(); ++j) {
    if (!condition_list_.empty()) {
      // Backwards, a series keeps the order that it had in the session before, turned round.
      const std::size_t turn = series_backwards_ ? series_order.size() - 1 - j : j;
      const std::size_t advance = per_series_ ? turn : 0;
      orders.push_back(
          condition_list_[(static_cast<std::size_t>(condition_place(participant)) + advance) % condition_list_.size()]);
      if (conditions_backwards_) std::reverse(orders.back().begin(), orders.back().end());
      continue;
    }
    const std::string purpose = per_series_
                                    ? "order/conditions/" + series_names_[static_cast<std::size_t>(series_order[j])]
                                    : "order/conditions";
    std::vector<int> order = conditions_;
    RandomStream(seed_, static_cast<std::uint64_t>(participant), session_purpose(session_, purpose)).shuffle(order);
    orders.push_back(std::move(order));
  }
  return orders;
}

int size_of(const OrderList& list) noexcept {
  return std::max(1, static_cast<int>(list.size()));
}

}  // namespace jnd
