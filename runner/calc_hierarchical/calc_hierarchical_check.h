// The posterior predictive check of `jnd calc hierarchical --check`, for people and for machines.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "data/results/hierarchical_words.h"

namespace jnd {

// conditions: names by their place; origin: what is added to a level to print it (of choices the standard).
std::string predictive_text(const PredictiveCheck& check, const std::vector<std::string>& conditions, double origin);
nlohmann::ordered_json predictive_json(const PredictiveCheck& check, const std::vector<std::string>& conditions,
                                       double origin);
// The same without its rows by condition and level.
nlohmann::ordered_json predictive_summary_json(const PredictiveCheck& check);

}  // namespace jnd
