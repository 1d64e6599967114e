// A participant who does not exist: explores like a hand, feels only what the device delivered, and answers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "devices/clock.h"
#include "devices/responder.h"
#include "devices/rig.h"
#include "protocols/protocol.h"

namespace jnd {

struct RatingHabit {
  double mean = 0, sd = 0;  // of a normal that is rounded and clipped to the question's scale
};

// How a question is answered, by its id.
struct AnswerHabit {
  std::optional<RatingHabit> rating{};           // whatever the condition
  std::map<std::string, RatingHabit> ratings{};  // by condition name; stands before `rating`
  std::map<std::string, double> choices{};       // option -> weight, >= 0; options that are not named have none
};

// JSON form: devices/profiles/*.json. See science of the strategies in devices/README.md.
struct ParticipantProfile {
  enum class Strategy { magnitude, differencing } strategy = Strategy::magnitude;
  std::string name;
  std::string title;
  std::string notes;   // where its numbers come from; may be empty
  std::string sha256;  // of the file
  // The reference at which noise and criterion were measured: at another one they keep their Weber fractions. 0: they
  // are the same whatever the reference.
  double calibrated_at_n_per_m = 0;
  double sigma_force_n_per_m = 0;      // noise of the force cue
  double sigma_vibration_n_per_m = 0;  // noise of the vibration cue
  // Noise of the kinaesthetic cue as a fraction of the protocol's reference, because joints are measured in N/rad and
  // contacts in N/m: the differential threshold of stiffness at the elbow, 23 % (Jones and Hunter 1990, Exp. Brain Res.
  // 79, 150-156).
  double kinaesthetic_weber = 0.23;
  // The criterion: a fixed difference, or a multiple of the condition's combined sigma; exactly one is > 0.
  double criterion_n_per_m = 0;
  double criterion_sigmas = 0;
  double lapse_rate = 0;       // share of trials answered by a coin
  double drift_per_trial = 0;  // relative growth of the noise over one trial (fatigue)
  double spread_cv = 0;        // between participants, of the noise (log-normal)
  double response_time_median_s = 1.2, response_time_sigma = 0.3;  // log-normal
  // The hand
  double press_depth_m = 0.005, press_depth_sd_m = 0.001;  // used when the protocol gives no expectation
  double closing_speed_m_per_s = 0.05;
  double press_period_s = 1.0;
  double lateral_sd_m = 0.001;
  double pulp_stiffness_n_per_m = 1000;
  std::map<std::string, std::pair<double, double>> ratings;  // condition name -> mean, SD of its effectiveness rating
  std::map<std::string, AnswerHabit> answers;                // question id -> how it is answered, before `ratings`
};

ParticipantProfile load_profile(const std::filesystem::path& path);                   // throws InputError
ParticipantProfile parse_profile(const std::string& bytes, const std::string& file);  // file: its name in messages

// The profile with its noise and its fixed criterion at a study's reference. Unchanged where the study is not in N/m.
ParticipantProfile at_reference(ParticipantProfile profile, const StimulusSpec& stimulus);

// The profile that fits a protocol where a user names none.
std::string default_profile(const Protocol& protocol);

// Answers for one participant of one study; protocol must outlive it. Throws InputError where the profile's criterion is in N/m and the study's
// stiffness is not. All randomness is keyed by (seed, participant, trial, attempt), so that a resumed session answers
// exactly as an undisturbed one.
std::unique_ptr<Responder> make_simulated_participant(const ParticipantProfile& profile, const Protocol& protocol,
                                                      int participant, std::uint64_t seed, Clock& clock);

}  // namespace jnd
