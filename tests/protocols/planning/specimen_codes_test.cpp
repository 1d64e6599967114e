// What is handed over, and what its codes tell an onlooker.
#include "protocols/planning/specimen_codes.h"

#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"

namespace jnd {
namespace {

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
