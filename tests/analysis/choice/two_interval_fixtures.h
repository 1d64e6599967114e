// What the tests of two-interval choices share: data, and the likelihood written down directly.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/choice/two_interval.h"

namespace jnd::testing {

struct ChoiceCase {
  std::vector<ChoiceRow> rows;
  TwoIntervalOptions options;
};

// The input of a reference case.
inline ChoiceCase choice_case(const nlohmann::json& input) {
  ChoiceCase one;
  one.options.link = value_of(kChoiceLinkWords, input.at("link").get<std::string>()).value();
  one.options.lapse.reset();
  if (!input.at("lapse").is_string()) one.options.lapse = input.at("lapse").get<double>();
  one.options.order_term = input.contains("order");
  for (std::size_t i = 0; i < input.at("x").size(); ++i)
    one.rows.push_back({input.at("x")[i], input.at("n")[i], input.at("k")[i],
                        one.options.order_term ? input.at("order")[i].get<int>() : 0});
  return one;
}

// F straight from its definition, without any of the code under test.
inline double plain_choice_cdf(ChoiceLink link, double eta) {
  return link == ChoiceLink::probit ? 0.5 * std::erfc(-eta / std::sqrt(2.0)) : 1 / (1 + std::exp(-eta));
}

inline double plain_choice_log_likelihood(const ChoiceCase& of, double pse, double s, double b, double lapse) {
  double sum = 0;
  for (const ChoiceRow& row : of.rows) {
    const double eta = (row.level - pse) / s + b * row.order;
    const double p = lapse / 2 + (1 - lapse) * plain_choice_cdf(of.options.link, eta);
    const double q = lapse / 2 + (1 - lapse) * plain_choice_cdf(of.options.link, -eta);
    if (row.chosen > 0) sum += static_cast<double>(row.chosen) * std::log(p);
    if (row.chosen < row.n) sum += static_cast<double>(row.n - row.chosen) * std::log(q);
  }
  return std::isnan(sum) ? -kInf : sum;
}

}  // namespace jnd::testing
