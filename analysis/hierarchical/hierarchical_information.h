// How sharply the marginal likelihood tells its parameters, before any of it is computed.
//
// The estimate of (ln s, k) of every cell is taken as normal about the truth with the covariance of its expected
// information. Then all estimates of one participant are normal with the covariance V = errors + Z G Z', and the
// information is that of a linear mixed model. It is a curvature to begin a search with, and a standard error of
// studies drawn by the thousand, whose own coverage says how good that is; intervals of a study are profiles.
//
// Source: Pinheiro and Bates 2000, Mixed-Effects Models in S and S-PLUS, section 2.2 (linear mixed model).
#pragma once

#include <span>
#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"

namespace jnd {

// On mu and kappa of each condition, then tu^2, tv^2, tw^2 and rho: a symmetric matrix by rows. cells: by participant
// and condition.
std::vector<double> marginal_information(std::span<const CellInformation> cells, const HierarchicalPlace& place);

// Of the same the covariances of the estimated mu of each condition, then of kappa, by rows, as if the spreads were known.
std::vector<double> covariance_of_estimates(std::span<const CellInformation> cells, const HierarchicalPlace& place);

}  // namespace jnd
