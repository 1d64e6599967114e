// The quantities of the self-test that `analysis/hierarchical` computes.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/selftest/selftest.h"

namespace jnd {

std::vector<SelftestQuantity> hierarchical_quantities();

// Of a case of hierarchical_reference.json, and of one of the models fitted to it.
std::vector<HierarchicalCell> reference_answers(const nlohmann::json& one_case);
HierarchicalModel reference_model(const nlohmann::json& fit, ResponseModel response);

}  // namespace jnd
