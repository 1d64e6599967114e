// Every model beside the registered one, participant by participant: the long form of the sensitivity table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/detection/detection_row.h"
#include "analysis/thresholds/fit_quality.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

struct ThresholdModel {
  std::string participant;
  int condition = 0;
  ThresholdMethod method;
  JndEstimate jnd;
  std::optional<FitQuality> quality;  // of the maximum-likelihood methods; asymptotic p only
  std::optional<int> group{};         // of the participant, place in Protocol::groups
};

struct CellModel {
  std::string participant;
  int condition = 0, series = 0;
  DetectionRow row;
};

struct StudyModels {
  std::vector<ThresholdModel> thresholds;  // by participant, condition, method
  std::vector<CellModel> cells;            // by participant, condition, series
};
StudyModels study_models(const TaskResults& results, const Protocol& protocol);

}  // namespace jnd
