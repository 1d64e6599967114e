// Orders of series and conditions, and their assignment to participants.
//
// Each factor has a list of orders: the one of the file (`fixed`), all permutations (`permuted`) or a Williams square
// (`williams`), shuffled once for the whole study. Participant i (from 0) gets order i mod A of the A series orders and
// order (i + floor(i / L)) mod B of the B condition orders, L = lcm(A, B): every L participants use each order of a
// factor equally often, and all A B pairs occur before any repeats. For A = B = 6, participant 6r + s takes series
// order s and condition order (s + r) mod 6. `random` orders are drawn for each participant and are not assigned. With
// groups of participants i counts the members of one group, whose conditions alone are ordered.
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

namespace jnd {

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
  // the participants who are asked for; none where there are none.
  OrderAssignment(const Protocol& protocol, std::uint64_t study_seed, int session = 1,
                  std::optional<int> group = std::nullopt);

  // participant: from 1. Places in Protocol::series, in presented order.
  std::vector<int> series_order(int participant) const;
  // For each presented series, the places in Protocol::conditions. series_order is the one of the same participant.
  std::vector<std::vector<int>> condition_orders(int participant, const std::vector<int>& series_order) const;

  // Lists of orders; empty where a factor's order is random.
  const OrderList& series_list() const noexcept { return series_list_; }
  const OrderList& condition_list() const noexcept { return condition_list_; }
  // The participant's place in each list; 0 where it is empty.
  int series_place(int participant) const noexcept;
  int condition_place(int participant) const noexcept;

  // Every so many participants each order of a factor has been used equally often (lcm of the lists' sizes) ...
  int group_size() const noexcept;
  // ... and each pair of a series order and a condition order once (their product).
  int pair_count() const noexcept;

 private:
  int series_count_, groups_;
  std::vector<int> conditions_;  // of the group
  std::vector<std::string> series_names_;
  bool per_series_;
  std::uint64_t seed_;
  int session_;
  SessionTurn turn_;
  bool series_backwards_, conditions_backwards_;
  OrderList series_list_, condition_list_;
};

}  // namespace jnd
