// What answers depend on besides a person's spread and criterion, the same for everybody.
#pragma once

#include <cmath>
#include <cstddef>

#include "analysis/numerics/special_values.h"

namespace jnd {

// place: from 0, among `trials` of somebody in a condition; the one in the middle is of the first half.
constexpr bool in_second_half(std::size_t place, std::size_t trials) noexcept {
  return 2 * place >= trials;
}

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

}  // namespace jnd
