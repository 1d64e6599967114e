// Plans of further sessions: the first stays what it was for ever, the others differ from it and are as balanced.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/input/sha256.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd;
using namespace jnd::test;

namespace {

std::string session_digest(const Protocol& protocol, const Plan& plan) {
  std::string text;
  for (const Trial& t : plan.trials)
    text += fmt::format("{} {} {} {} {} {} {} {} {:g} {:g}\n", t.index, t.block, t.practice, t.round,
                        protocol.series[static_cast<std::size_t>(t.series)].name,
                        protocol.conditions[static_cast<std::size_t>(t.condition)].name, (t.target == kClassSame),
                        t.track, t.stimuli[0], t.stimuli[1]);
  return sha256_hex(text);
}

// Of several participants and seeds at once.
std::string digest_of_many(const Protocol& protocol, int session) {
  std::string all;
  for (const int participant : {1, 2, 7, 19, 40})
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{20171101}, ~std::uint64_t{0}})
      all += session_digest(protocol, make_plan(protocol, participant, seed, session));
  return sha256_hex(all);
}

Protocol shipped(const std::string& name) {
  return load_protocol(protocols_folder() / (name + ".json"));
}

std::vector<int> backwards(std::vector<int> order) {
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace

TEST_CASE("the first session of a participant is the plan that it was before there were others") {
  // Recorded with the version that knew one session only.
  const std::map<std::string, std::string> recorded = {
      {"chinello2017-balanced", "c3ee4490ccbf326746ceb42f3e32f907e24ffa3134662adfb7e1fa6ddd89d021"},
      {"chinello2017", "fc21168c5ecb3ff892e220036122780a3d2832285322e6b6061b3c88d8f3a956"},
      {"tutorial", "22868db05a4fe74426009cf6104fa16565c3f91436dc76909bc815a2e9f87c4a"},
      {"adaptive-quest", "f58fa1a8d27d1b3559e431237897a4b88371cc6e54dbcdf011ebe6102fc9a4e0"},
      {"adaptive-staircase", "8d26078b0e1191381c936a4779b69203c134cc6c2b45def7318dde9998ad5fc9"},
      {"mckibben-stiffness", "871ae82ee2e39704ffcccf279bb259d24fae6fafd42fb770e5102b3120f946ab"},
      {"cutaneous-kinaesthetic", "a742cd48fd6b54a0c2498444c5a0859073526a98b1b5a5c87b528765290fd513"}};
  for (const auto& [name, expected] : recorded) {
    CAPTURE(name);
    CHECK(digest_of_many(shipped(name), 1) == expected);
  }
  const std::map<std::string, std::string> of_corpus = {
      {"mixed", "f808522cdc91457e77736c5f8ed8031c522fb4c44d19a49d482ffb6ba40e1b06"},
      {"random-orders", "94bb2d589e3c6d4fda96505aa6bf5213068a2d050fbfaba797e01b2f8803dd46"},
      {"williams-per-series", "94ba397b4cc63b1909bed29f8586455128054cc701de5dd39ff8c6c05e57d0dc"}};
  for (const auto& [name, expected] : of_corpus) {
    CAPTURE(name);
    CHECK(digest_of_many(load_protocol(corpus_folder() / "good" / (name + ".json")), 1) == expected);
  }
}

TEST_CASE("sessions differ in orders and draws, and a plan knows its session") {
  const Protocol protocol = shipped("chinello2017-balanced");
  std::set<std::string> digests;
  for (int session = 1; session <= 6; ++session) {
    const Plan plan = make_plan(protocol, 3, 5, session);
    CHECK(plan.session == session);
    CHECK(plan.trials.size() == make_plan(protocol, 3, 5).trials.size());
    CHECK(digests.insert(session_digest(protocol, plan)).second);
  }
  // Practice, slots of adaptive tracks and random orders have draws of their own too.
  for (const char* const name : {"adaptive-quest", "adaptive-posterior", "tutorial"})
    CHECK(digest_of_many(shipped(name), 1) != digest_of_many(shipped(name), 2));
  CHECK_THROWS_AS(make_plan(protocol, 1, 1, 0), std::invalid_argument);
}

TEST_CASE("the second session presents the orders of the first backwards; later twos move on") {
  for (const Order order : {Order::permuted, Order::williams}) {
    for (const bool per_series : {false, true}) {
      Protocol protocol = small_protocol(3, 4, 4, Sampling::balanced);
      protocol.design.series_order = order;
      protocol.design.condition_order = order;
      protocol.design.per_series = per_series;
      for (int participant = 1; participant <= 30; ++participant) {
        for (int session = 1; session <= 7; session += 2) {
          const Plan one = make_plan(protocol, participant, 9, session);
          const Plan other = make_plan(protocol, participant, 9, session + 1);
          CHECK(other.series_order == backwards(one.series_order));
          for (std::size_t j = 0; j < 3; ++j)  // by series, wherever it stands
            CHECK(other.condition_orders[2 - j] == backwards(one.condition_orders[j]));
        }
        CHECK(make_plan(protocol, participant, 9, 3).series_order ==
              make_plan(protocol, participant + 1, 9).series_order);
      }
    }
  }
}

TEST_CASE("fixed orders stay as in the file; random ones are drawn for each session") {
  Protocol protocol = small_protocol(4, 5, 4, Sampling::balanced);
  for (int session = 1; session <= 4; ++session)
    CHECK(make_plan(protocol, 2, 1, session).series_order == std::vector<int>{0, 1, 2, 3});
  protocol.design.series_order = Order::random;
  protocol.design.condition_order = Order::random;
  std::set<std::vector<int>> series, conditions;
  for (int session = 1; session <= 8; ++session) {
    const Plan plan = make_plan(protocol, 2, 1, session);
    series.insert(plan.series_order);
    conditions.insert(plan.condition_orders.front());
  }
  CHECK(series.size() >= 6);
  CHECK(conditions.size() >= 6);
}

TEST_CASE("every session of a cohort is balanced as the first is") {
  const Protocol protocol = shipped("chinello2017-balanced");
  for (int session = 1; session <= 6; ++session) {
    CAPTURE(session);
    const CohortBalance balance = balance_of_cohort(protocol, 36, 3, session);
    CHECK(balance.session == session);
    CHECK(balance.different_pairs_of_orders == 36);
    CHECK(balance.most_used_pair == 1);
    for (const OrderUse& use : balance.series_orders) CHECK(use.participants == 6);
    for (const OrderUse& use : balance.condition_orders) CHECK(use.participants == 6);
    for (const auto& row : balance.condition_positions) CHECK(row == std::vector<int>{36, 36, 36});
    for (const auto& row : balance.series_positions) CHECK(row == std::vector<int>{12, 12, 12});
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) CHECK(balance.condition_transitions[a][b] == (a == b ? 0 : 36));
    for (const CellBalance& cell : balance.cells) CHECK(cell.pairs == std::array<int, 4>{216, 216, 216, 216});
  }
  CHECK_THROWS_AS(balance_of_cohort(protocol, 3, 1, 0), std::invalid_argument);
}

TEST_CASE("lists of orders are closed under reversal, which the second session needs") {
  for (const Order order : {Order::permuted, Order::williams}) {
    for (int k = 1; k <= 7; ++k) {
      const OrderList list = order_list(order, k, 77, "conditions");
      const std::set<std::vector<int>> all(list.begin(), list.end());
      for (const std::vector<int>& row : list) CHECK(all.count(backwards(row)) == 1);
    }
  }
}
