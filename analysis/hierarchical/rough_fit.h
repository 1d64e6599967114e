// The few numbers of one hierarchical fit that count where studies are drawn by the thousand: the means, their standard
// errors, and a likelihood-ratio test of each contrast, with the likelihood as rough as in the bootstrap.
//
// Standard errors are those of the linear mixed model of hierarchical_information.h, with the spreads as estimated;
// intervals from them have Student's t with participants - 1 degrees of freedom. hierarchical_fit.h has the profile
// intervals of one study.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"

namespace jnd {

// Of ln JND. Where the answers tell no JND, everything is NaN.
struct RoughMean {
  double mu = kNaN, error = kNaN;
  SlopeStatus status = SlopeStatus::ok;  // missing: the search did not settle
};
struct RoughDifference {
  double difference = kNaN, error = kNaN;  // NaN where one of the two has no JND
  double p = kNaN;                         // chi-square with 1 degree of freedom; NaN where the searches did not settle
};
struct RoughFit {
  std::vector<RoughMean> means;              // by condition
  std::vector<RoughDifference> differences;  // by contrast
};

// near: where a search begins, such as the truth that the answers were drawn from. contrasts: pairs of conditions, the
// first less the second. cells and errors as HierarchicalAnalysis.
RoughFit rough_fit(std::span<const HierarchicalCell> cells, const HierarchicalModel& model,
                   const HierarchicalPlace& near, std::span<const std::array<int, 2>> contrasts);

}  // namespace jnd
