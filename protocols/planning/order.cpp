#include "protocols/planning/order.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>

#include "protocols/planning/allotment.h"
#include "protocols/random_stream.h"
#include "protocols/tasks/task.h"

namespace jnd {

namespace {

constexpr int kMostTrials = 1000;

// ways(first, same, different): sequences of the rest that begin with a run of class `first` (1 = same).
class RunCounts {
 public:
  RunCounts(int same, int different, int limit)
      : width_(static_cast<std::size_t>(different) + 1),
        limit_(limit),
        ways_(2 * (static_cast<std::size_t>(same) + 1) * width_) {
    for (int s = 0; s <= same; ++s) {
      for (int d = 0; d <= different; ++d) {
        for (const int first : {0, 1}) {
          double& ways = ways_[place(first, s, d)];
          if (s == 0 && d == 0) {
            ways = 1;  // nothing is left: one way to end
            continue;
          }
          for (int run = 1; run <= longest(first, s, d); ++run) ways += after(first, run, s, d);
        }
      }
    }
  }

  double ways(int first, int same, int different) const { return ways_[place(first, same, different)]; }
  int longest(int first, int same, int different) const { return std::min(limit_, first == 1 ? same : different); }
  // The ways that remain after a run of class `first`: the other class must follow.
  double after(int first, int run, int same, int different) const {
    return first == 1 ? ways(0, same - run, different) : ways(1, same, different - run);
  }

 private:
  std::size_t place(int first, int same, int different) const {
    return 2 * (static_cast<std::size_t>(same) * width_ + static_cast<std::size_t>(different)) +
           static_cast<std::size_t>(first);
  }
  std::size_t width_;
  int limit_;
  std::vector<double> ways_;
};

}  // namespace

std::vector<bool> draw_limited_sequence(int same, int different, int limit, RandomStream& stream) {
  if (same < 0 || different < 0 || limit < 1 || same + different > kMostTrials)
    throw std::invalid_argument("a run limit needs limit >= 1 and 0 to 1000 trials");
  std::vector<bool> sequence;
  if (same + different == 0) return sequence;
  const RunCounts counts(same, different, limit);
  const double all = counts.ways(0, same, different) + counts.ways(1, same, different);
  if (!(all > 0)) throw std::invalid_argument("no sequence of these classes keeps the run limit");

  int first = stream.uniform() * all < counts.ways(1, same, different) ? 1 : 0;
  while (same + different > 0) {
    // Inverse of the cumulative counts; rounding can at most fall through to the last possible run.
    double rest = stream.uniform() * counts.ways(first, same, different);
    int run = 0;
    for (int candidate = 1; candidate <= counts.longest(first, same, different); ++candidate) {
      const double ways = counts.after(first, candidate, same, different);
      if (ways <= 0) continue;
      run = candidate;
      if (rest < ways) break;
      rest -= ways;
    }
    sequence.insert(sequence.end(), static_cast<std::size_t>(run), first == 1);
    (first == 1 ? same : different) -= run;
    first = 1 - first;
  }
  return sequence;
}

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
    : groups_(group_count(protocol)),
      per_series_(protocol.design.per_series),
      seed_(study_seed),
      session_(session),
      turn_(turn_of(session)) {
  const auto places = [](const auto& all) { return counting(static_cast<int>(all.size())); };
  const Design& design = protocol.design;
  const Factor conditions = listed({"conditions", conditions_of(protocol, group)}, design.condition_order);
  if (task_of(protocol.task.kind).has_trials()) {
    outer_ = listed({"series", places(protocol.series)}, design.series_order);
    inner_ = conditions;
    for (const Series& series : protocol.series) outer_names_.push_back(series.name);
  } else {
    if (!protocol.explore || protocol.explore->objects.empty())
      throw std::invalid_argument("the protocol has nothing to explore");
    outer_ = conditions;
    inner_ = listed({"objects", places(protocol.explore->objects)}, Order::williams);
  }
}

OrderAssignment::Factor OrderAssignment::listed(Factor factor, Order order) const {
  factor.list = order_list(order, static_cast<int>(factor.items.size()), seed_, factor.name);
  for (std::vector<int>& one : factor.list) one = picked(one, factor.items);
  factor.backwards = turn_.backwards && is_assigned(order);
  return factor;
}

// of: empty, or "/" and the name of a series.
std::vector<int> OrderAssignment::random_order(const Factor& factor, const std::string& of, int participant) const {
  std::vector<int> order = factor.items;
  RandomStream(seed_, static_cast<std::uint64_t>(participant), session_purpose(session_, "order/" + factor.name + of))
      .shuffle(order);
  return order;
}

int OrderAssignment::cycle() const noexcept {
  return std::lcm(size_of(outer_.list), size_of(inner_.list));
}

int OrderAssignment::outer_place(int participant) const noexcept {
  return ((participant - 1) / groups_ + turn_.places) % size_of(outer_.list);
}

int OrderAssignment::inner_place(int participant) const noexcept {
  const std::int64_t i = (participant - 1) / groups_;
  return static_cast<int>((i + i / cycle() + turn_.places) % size_of(inner_.list));
}

int OrderAssignment::group_size() const noexcept {
  return is_random() ? 0 : cycle();
}

int OrderAssignment::pair_count() const noexcept {
  return is_random() ? 0 : size_of(outer_.list) * size_of(inner_.list);
}

std::vector<int> OrderAssignment::outer_order(int participant) const {
  if (outer_.list.empty()) return random_order(outer_, "", participant);
  std::vector<int> assigned = outer_.list[static_cast<std::size_t>(outer_place(participant))];
  if (outer_.backwards) std::reverse(assigned.begin(), assigned.end());
  return assigned;
}

std::vector<std::vector<int>> OrderAssignment::inner_orders(int participant, const std::vector<int>& outer) const {
  const auto first = static_cast<std::size_t>(inner_place(participant));
  std::vector<std::vector<int>> orders;
  for (std::size_t j = 0; j < outer.size(); ++j) {
    if (inner_.list.empty()) {
      const std::string of = per_series_ ? "/" + outer_names_[static_cast<std::size_t>(outer[j])] : "";
      orders.push_back(random_order(inner_, of, participant));
      continue;
    }
    // Backwards, a series keeps the order that it had in the session before, turned round.
    const std::size_t turn = outer_.backwards ? outer.size() - 1 - j : j;
    orders.push_back(inner_.list[(first + (per_series_ ? turn : 0)) % inner_.list.size()]);
    if (inner_.backwards) std::reverse(orders.back().begin(), orders.back().end());
  }
  return orders;
}

int size_of(const OrderList& list) noexcept {
  return std::max(1, static_cast<int>(list.size()));
}

}  // namespace jnd
