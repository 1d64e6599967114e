// What `jnd calc hierarchical` reads: who answered what, of counts or of single trials.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "data/results/hierarchical_words.h"
#include "runner/calc/calc.h"
#include "runner/calc/trials_input.h"

namespace jnd {

struct HierarchicalCommand {
  CalcInput input;
  TrialOptions trials;
  std::string task, observer = "yes-no", random = "tu,tv,tw", lapse = "0";
  bool one_jnd = false, people = false, thorough = false, overdispersion = false, drift = false;
  int bootstrap = 0, check = 0, threads = 0;
  std::uint64_t seed = 1;
};

// The option's own words: of either task.
inline const TrialUse kHierarchicalUse = {
    "the stimuli were different, or the comparison was chosen", {}, false, false, true};

// What the analysis was made of, and by which names.
struct NamedAnswers {
  std::vector<std::string> participants, conditions;
  std::vector<HierarchicalCell> cells;
  std::optional<double> standard;
  bool graded = false;  // it was told which answers were sure
  PooledLevels pooled;

  int participant(const std::string& name) { return place(participants, name); }
  int condition(const std::string& name) { return place(conditions, name); }

 private:
  static int place(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<int>(found - names.begin());
    names.push_back(name);
    return static_cast<int>(names.size()) - 1;
  }
};

HierarchicalModel hierarchical_model_of(const HierarchicalCommand& options);

// Throws UsageError and InputError (which tell what to do), also where the answers are too few for any model.
NamedAnswers named_answers(const HierarchicalCommand& options);

}  // namespace jnd
