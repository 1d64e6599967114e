// Do groups (conditions, participants) differ in location or in slope? Nested psychometric functions, compared by the
// likelihood ratio.
//
// Source: Kingdom and Prins 2016, Psychophysics, 2nd edition, chapter 9 (nested models of several conditions).
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric.h"

namespace jnd {

// What the groups share. Location means the PSE; slope the second parameter (beta, sigma, shape).
enum class PsychometricSharing {
  same_function,  // everything
  own_location,   // the slope
  own_slope,      // the location
  own_function    // neither
};
std::string_view to_string(PsychometricSharing sharing) noexcept;

struct SharingFit {
  PsychometricSharing sharing = PsychometricSharing::same_function;
  // As of a single fit; of the first group in trouble where slopes or locations are their own.
  PsychometricStatus status = PsychometricStatus::not_identified;
  int parameters = 0;
  double log_likelihood = kNaN;  // without binomial constants; NaN unless an estimate
  double lapse = kNaN;           // one and the same for all groups
  double guess = kNaN;
};

struct SharingTest {
  PsychometricSharing simpler = PsychometricSharing::same_function, general = PsychometricSharing::own_function;
  double chi_square = kNaN;  // 2 (log-likelihood of general - of simpler)
  int df = 0;
  double p = kNaN;                                     // upper tail of chi-square
  PsychometricStatus status = PsychometricStatus::ok;  // of the fit that is no estimate; then chi_square and p are NaN
};

struct PsychometricComparison {
  int groups = 0;
  std::array<SharingFit, 4> fits;  // in the order of the enumeration
  // Location, slope and both beside one function; slope beside own_location; location beside own_slope.
  std::array<SharingTest, 5> tests;
};

// Maximum likelihood in every model (a prior is not used). A free lapse or guess is one and the same for all groups in
// every model, so that the tests concern locations and slopes alone. Each model is searched from what the models within
// it found, so that it is never less likely than they are, and from the best of each group at many rates, slopes and
// places. At least two groups. Throws std::invalid_argument as fit_psychometric, and for fewer groups.
PsychometricComparison compare_psychometric(std::span<const std::vector<PsychometricLevel>> groups,
                                            const PsychometricModel& asked);

}  // namespace jnd
