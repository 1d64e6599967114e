// What `jnd calc sdt` answers, for machines and for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/detection/detection_row.h"

namespace jnd {

struct NamedDetectionRow {
  std::string id;
  DetectionRow row;
  std::optional<std::string> participant = std::nullopt, condition = std::nullopt;  // of trials
  std::optional<double> difference = std::nullopt;                                  // of trials
};

nlohmann::ordered_json detection_json(const NamedDetectionRow& named);
// Three tables: counts and the yes-no model, the other models, and cautions about what could not be estimated.
std::string detection_text(const std::vector<NamedDetectionRow>& rows);

}  // namespace jnd
