// From what was delivered to a judgement: the cues that a simulated participant has, and the two strategies.
//
// A participant has at most one estimate of each cue in an interval:
//   force      the fitted slope of delivered force on penetration, mean of the fingers that have one;
//   kinaesthetic  the same slope at the joint; or what a rig that is none of our devices says that it delivered;
//   vibration  1500 (A / g - 0.4) N/m from the delivered amplitude A, (38) read backwards, of the strongest finger.
// A cue that only one interval has cannot be compared and is not used. Cues combine with weights 1 / sigma^2 (maximum
// likelihood), so that 1 / sigma^2 of the combination is the sum over cues.
//   magnitude      "different" when |k1 - k2| + N(0, sigma^2) > c: estimates are exact, the one noise is on the
//   difference; differencing   "different" when |(k1 + n1) - (k2 + n2)| > tau: every estimate of every interval has its
//   noise.
// Without any cue to compare, the difference is 0 and the noise that of the profile's worse cue: a bias, no
// information.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "devices/participants/simulated_participant.h"
#include "protocols/tasks/task.h"
#include "protocols/vocabulary.h"

namespace jnd {

// N/m, but for a joint in N/rad; none where the interval did not carry the cue.
struct StiffnessCues {
  std::optional<double> force;
  std::optional<double> vibration;
  std::optional<double> kinaesthetic{};  // in the study's unit
};

StiffnessCues cues_of(const Presentation& presentation) noexcept;

// Standard normal draws: force in intervals 1 and 2, vibration in 1 and 2, kinaesthetic in 1 and 2. `magnitude` uses
// the first.
using PerceptNoise = std::array<double, 6>;

// What a pair was judged to be, and by how much.
struct PairJudgement {
  int said = kClassSame;  // or kClassDifferent
  double beyond = 0;      // distance of the evidence from the criterion, >= 0, N/m (of a joint N/rad)
  double sigma = 0;       // of the evidence's noise
};

// noise_factor scales all sigmas (spread between participants, fatigue), not a fixed criterion; 1 = the profile's.
// reference: the study's, of which the kinaesthetic noise is a fraction.
PairJudgement judge_cues(const ParticipantProfile& profile, const StiffnessCues& first, const StiffnessCues& second,
                         double noise_factor, const PerceptNoise& noise, double reference = 0) noexcept;

// What is felt of each interval of any other task: its cues combined with weights 1 / sigma^2, each with a noise of its
// own, so that the difference of two intervals has the profile's sigma. Only cues that every interval has are used. `draw`
// gives standard normals.
std::vector<Felt> felt_of(const ParticipantProfile& profile, std::span<const StiffnessCues> intervals,
                          double noise_factor, double reference, const std::function<double()>& draw);

}  // namespace jnd
