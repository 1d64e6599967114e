// Orders of series and conditions, and their assignment to participants; of free interaction, of conditions and objects.
//
// Each factor has a list of orders: the one of the file (`fixed`), all permutations (`permuted`) or a Williams square
// (`williams`), shuffled once for the whole study. Participant i (from 0) gets order i mod A of the A series orders and
// order (i + floor(i / L)) mod B of the B condition orders, L = lcm(A, B): every L participants use each order of a
// factor equally often, and all A B pairs occur before any repeats. For A = B = 6, participant 6r + s takes series
// order s and condition order (s + r) mod 6. `random` orders are drawn for each participant and are not assigned. With
// groups of participants i counts the members of one group, whose conditions alone are ordered. In free interaction
// conditions stand for the series, and for the conditions the objects, always in a Williams square.
//
// Further sessions of a participant come in twos: session 2m + 1 takes the orders that are m places further in each
// list, and session 2m + 2 presents those of session 2m + 1 backwards. Both move a list onto itself (permutations and
// Williams squares are closed under reversal), so that every session is balanced over participants as the first is;
// over two sessions each item stands, for each participant, at the same mean place, so that what grows or fades
// steadily with time favours none; and over all sessions of a list each participant meets all of its orders. `fixed`
// stays as in the file, and `random` is drawn for each session.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/protocol.h"
#include "protocols/random_stream.h"

namespace jnd {

// A sequence of `same` trues and `different` falses with no run longer than `limit`, drawn uniformly among all such
// sequences: the numbers of completions are counted first (dynamic programming over what is left, in double: the same
// on every machine), then the runs are drawn one after another in proportion to them.
// Throws std::invalid_argument where there is no such sequence, or beyond 1000 trials (counts leave double's range).
std::vector<bool> draw_limited_sequence(int same, int different, int limit, RandomStream& stream);

using OrderList = std::vector<std::vector<int>>;
// How many orders there are to choose from; an empty list stands for the order of the file.
int size_of(const OrderList& list) noexcept;

// All k! orders of 0..k-1, lexicographically. k is 1..8.
OrderList all_permutations(int k);

// A Williams design of 0..k-1 (Williams 1949, "Experimental designs balanced for the estimation of residual effects of
// treatments"): k sequences for even k, 2k for odd k. Each item stands in each position, and directly before each other
// item, equally often. k >= 1; one item has one sequence.
OrderList williams_square(int k);

// The orders of k items that are assigned in turn, shuffled for the study; empty where they are random. factor:
// "series", "conditions" or "objects".
OrderList order_list(Order order, int k, std::uint64_t study_seed, const std::string& factor);

// How the assignment of a session differs from that of the first.
struct SessionTurn {
  int places = 0;  // that every participant is further in each list
  bool backwards = false;
};
SessionTurn turn_of(int session) noexcept;  // session: from 1

// The purpose of a stream of random numbers, which is its own in each session; that of the first is the bare name.
std::string session_purpose(int session, const std::string& name);

class OrderAssignment {
 public:
  // protocol: as loaded. study_seed: shuffles the lists and the labels of Williams squares. session: from 1. group: of
  // the participants who are asked for; none where there are none. Throws std::invalid_argument where free interaction
  // has no objects.
  OrderAssignment(const Protocol& protocol, std::uint64_t study_seed, int session = 1,
                  std::optional<int> group = std::nullopt);

  // participant: from 1. Series, or in free interaction conditions, as presented: places in the protocol.
  std::vector<int> outer_order(int participant) const;
  // For each of these the conditions, or the objects. outer: the order of the same participant.
  std::vector<std::vector<int>> inner_orders(int participant, const std::vector<int>& outer) const;

  // Lists of orders; empty where a factor's order is random. The participant's place in each: 0 where it is empty.
  const OrderList& outer_list() const noexcept { return outer_.list; }
  const OrderList& inner_list() const noexcept { return inner_.list; }
  int outer_place(int participant) const noexcept;
  int inner_place(int participant) const noexcept;

  // Every so many participants each order of a factor has been used equally often (lcm of the lists' sizes), and each
  // pair of orders once (their product); 0: random orders.
  int group_size() const noexcept;
  int pair_count() const noexcept;

 private:
  struct Factor {
    std::string name;
    std::vector<int> items;  // places in the protocol
    OrderList list{};        // empty where the order is random
    bool backwards = false;
  };
  Factor listed(Factor factor, Order order) const;
  std::vector<int> random_order(const Factor& factor, const std::string& of, int participant) const;
  bool is_random() const noexcept { return outer_list().empty() || inner_list().empty(); }
  int cycle() const noexcept;  // participants until every order has come equally often

  int groups_;
  bool per_series_;
  std::uint64_t seed_;
  int session_;
  SessionTurn turn_;
  Factor outer_, inner_;
  std::vector<std::string> outer_names_;  // of series
};

}  // namespace jnd
