// The quantities of the self-test that `analysis/scaling` computes: magnitude estimation and adjustment.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/scaling/adjustment.h"
#include "analysis/scaling/magnitude.h"
#include "analysis/selftest/selftest.h"

namespace jnd {

std::vector<SelftestQuantity> scaling_quantities();

// The inputs of the cases of scaling_reference.json.
MagnitudeEstimates reference_magnitudes(const nlohmann::json& input);
std::vector<Adjustment> reference_adjustments(const nlohmann::json& input);

}  // namespace jnd
