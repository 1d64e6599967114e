// The words that every room shares, as plain records: what is presented, what was delivered, what was answered.
// SI units inside; a unit is part of the name of every field that crosses a boundary.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// What kind of session the data come from. The three are never pooled unless a user asks for it.
enum class SessionKind { real, pilot, simulated };

// Which of the device's channels carry the stimulus.
struct Cues {
  bool force = false;
  bool vibration = false;
  bool operator==(const Cues&) const = default;
};

// One interval's sphere.
struct Stimulus {
  double stiffness_n_per_m = 0;  // > 0
  Cues cues;
  bool operator==(const Stimulus&) const = default;
};

enum class Judgement { same, different };

// Who pressed the key: response times are analysed only where the participant did.
enum class EnteredBy { participant, operator_ };

struct Answer {
  Judgement judgement = Judgement::same;
  EnteredBy entered_by = EnteredBy::participant;
  double response_time_s = 0;  // from the question cue to the key
};

// Why a presentation was not delivered as asked. `none` and `no_contact` need no operator; the others stop the device.
enum class Fault { none, no_contact, stale_pose, non_finite, device_lost, emergency_stop, interrupted };

// What one finger got in one interval. Shares are of contact time, 0..1.
struct FingerPresentation {
  // Least-squares slope through the origin of delivered force on penetration, over the unsaturated samples in contact
  // outside the soft start; none where there is no such sample or no force was commanded.
  std::optional<double> stiffness_n_per_m;
  std::int64_t fit_samples = 0;
  double peak_force_n = 0;
  double deepest_penetration_m = 0;
  double work_j = 0;  // done by the finger on the sphere while loading: integral of force d(penetration), rising part
  double mean_speed_m_per_s = 0;  // mean absolute penetration rate in contact
  int contacts = 0;
  double dwell_s = 0;          // time in contact
  double saturated_share = 0;  // of contact time, the part in which a limit reduced the asked force
  double vibration_g = 0;      // amplitude of the bursts delivered; 0 without one
  bool vibration_clamped = false;
};

// What was really delivered in one interval.
struct Presentation {
  std::vector<FingerPresentation> fingers;  // in the protocol's order of fingers
  double first_contact_s = -1;              // after the interval began; -1 without contact
  double duration_s = 0;
  std::int64_t ticks = 0;
  std::int64_t overruns = 0;   // whole periods skipped
  double lateness_p50_us = 0;  // of the ticks' wake-ups; 0 on the simulated clock
  double lateness_p99_us = 0;
  double lateness_max_us = 0;
  Fault fault = Fault::none;
};

// One planned trial.
struct Trial {
  int index = 0;  // place in the plan, from 1; practice comes first
  int block = 0;  // from 1; 0 for practice
  bool practice = false;
  int round = 0;      // practice round from 1; 0 in the main part
  int series = 0;     // place in Protocol::series, from 0
  int condition = 0;  // place in Protocol::conditions, from 0
  std::array<double, 2> stimuli_n_per_m{};
  bool same = true;
  bool operator==(const Trial&) const = default;
};

// One trial that was carried out and answered: what the log keeps of it.
struct TrialRecord {
  Trial trial;
  int attempt = 1;
  std::string condition_name;
  std::string series_name;
  Answer answer;
  std::array<Presentation, 2> presentations;
  double duration_s = 0;  // from the first cue to the answer
};

std::string_view to_string(SessionKind kind) noexcept;
std::string_view to_string(Judgement judgement) noexcept;
std::string_view to_string(EnteredBy who) noexcept;  // "participant", "operator"
std::string_view to_string(Fault fault) noexcept;
std::optional<SessionKind> session_kind_from(std::string_view text) noexcept;
std::optional<Judgement> judgement_from(std::string_view text) noexcept;

}  // namespace jnd
