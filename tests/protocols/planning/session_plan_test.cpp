// Who has which plan: further sessions, cohorts, groups and specimens.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocols/input/sha256.h"
#include "protocols/planning/allotment.h"
#include "protocols/planning/cohort.h"
#include "protocols/planning/order.h"
#include "protocols/planning/plan.h"
#include "protocols/planning/planned_precision.h"
#include "protocols/planning/specimen_codes.h"
#include "protocols/reading/protocol_json.h"
#include "protocols/tasks/task.h"
#include "tests/catch.h"
#include "tests/protocols/examples.h"

using namespace jnd::test;

namespace jnd {
namespace {

// Plans of further sessions: the first stays what it was for ever, the others differ from it and are as balanced.

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

TEST_CASE("a cohort of 36 uses each pair of orders of the balanced design once") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017-balanced.json");
  const CohortBalance balance = balance_of_cohort(protocol, 36, 3);
  CHECK(balance.different_pairs_of_orders == 36);
  CHECK(balance.most_used_pair == 1);
  CHECK(balance.group_size == 6);
  CHECK(balance.pair_count == 36);
  REQUIRE(balance.series_orders.size() == 6);
  for (const OrderUse& use : balance.series_orders) CHECK(use.participants == 6);
  for (const OrderUse& use : balance.condition_orders) CHECK(use.participants == 6);
  for (const auto& row : balance.condition_positions) CHECK(row == std::vector<int>{36, 36, 36});
  for (const auto& row : balance.series_positions) CHECK(row == std::vector<int>{12, 12, 12});
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) CHECK(balance.condition_transitions[a][b] == (a == b ? 0 : 36));
  REQUIRE(balance.cells.size() == 9);
  for (const CellBalance& cell : balance.cells) {
    CHECK(cell.pairs == std::array<int, 4>{216, 216, 216, 216});
    CHECK(cell.same == 432);
    CHECK(cell.different == 432);
    CHECK(cell.least_same == 12);
    CHECK(cell.most_same == 12);
  }
  CHECK(balance.same == 36 * 108);
  CHECK(balance.different == 36 * 108);
}

TEST_CASE("independent draws show their spread") {
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  const CohortBalance balance = balance_of_cohort(protocol, 18, 1);
  CHECK(balance.same + balance.different == 18 * 108);
  int spread = 0;
  for (const CellBalance& cell : balance.cells) {
    CHECK(cell.same + cell.different == 18 * 12);
    CHECK(cell.pairs[0] + cell.pairs[1] == cell.same);
    CHECK(cell.least_same <= cell.most_same);
    spread += cell.most_same - cell.least_same;
  }
  CHECK(spread > 9);
}

TEST_CASE("the text says at which sizes a cohort is balanced, within 100 columns") {
  for (const auto& file : shipped_files()) {
    const Protocol protocol = load_protocol(file);
    for (const int participants : {1, 5, 18, 36}) {
      const std::string text = to_text(balance_of_cohort(protocol, participants, 1), protocol);
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);) {
        CAPTURE(line);
        CHECK(line.size() <= 100);
      }
    }
  }
  const Protocol protocol = load_protocol(protocols_folder() / "chinello2017.json");
  CHECK(to_text(balance_of_cohort(protocol, 18, 1), protocol).find("Exact: each order is used equally often by 18") !=
        std::string::npos);
  const std::string uneven = to_text(balance_of_cohort(protocol, 16, 1), protocol);
  CHECK(uneven.find("16 participants are not a multiple of 6; 18 would be") != std::string::npos);
  CHECK(uneven.find("pairs of series and condition orders at multiples of 36") != std::string::npos);
}

TEST_CASE("mixed conditions and random orders are said to be so; wide tables are summed up") {
  Protocol mixed = small_protocol(2, 2, 4, Sampling::balanced);
  mixed.design.arrangement = Arrangement::mixed;
  const CohortBalance balance = balance_of_cohort(mixed, 4, 1);
  CHECK(balance.condition_positions.empty());
  CHECK(to_text(balance, mixed).find("mixed within each series") != std::string::npos);

  Protocol random = small_protocol(12, 2, 4, Sampling::balanced);
  random.design.series_order = Order::random;
  const CohortBalance drawn = balance_of_cohort(random, 5, 1);
  CHECK(drawn.group_size == 0);
  const std::string text = to_text(drawn, random);
  CHECK(text.find("balanced by chance only") != std::string::npos);
  CHECK(text.find("every entry lies between") != std::string::npos);
  CHECK_THROWS_AS(balance_of_cohort(random, 0, 1), std::invalid_argument);
}

Protocol with_groups(int groups) {
  Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
  for (int group = 0; group < groups; ++group)
    protocol.groups.push_back({std::string(1, static_cast<char>('a' + group)), "a group", {0, 1, 2}});
  return protocol;
}

std::vector<int> groups_of(const Protocol& protocol, int participants, std::uint64_t seed) {
  std::vector<int> groups;
  for (int participant = 1; participant <= participants; ++participant)
    groups.push_back(group_of(protocol, participant, seed).value());
  return groups;
}

TEST_CASE("the allotment of a seed never changes", "[allotment]") {
  // Computed with an independent Python model of Philox, the stream's name and the rule of this room's README.
  CHECK(groups_of(with_groups(3), 12, 1) == std::vector<int>{0, 1, 2, 0, 1, 2, 2, 1, 0, 2, 0, 1});
  CHECK(groups_of(with_groups(2), 12, 20171101) == std::vector<int>{0, 1, 0, 1, 0, 1, 1, 0, 0, 1, 0, 1});
  CHECK(groups_of(with_groups(6), 12, 18446744073709551615U) == std::vector<int>{0, 1, 4, 3, 5, 2, 1, 5, 3, 2, 4, 0});
  CHECK_FALSE(group_of(with_groups(0), 1, 1));
}

TEST_CASE("every block of participants has one of each group, who gets its conditions alone", "[allotment]") {
  Protocol protocol = small_protocol(2, 3, 4, Sampling::balanced);
  protocol.groups = {{"a", "A", {0, 1}}, {"b", "B", {1, 2}}, {"c", "C", {2}}};
  std::set<std::optional<int>> first;
  for (int block = 0; block < 12; ++block) {
    std::set<std::optional<int>> groups;
    for (int participant = 3 * block + 1; participant <= 3 * block + 3; ++participant) {
      const Plan plan = make_plan(protocol, participant, 5);
      groups.insert(plan.group);
      if (participant % 3 == 1) first.insert(plan.group);
      CHECK((participant - 1) / group_count(protocol) == block);
      CHECK(plan.conditions == conditions_of(protocol, plan.group));
      CHECK(plan.trials.size() == 8 * plan.conditions.size());
      for (const Trial& trial : plan.trials) CHECK(has_condition(protocol, plan.group, trial.condition));
    }
    CHECK(groups.size() == 3);
  }
  CHECK(first.size() > 1);
  CHECK(largest_plan(protocol) == 0);
  CHECK_FALSE(everyone_has_all(protocol));
  CHECK(anyone_has_both(protocol, 0, 1));
  CHECK_FALSE(anyone_has_both(protocol, 0, 2));
  CHECK(group_of(protocol, first_of(protocol, 2, 5), 5) == 2);
  protocol.allotment = Allotment::given;
  CHECK(group_of(protocol, number_of_member(protocol, 1, 4), 5) == 1);
  CHECK(number_of_member(protocol, 1, 4) == 3 * 3 + 2);
}

TEST_CASE("orders are balanced within each group, whichever numbers its members have", "[allotment]") {
  Protocol protocol = with_groups(2);
  protocol.design.condition_order = Order::permuted;
  protocol.groups[1].conditions = {0, 2};
  CHECK(balanced_at(protocol) == 12);
  for (const int group : {0, 1}) {
    const CohortBalance balance = balance_of_cohort(protocol, 12, 7, 1, group);
    CHECK(balance.participants == 6);
    REQUIRE(balance.condition_orders.size() == (group == 0 ? 6 : 2));
    for (const OrderUse& use : balance.condition_orders) CHECK(use.participants == (group == 0 ? 1 : 3));
    for (const CellBalance& cell : balance.cells) CHECK(cell.participants == 6);
    CHECK(balance.cells.size() == (group == 0 ? 6 : 4));
  }
  // What is drawn for a cell does not depend on the group.
  Protocol alone = protocol;
  alone.groups.clear();
  const auto stimuli_of = [](const Plan& plan) {
    std::vector<Intervals> stimuli;
    for (const Trial& trial : plan.trials)
      if (trial.condition == 2 && trial.series == 0) stimuli.push_back(trial.stimuli);
    return stimuli;
  };
  CHECK(stimuli_of(make_plan(protocol, 5, 7)) == stimuli_of(make_plan(alone, 5, 7)));
}

TEST_CASE("a planned precision is that of the contrasts and participants that there are", "[allotment]") {
  Protocol protocol = with_groups(3);
  protocol.design.participants = 18;
  CHECK(precision_question(protocol).participants == 18);
  CHECK(precision_note(protocol).empty());
  protocol.groups[0].conditions = {0, 1};
  protocol.groups[1].conditions = {0};
  protocol.groups[2].conditions = {1, 2};
  const PrecisionQuestion question = precision_question(protocol);
  CHECK(question.participants == 6);
  CHECK(question.contrasts.size() == 2);
  CHECK(precision_note(protocol).find("groups") != std::string::npos);
}

// What is handed over, and what its codes tell an onlooker.

Protocol protocol_with(int codes) {
  nlohmann::json json = nlohmann::json::parse(R"({
    "format": 1, "title": "Specimens", "source": {"citation": "none"}, "rig": {"device": "specimens", "specimens": []},
    "paradigm": "same-different",
    "trial": {"explore_s": 1, "no_contact_time_out_s": 5, "gap_s": 0.5, "between_trials_s": 0.5, "answer_time_out_s": 20, "max_attempts": 3,
              "cues": {"first": {"kind": "none"}, "second": {"kind": "none"}, "question": {"kind": "none"}},
              "keys": {"same": "s", "different": "d"}},
    "stimulus": {"quantity": "roughness", "unit": "um", "reference": 50},
    "conditions": [{"name": "A", "label": "a"}, {"name": "B", "label": "b"}],
    "series": [{"name": "1", "pair": [30, 50]}, {"name": "2", "pair": [50, 80]}],
    "design": {"participants": 4, "trials_per_cell": 20, "sampling": "balanced", "conditions": "blocked",
               "order": {"series": "fixed", "conditions": "fixed"}},
    "feedback": "none",
    "analysis": {"model": "yes-no", "correction": "loglinear", "jnd": "least_squares"}
  })");
  for (const int value : {50, 30, 80}) {
    nlohmann::json of_value = nlohmann::json::array();
    const std::string letter = value == 50 ? "A" : value == 30 ? "K" : "C";  // in no order of the values
    for (int i = 0; i < codes; ++i) of_value.push_back(letter + std::to_string(i));
    json["rig"]["specimens"].push_back({{"value", value}, {"codes", of_value}});
  }
  return parse_protocol(json.dump(), "specimens.json");
}

TEST_CASE("A trial has no specimen twice, and each attempt draws anew") {
  const Protocol protocol = protocol_with(2);
  const Plan plan = make_plan(protocol, 1, 5);
  std::set<std::vector<std::string>> pairs;
  for (int attempt = 1; attempt <= 50; ++attempt) {
    const std::vector<std::string> codes = specimen_codes(protocol, plan, 7, attempt, {50, 50});
    REQUIRE(codes.size() == 2);
    CHECK(codes[0] != codes[1]);
    CHECK(codes == specimen_codes(protocol, plan, 7, attempt, {50, 50}));
    CHECK(codes[0] == specimen_codes(protocol, plan, 7, attempt, {50, 30})[0]);  // whatever comes with it
    pairs.insert(codes);
  }
  CHECK(pairs.size() == 2);
}

TEST_CASE("The place of a trial in the plan says nothing about its specimens") {
  const Protocol protocol = protocol_with(2);
  std::map<std::pair<int, std::string>, int> by_parity;
  int trials = 0;
  for (int participant = 1; participant <= 40; ++participant) {
    const Plan plan = make_plan(protocol, participant, 5);
    for (const Trial& trial : plan.trials) {
      const auto codes = specimen_codes(protocol, plan, trial.index, 1, trial.stimuli);
      for (std::size_t i = 0; i < codes.size(); ++i)
        if (trial.stimuli[i] == 50) {
          ++by_parity[{trial.index % 2, codes[i]}];
          ++trials;
        }
    }
  }
  REQUIRE(by_parity.size() == 4);  // two codes in each half; of the turns of before one each
  for (const auto& [place, times] : by_parity) CHECK(std::abs(times - trials / 4) < trials / 20);
}

TEST_CASE("How much codes give away falls with their number") {
  const auto told = [](int codes) { return told_by_codes(protocol_with(2), codes).value(); };
  CHECK(told(2).told > 0.7);
  CHECK(told(3).told < told(2).told);
  CHECK(told(6).told < told(3).told);
  CHECK(told(6).told < 0.6);
  CHECK(told(2).chance == Approx(0.5).margin(0.02));
}

}  // namespace
}  // namespace jnd
