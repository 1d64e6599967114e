// What `jnd calc which` answers, for machines and for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/choice/two_interval.h"

namespace jnd {

struct TwoIntervalAnswer {
  std::optional<std::string> group, participant, condition;
  double standard = 0;  // in the unit of the levels; without a Weber fraction where it is not above 0
  TwoIntervalOptions options;
  TwoIntervalFit fit;
  TwoIntervalIntervals intervals;
  double constants = 0;                // ln choose(n, k) over the rows
  std::optional<OrderTermTest> order;  // where an order was given
  bool falling = false;                // the comparison is chosen less often at higher levels (falling_answers)
};

nlohmann::ordered_json two_interval_json(const TwoIntervalAnswer& answer);
std::string two_interval_text(const std::vector<TwoIntervalAnswer>& answers);

}  // namespace jnd
