// What `jnd calc fit` has to say, and its two ways of saying it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/psychometric/psychometric_compare.h"
#include "analysis/psychometric/psychometric_interval.h"

namespace jnd {

struct PsychometricAnswer {
  std::optional<std::string> group;                   // none where the file has no such column
  std::optional<std::string> participant, condition;  // of trials
  PsychometricFit fit;
  PsychometricIntervals intervals;
  bool falling = false;                            // the counted answer is rarer at higher levels (falling_answers)
  std::optional<PsychometricBootstrap> bootstrap;  // where the intervals come from it
};

nlohmann::ordered_json psychometric_json(const PsychometricAnswer& answer);
nlohmann::ordered_json psychometric_json(const PsychometricComparison& comparison);

// Tables for a person; answers are all of one model.
std::string psychometric_text(const std::vector<PsychometricAnswer>& answers);
std::string psychometric_text(const PsychometricComparison& comparison);

}  // namespace jnd
