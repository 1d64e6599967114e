// The largest marginal likelihood over what is the same for everybody too: lapses, over-dispersion, drift, criteria
// of sureness.
//
// At fixed values of these the likelihood is maximised over everything else (hierarchical_search.h); of that profile
// damped Newton steps find the top. Its slope is the partial one at the inner maximum, by differences of ln L.
//
// Source: Venzon and Moolgavkar 1988, Appl Statist 37:87 (slopes of a profile). Tests: values by brute force on a grid,
// drawn answers with known parameters.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "analysis/hierarchical/hierarchical_search.h"
#include "analysis/numerics/words.h"

namespace jnd {

enum class SharedParameter { lapse, overdispersion, drift_ln_s, drift_criterion, sure_below, sure_above };
inline constexpr std::array kSharedParameters = {SharedParameter::lapse,      SharedParameter::overdispersion,
                                                 SharedParameter::drift_ln_s, SharedParameter::drift_criterion,
                                                 SharedParameter::sure_below, SharedParameter::sure_above};
inline constexpr auto kSharedParameterWords =
    words<SharedParameter>({{"lapse", SharedParameter::lapse},
                            {"overdispersion", SharedParameter::overdispersion},
                            {"drift_ln_jnd", SharedParameter::drift_ln_s},
                            {"drift_criterion", SharedParameter::drift_criterion},
                            {"sure_below", SharedParameter::sure_below},
                            {"sure_above", SharedParameter::sure_above}});

double& value_of(SharedParameters& shared, SharedParameter which) noexcept;
double value_of(const SharedParameters& shared, SharedParameter which) noexcept;

// Which are estimated.
struct SharedForm {
  std::array<bool, kSharedParameters.size()> free{};

  bool any() const noexcept { return std::find(free.begin(), free.end(), true) != free.end(); }
  bool has(SharedParameter which) const noexcept { return free[static_cast<std::size_t>(which)]; }
  SharedForm with(SharedParameter which, bool estimated = true) const noexcept;
  // Those that such answers can tell: of the lapse rate three levels, of over-dispersion several answers of somebody in
  // one condition at one level (and in one half), of drift both halves of somebody in one condition,
  // of a criterion of sureness sure and unsure answers on its side.
  SharedForm identified(std::span<const HierarchicalCell> cells) const;
};

// What is searched: from 0 (drift: from minus that) to a lapse rate of 0.5, a correlation of 0.9, a drift of 3 in ln s
// and of 3 units of the criterion; criteria of sureness from
// 0.02 to 8 units away from it.
struct SharedLimits {
  double low = 0, high = 0;
};
SharedLimits limits_of(SharedParameter which, double criterion_unit) noexcept;

// Where a search begins that knows nothing: a little above 0, where lapses and over-dispersion have a slope to follow.
SharedParameters first_shared(const SharedForm& form, const SharedParameters& held) noexcept;

// As maximise() of hierarchical_search.h, from the place, the shared parameters and their curvature, if known, of
// `from`; what is not estimated keeps its value. shared_negligible: of differences of ln L by shared parameters. Leaves
// the likelihood with those of the maximum.
HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const SharedForm& shared_form, const HierarchicalMaximum& from, double criterion_unit = 1,
                             double negligible = 1e-8, double shared_negligible = 1e-8);

// Of ln L by one shared parameter, everything else as in the maximum.
struct SharedSlope {
  double slope = 0, curvature = 0;  // the second: minus the second derivative
};
SharedSlope slope_of(HierarchicalLikelihood& likelihood, const HierarchicalMaximum& maximum, SharedParameter which,
                     double criterion_unit = 1);

}  // namespace jnd
