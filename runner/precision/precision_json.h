// The planner's figures for machines: the block "precision" of `jnd check --json` and of `jnd plan --precision --json`.
#pragma once

#include <nlohmann/json.hpp>

#include "runner/precision/precision_text.h"

namespace jnd {

nlohmann::ordered_json precision_json(const PlannedPrecision& planned, const Protocol& protocol);

}  // namespace jnd
