// Experiments with the model of the McKibben finger: response to a step of Fref, frequency response, tracking of a
// virtual object during flexion, and where sustained oscillation begins. Forces N, angles rad, times s, frequencies
// rad/s unless the name says otherwise.
//
// All throw InputError where an option is out of its range.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devices/mckibben/mckibben_model.h"

namespace jnd {

struct LoopOptions {
  ForceGains gains{.kp = 0.28};  // the paper's
  Tendon tendon = Tendon::bilateral;
};

struct StepOptions {
  LoopOptions loop;
  double angle_rad = 0;  // within the usable range
  double from_n = 0, to_n = 0;
  double duration_s = 1.2;
};

enum class StepVerdict : std::uint8_t { stable, ringing, limit_cycle };
std::string_view to_string(StepVerdict verdict) noexcept;  // "stable", "ringing", "limit cycle"

// The tail is the last 0.4 s, or the last third of a shorter run.
struct StepResponse {
  std::vector<double> time_s, force_n;  // every millisecond
  double start_n = 0;                   // settled at from_n
  double final_n = 0;                   // analytic steady state at to_n
  double steady_error_n = 0;            // to_n - final_n
  double overshoot_pct = 0;             // 100 (max F - final) / (final - start), on the far side of a falling step
  double oscillation_pp_n = 0;          // of the tail
  double oscillation_rad_per_s = 0;     // of the tail, by its crossings of the mean; 0: no oscillation
  double tail_mean_n = 0;
  StepVerdict verdict = StepVerdict::stable;  // tail peak-to-peak under 1 %, under 5 %, or more of the step
};

StepResponse step_response(const MckibbenParameters& parameters, const StepOptions& options);

struct BodeOptions {
  LoopOptions loop;
  double angle_rad = 0;
  double mean_n = 0, amplitude_n = 0;       // of Fref
  std::vector<double> frequency_rad_per_s;  // empty: 1..1000 rad/s, ten a decade
  // Whole cycles to let pass and then to measure. Six and three are the window of the published figures' independent
  // check: settled up to the bandwidth; above it, with large amplitudes, the muscle's mean pressure still drifts
  // (0.2406 at 160 rad/s for 8 N about 10 N, 0.2300 after two hundred cycles).
  int settle_cycles = 6, measure_cycles = 3;
};

struct FrequencyResponse {
  std::vector<double> frequency_rad_per_s;  // rising
  std::vector<double> magnitude;            // fundamental of F over Fref
  std::vector<double> phase_rad;            // without jumps of 2 pi along the list; the first within +-pi
  double dc = 0;                            // gain of a slow change, analytic
  // First frequency with magnitude < dc / sqrt(2), whatever frequencies are asked; empty if none up to 1000 rad/s.
  // It depends on the amplitude: about 80 rad/s for 8 N about 10 N, 436 rad/s for 0.1 N about 5 N.
  std::optional<double> bandwidth_rad_per_s;
};

FrequencyResponse frequency_response(const MckibbenParameters& parameters, const BodeOptions& options);

struct TrackOptions {
  LoopOptions loop;
  double kobj_n_per_rad = 0;
  double frequency_hz = 0.5;
};

// alpha1 = straight + (flexed - straight) (1 - cos(2 pi f t)) / 2, Fref = Kobj (alpha1 - straight); second cycle.
struct TrackResult {
  double force_peak_n = 0, force_min_n = 0;
  double rms_error_n = 0;
  double reference_peak_n = 0;
  double rendered_n_per_rad = 0;  // F on alpha1 - straight, least squares through the origin
};

TrackResult track(const MckibbenParameters& parameters, const TrackOptions& options);

// KP*: the least proportional gain of pure P control, V/N, at which a step from 0 to 5 N leaves an oscillation of more
// than 2 % of the commanded step, by bisection to 0.001 V/N. Empty if none up to 10 V/N.
std::optional<double> onset_of_oscillation(const MckibbenParameters& parameters, double angle_rad);

}  // namespace jnd
