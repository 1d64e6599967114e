// What `jnd calc hierarchical` found, for people and for machines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/hierarchical/hierarchical_bootstrap.h"
#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/hierarchical/predictive_check.h"
#include "runner/calc_hierarchical/hierarchical_answers.h"

namespace jnd {

struct HierarchicalResult {
  NamedAnswers answers;
  HierarchicalModel model;
  HierarchicalFit fit;
  std::vector<SharedEstimate> shared;      // but criteria of sureness
  std::optional<HierarchicalFit> without;  // with nothing shared estimated, where something is
  std::vector<PersonEstimate> people;
  std::optional<EqualityBootstrap> bootstrap;
  std::optional<PredictiveCheck> check;
  std::vector<SharedEstimate> sureness;  // its criteria, below and above; empty where it was not told
  std::vector<double> narrower;          // by condition: see narrower_by()
  std::vector<bool> falling;             // by condition: positive answers become rarer as the level grows
  SharedEstimate lapses;                 // more than the model holds: lapses_beside()
  std::vector<std::string> cautions() const;

  bool choice() const noexcept { return model.response == ResponseModel::choice; }
  double origin() const noexcept { return choice() ? answers.standard.value_or(0) : 0; }  // of the levels
};

nlohmann::ordered_json hierarchical_json(const HierarchicalResult& result);
std::string hierarchical_text(const HierarchicalResult& result);

}  // namespace jnd
