#include "devices/participants/perceived_stiffness.h"

#include <algorithm>
#include <cmath>

#include "devices/loop/rendering.h"
#include "protocols/tasks/task.h"

namespace jnd {

StiffnessCues cues_of(const Presentation& presentation) noexcept {
  StiffnessCues cues;
  struct Mean {
    double sum = 0;
    int fitted = 0;
    std::optional<double> value() const { return fitted > 0 ? std::optional(sum / fitted) : std::nullopt; }
  };
  Mean force, kinaesthetic;
  double strongest_g = 0;
  for (const FingerPresentation& finger : presentation.fingers) {
    if (finger.stiffness) {
      Mean& mean = finger.channel == Channel::cutaneous ? force : kinaesthetic;
      mean.sum += *finger.stiffness;
      ++mean.fitted;
    }
    strongest_g = std::max(strongest_g, finger.vibration_g);
  }
  cues.force = force.value();
  cues.kinaesthetic = kinaesthetic.value();
  if (presentation.delivered) cues.kinaesthetic = presentation.delivered;
  if (strongest_g > 0) cues.vibration = stiffness_of_amplitude_n_per_m(strongest_g);
  return cues;
}

PairJudgement judge_cues(const ParticipantProfile& profile, const StiffnessCues& first, const StiffnessCues& second,
                         double noise_factor, const PerceptNoise& noise, double reference) noexcept {
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
  const double sigma_joint = noise_factor * profile.kinaesthetic_weber * reference;
  add(first.vibration, second.vibration, sigma_vibration, noise[2], noise[3]);
  add(first.kinaesthetic, second.kinaesthetic, sigma_joint, noise[4], noise[5]);

  double sigma = std::max(sigma_force, sigma_vibration), difference = 0;
  if (weights > 0) {
    sigma = 1 / std::sqrt(weights);
    difference = weighted / weights;
  } else if (differencing) {
    difference = sigma * (noise[0] - noise[1]);
  }
  const double criterion = profile.criterion_n_per_m > 0 ? profile.criterion_n_per_m : profile.criterion_sigmas * sigma;
  const double evidence = std::abs(difference) + (differencing ? 0 : sigma * noise[0]);
  return {evidence > criterion ? kClassDifferent : kClassSame, std::abs(evidence - criterion), sigma};
}

std::vector<Felt> felt_of(const ParticipantProfile& profile, std::span<const StiffnessCues> intervals,
                          double noise_factor, double reference, const std::function<double()>& draw) {
  struct Cue {
    std::optional<double> StiffnessCues::*value;
    double sigma;
  };
  const std::array<Cue, 3> cues = {{{&StiffnessCues::force, profile.sigma_force_n_per_m},
                                    {&StiffnessCues::vibration, profile.sigma_vibration_n_per_m},
                                    {&StiffnessCues::kinaesthetic, profile.kinaesthetic_weber * std::abs(reference)}}};
  std::vector<double> weights(intervals.size()), sums(intervals.size());
  for (const Cue& cue : cues) {
    const bool everywhere = std::all_of(intervals.begin(), intervals.end(),
                                        [&](const StiffnessCues& one) { return (one.*cue.value).has_value(); });
    // Of one interval: the difference of two has the profile's noise.
    const double sigma = std::max(noise_factor * cue.sigma, 1e-9) / std::sqrt(2.0);
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      const double noise = draw();  // always drawn, so that a cue more or less changes no other draw
      if (!everywhere) continue;
      weights[i] += 1 / (sigma * sigma);
      sums[i] += (*(intervals[i].*cue.value) + sigma * noise) / (sigma * sigma);
    }
  }
  std::vector<Felt> felt;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    // Without any cue to go by: the reference, with the noise of the worst.
    const double sigma = std::max(profile.sigma_force_n_per_m, profile.sigma_vibration_n_per_m) * noise_factor;
    felt.push_back(weights[i] > 0 ? Felt{sums[i] / weights[i], 1 / std::sqrt(weights[i])}
                                  : Felt{reference + sigma * draw(), sigma});
  }
  return felt;
}

}  // namespace jnd
