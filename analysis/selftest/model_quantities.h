// The quantities of the self-test that the hierarchical model, the adaptive posterior and the scaling methods compute.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/procedures/posterior.h"
#include "analysis/scaling/adjustment.h"
#include "analysis/scaling/magnitude.h"
#include "analysis/selftest/selftest.h"

namespace jnd {

std::vector<SelftestQuantity> hierarchical_quantities();

// Of a case of hierarchical_reference.json, and of one of the models fitted to it.
std::vector<HierarchicalCell> reference_answers(const nlohmann::json& one_case);
HierarchicalModel reference_model(const nlohmann::json& fit, ResponseModel response);

// The quantities of the self-test that the Bayesian adaptive procedure computes.
std::vector<SelftestQuantity> posterior_quantities();

// The configurations that the cases of posterior_reference.json use: same-different with 25 levels of 0..600 N/m and
// 1581 observers, which with 20 levels about 900 N/m and 1170 observers.
PosteriorConfiguration reference_posterior(PosteriorTask task, PosteriorUtility utility);

// That of a case's input, and the slot of its trial.
PosteriorConfiguration reference_posterior(const nlohmann::json& input);
PosteriorSlot reference_slot(const nlohmann::json& input, std::size_t trial);

// The quantities of the self-test that `analysis/scaling` computes: magnitude estimation and adjustment.
std::vector<SelftestQuantity> scaling_quantities();

// The inputs of the cases of scaling_reference.json.
MagnitudeEstimates reference_magnitudes(const nlohmann::json& input);
std::vector<Adjustment> reference_adjustments(const nlohmann::json& input);

}  // namespace jnd
