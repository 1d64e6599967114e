// What answers depend on besides a person's spread and criterion, the same for everybody.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

// place: from 0, among `trials` of somebody in a condition; the one in the middle is of the first half.
constexpr bool in_second_half(std::size_t place, std::size_t trials) noexcept {
  return 2 * place >= trials;
}

struct HierarchicalCell;  // hierarchical_likelihood.h

struct SharedParameters {
  double lapse = 0;  // 0 <= lapse < 1: on that share of trials the answer is a guess
  // 0 <= overdispersion < 1: how much more alike the answers of one person, condition and level (and half) are than
  // independent ones, as the intra-class correlation r of a beta-binomial distribution: the probability of an answer
  // varies between such sets with the variance r p (1 - p).
  // Source: Schuett, Harmeling, Macke and Wichmann 2016, Vision Res 122:105 (over-dispersed psychometric functions).
  double overdispersion = 0;
  // The second half of a person's trials in a condition less the first: of ln s, and of the criterion in its own unit.
  // Each half lies half of it beside the person's ln s and criterion.
  double drift_ln_s = 0, drift_criterion = 0;

  // Where answers are sure or unsure: how far above and below the criterion, in its unit, the criteria of the sure ones
  // lie; > 0. Infinite: no such answer is sure (nobody was asked, or nobody used both).
  double sure_below = kInf, sure_above = kInf;

  bool graded() const noexcept { return std::isfinite(sure_below) || std::isfinite(sure_above); }
  friend bool operator==(const SharedParameters&, const SharedParameters&) = default;
};

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
// A number of each, in that order.
using OfSharedParameters = std::array<double, kSharedParameters.size()>;

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
  friend bool operator==(const SharedForm&, const SharedForm&) = default;
};

// Whether it is in the unit of the criterion.
bool of_criterion(SharedParameter which) noexcept;
// Whether it is a rate, which is 0 at least.
bool at_least_zero(SharedParameter which) noexcept;

// What is searched: from 0 (drift: from minus that) to a lapse rate of 0.5, a correlation of 0.9, a drift of 3 in ln s
// and of 3 units of the criterion; criteria of sureness from 0.02 to 8 units away from it.
struct SharedLimits {
  double low = 0, high = 0;
};
SharedLimits limits_of(SharedParameter which, double criterion_unit) noexcept;

// Where a search begins that knows nothing: a little above 0, where lapses and over-dispersion have a slope to follow.
SharedParameters first_shared(const SharedForm& form, const SharedParameters& held) noexcept;

// So far beside a value another one is taken for the derivative by the parameter.
double step_of(SharedParameter which, double value, double criterion_unit) noexcept;

}  // namespace jnd
