#include "devices/perceived_stiffness.h"

#include <algorithm>
#include <cmath>

#include "devices/rendering.h"

namespace jnd {

StiffnessCues cues_of(const Presentation& presentation) noexcept {
  StiffnessCues cues;
  double sum = 0, strongest_g = 0;
  int fitted = 0;
  for (const FingerPresentation& finger : presentation.fingers) {
    if (finger.stiffness_n_per_m) {
      sum += *finger.stiffness_n_per_m;
      ++fitted;
    }
    strongest_g = std::max(strongest_g, finger.vibration_g);
  }
  if (fitted > 0) cues.force = sum / fitted;
  if (strongest_g > 0) cues.vibration = stiffness_of_amplitude_n_per_m(strongest_g);
  return cues;
}

Judgement judge_cues(const ParticipantProfile& profile, const StiffnessCues& first, const StiffnessCues& second,
                     double noise_factor, const PerceptNoise& noise) noexcept {
  const bool differencing = profile.strategy == ParticipantProfile::Strategy::differencing;
  double weights = 0, weighted = 0;
  const auto add = [&](const std::optional<double>& k1, const std::optional<double>& k2, double sigma, double n1,
                       double n2) {
    if (!k1 || !k2) return;
    // A cue without noise would get all the weight: it is given a hundredth of a newton a metre instead.
    const double used = std::max(sigma, 0.01);
    const double weight = 1 / (used * used);
    weights += weight;
    weighted += weight * (*k1 - *k2 + (differencing ? used * (n1 - n2) : 0));
  };
  const double sigma_force = noise_factor * profile.sigma_force_n_per_m;
  const double sigma_vibration = noise_factor * profile.sigma_vibration_n_per_m;
  add(first.force, second.force, sigma_force, noise[0], noise[1]);
  add(first.vibration, second.vibration, sigma_vibration, noise[2], noise[3]);

  double sigma = std::max(sigma_force, sigma_vibration), difference = 0;
  if (weights > 0) {
    sigma = 1 / std::sqrt(weights);
    difference = weighted / weights;
  } else if (differencing) {
    difference = sigma * (noise[0] - noise[1]);
  }
  const double criterion = profile.criterion_n_per_m > 0 ? profile.criterion_n_per_m : profile.criterion_sigmas * sigma;
  const double evidence = std::abs(difference) + (differencing ? 0 : sigma * noise[0]);
  return evidence > criterion ? Judgement::different : Judgement::same;
}

}  // namespace jnd
