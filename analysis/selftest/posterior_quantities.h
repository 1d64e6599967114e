// The quantities of the self-test that the Bayesian adaptive procedure computes.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/procedures/posterior.h"
#include "analysis/selftest/selftest.h"

namespace jnd {

std::vector<SelftestQuantity> posterior_quantities();

// The configurations that the cases of posterior_reference.json use: same-different with 25 levels of 0..600 N/m and
// 1581 observers, which with 20 levels about 900 N/m and 1170 observers.
PosteriorConfiguration reference_posterior(PosteriorTask task, PosteriorUtility utility);

// That of a case's input, and the slot of its trial.
PosteriorConfiguration reference_posterior(const nlohmann::json& input);
PosteriorSlot reference_slot(const nlohmann::json& input, std::size_t trial);

}  // namespace jnd
