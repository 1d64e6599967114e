// Which physical cue explains the answers of a participant? Stiffness is confounded with force and work (Tan, Durlach,
// Beauregard and Srinivasan 1995, Perception & Psychophysics 57:495-510): who answers "different" may have compared
// something else.
//
// For each cue, P("different") = Phi(l + b z), z the absolute difference of the cue between the two intervals of a
// trial, as delivered, standardised over the trials used (mean 0, SD 1 with n in the denominator). Maximum likelihood.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "analysis/numerics/special_values.h"

namespace jnd {

enum class Cue { stiffness, peak_force, work, dwell };
inline constexpr std::array kCues = {Cue::stiffness, Cue::peak_force, Cue::work, Cue::dwell};
std::string_view to_string(Cue cue) noexcept;

struct CueTrial {
  bool said_different = false;
  // |interval 1 - interval 2| of each cue, in the order of kCues: N/m, N, J, s. Finite and >= 0; none where the trial
  // has no value of that cue.
  std::array<std::optional<double>, kCues.size()> difference;
};

enum class CueStatus {
  ok,
  too_few_trials,  // fewer than 20 with this cue (for a partial test: with both cues)
  no_information,  // the same answer throughout
  no_variation,    // the cue, or what it adds to stiffness, is the same in every trial
  separated        // a threshold on the predictors divides the answers without error: the slope is infinite
};
std::string_view to_string(CueStatus status) noexcept;
inline constexpr int kFewestCueTrials = 20;

// What a cue adds to stiffness: the model with both against the one with stiffness alone, on the trials that have both.
struct CuePartialTest {
  CueStatus status = CueStatus::too_few_trials;
  int n = 0;
  double chi_square = kNaN;  // likelihood ratio, df 1; NaN unless ok
  double p = kNaN;
};

struct CueFit {
  Cue cue = Cue::stiffness;
  CueStatus status = CueStatus::too_few_trials;
  int n = 0;        // trials used
  int missing = 0;  // trials without a value of this cue
  // NaN unless ok; under separated the log-likelihood is its supremum 0 or that of the tied trials, and b is +-inf.
  double intercept = kNaN;  // l
  double slope = kNaN;      // b, per standard deviation of the difference
  double slope_se = kNaN;   // from the observed information
  double sd = kNaN;         // of the difference, in its unit
  double log_likelihood = kNaN;
  double deviance_explained = kNaN;  // 1 - deviance / deviance of a constant rate
  double aic = kNaN;                 // 4 - 2 log-likelihood; same trials only
  CuePartialTest beside_stiffness;   // no_variation for stiffness itself
};

struct CueStrategy {
  std::array<CueFit, kCues.size()> cues;
  // The cue whose fit is likeliest on the trials that have every cue with a fit, among those with b > 0; none where
  // that is undecided: no cue with b > 0, or fewer than 20 such trials (status says why).
  std::optional<Cue> best;
  CueStatus status = CueStatus::too_few_trials;
  int common_trials = 0;  // on which the cues are compared
};

CueStrategy cue_strategy(std::span<const CueTrial> trials);

}  // namespace jnd
