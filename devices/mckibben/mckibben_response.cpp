#include "devices/mckibben/mckibben_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/numerics/words.h"
#include "protocols/input/input_error.h"

namespace jnd {
namespace {

using std::numbers::pi;

constexpr double kRadToDeg = 180 / pi;
constexpr double kTail_s = 0.4;
constexpr double kLongest_s = 600;
constexpr int kStepsPerSample = 10;
constexpr double kLowest_rad_per_s = 1, kHighest_rad_per_s = 1000;
constexpr int kPerDecade = 10;

void require(bool sound, const char* what, double value, const char* advice) {
  if (!sound) throw InputError(fmt::format("{} of {} cannot be used: {}", what, value, advice));
}

MckibbenPose pose_within(const MckibbenModel& model, double angle_rad) {
  constexpr double kRounding_rad = 1e-6;  // of an angle that was printed with six decimals
  const AngleRange& usable = model.linkage().usable();
  if (!(angle_rad >= usable.min_rad - kRounding_rad && angle_rad <= usable.max_rad + kRounding_rad))
    throw InputError(fmt::format(
        "an angle of {:.6g} rad ({:.3f} deg) is outside the finger's range: give {:.6f} (straight) to {:.6f} rad "
        "(flexed), {:.3f} to {:.3f} deg",
        angle_rad, angle_rad * kRadToDeg, usable.min_rad, usable.max_rad, usable.min_rad * kRadToDeg,
        usable.max_rad * kRadToDeg));
  return *model.pose(angle_rad);
}

void require_force(double force_n, const char* what) {
  require(std::abs(force_n) <= 1000, what, force_n, "give a force between -1000 and 1000 N");
}

// The response at one pose. The verdict counts the tail against the commanded step.
StepResponse respond(const MckibbenModel& model, const MckibbenPose& pose, const StepOptions& options) {
  const auto steps = static_cast<int>(std::lround(options.duration_s / kMckibbenStep_s));
  const double tail_s = std::min(kTail_s, options.duration_s / 3);
  const int tail_from = steps - static_cast<int>(std::lround(tail_s / kMckibbenStep_s));
  MckibbenState state = model.steady_state(pose, options.from_n);
  StepResponse response;
  response.start_n = model.force_n(pose, state.muscle_pa);
  response.final_n = model.force_n(pose, model.steady_state(pose, options.to_n).muscle_pa);
  response.steady_error_n = options.to_n - response.final_n;

  const double direction = options.to_n >= options.from_n ? 1 : -1;
  double farthest = direction * response.start_n, sum = 0;
  std::vector<double> tail;
  tail.reserve(static_cast<std::size_t>(steps) - static_cast<std::size_t>(tail_from) + 1);
  for (int i = 0; i <= steps; ++i) {
    const double force = model.force_n(pose, state.muscle_pa);
    if (i % kStepsPerSample == 0) {
      response.time_s.push_back(i * kMckibbenStep_s);
      response.force_n.push_back(force);
    }
    farthest = std::max(farthest, direction * force);
    if (i >= tail_from) {
      tail.push_back(force);
      sum += force;
    }
    model.regulate(state, pose, options.to_n);
  }
  if (response.final_n != response.start_n)
    response.overshoot_pct =
        100 * (direction * farthest - direction * response.final_n) / std::abs(response.final_n - response.start_n);

  const auto [least, most] = std::minmax_element(tail.begin(), tail.end());
  response.oscillation_pp_n = *most - *least;
  response.tail_mean_n = sum / static_cast<double>(tail.size());
  const double share = response.oscillation_pp_n / std::abs(options.to_n - options.from_n);
  response.verdict = share < 0.01   ? StepVerdict::stable
                     : share < 0.05 ? StepVerdict::ringing
                                    : StepVerdict::limit_cycle;

  // Rising crossings of the mean, interpolated. What is left of rounding is no oscillation.
  if (share < 1e-6) return response;
  double first = 0, last = 0;
  int crossings = 0;
  for (std::size_t i = 1; i < tail.size(); ++i) {
    const double before = tail[i - 1] - response.tail_mean_n, after = tail[i] - response.tail_mean_n;
    if (!(before < 0 && after >= 0)) continue;
    last = (static_cast<double>(i) - after / (after - before)) * kMckibbenStep_s;
    if (crossings++ == 0) first = last;
  }
  if (crossings > 1) response.oscillation_rad_per_s = 2 * pi * (crossings - 1) / (last - first);
  return response;
}

struct Fundamental {
  double magnitude = 0, phase_rad = 0;
};

// F under Fref = mean + amplitude sin(w t), after some cycles: whole cycles, each of whole steps.
Fundamental fundamental(const MckibbenModel& model, const MckibbenPose& pose, const BodeOptions& options,
                        double w_rad_per_s) {
  const double period_s = 2 * pi / w_rad_per_s;
  const int steps = std::max(16, static_cast<int>(std::ceil(period_s / kMckibbenStep_s)));
  const double step_s = period_s / steps;
  const int settle = options.settle_cycles, measure = options.measure_cycles;
  MckibbenState state = model.steady_state(pose, options.mean_n);
  double in_phase = 0, quadrature = 0;
  for (int cycle = 0; cycle < settle + measure; ++cycle) {
    for (int i = 0; i < steps; ++i) {
      const double sine = std::sin(2 * pi * i / steps);
      if (cycle >= settle) {
        const double force = model.force_n(pose, state.muscle_pa);
        in_phase += force * sine;
        quadrature += force * std::cos(2 * pi * i / steps);
      }
      // Fref is held over a step at its value in the middle.
      model.regulate(state, pose, options.mean_n + options.amplitude_n * std::sin(2 * pi * (i + 0.5) / steps), step_s);
    }
  }
  const double scale = 2 / (static_cast<double>(measure) * steps * options.amplitude_n);
  return {.magnitude = scale * std::hypot(in_phase, quadrature), .phase_rad = std::atan2(quadrature, in_phase)};
}

std::vector<double> default_frequencies() {
  std::vector<double> list;
  const int points = static_cast<int>(std::lround(kPerDecade * std::log10(kHighest_rad_per_s / kLowest_rad_per_s)));
  for (int i = 0; i <= points; ++i)
    list.push_back(kLowest_rad_per_s * std::pow(10, static_cast<double>(i) / kPerDecade));
  return list;
}

std::optional<double> bandwidth(const MckibbenModel& model, const MckibbenPose& pose, const BodeOptions& options,
                                double dc) {
  // High up, six cycles are over before the muscle's mean pressure has settled.
  constexpr double kSettle_s = 0.5, kMeasure_s = 0.2;
  const auto is_below = [&](double w) {
    BodeOptions longer = options;
    longer.settle_cycles = std::max(options.settle_cycles, static_cast<int>(std::ceil(kSettle_s * w / (2 * pi))));
    longer.measure_cycles = std::max(options.measure_cycles, static_cast<int>(std::ceil(kMeasure_s * w / (2 * pi))));
    return fundamental(model, pose, longer, w).magnitude < dc / std::sqrt(2.0);
  };
  double low = 0;
  for (const double w : default_frequencies()) {
    if (!is_below(w)) {
      low = w;
      continue;
    }
    double high = w;
    if (low == 0) return high;
    while (high - low > 1e-3 * low) {
      const double middle = (low + high) / 2;
      (is_below(middle) ? high : low) = middle;
    }
    return high;
  }
  return std::nullopt;
}

}  // namespace

std::string_view to_string(StepVerdict verdict) noexcept {
  constexpr auto kWords = words<StepVerdict>(
      {{"stable", StepVerdict::stable}, {"ringing", StepVerdict::ringing}, {"limit cycle", StepVerdict::limit_cycle}});
  return word_of(kWords, verdict);
}

StepResponse step_response(const MckibbenParameters& parameters, const StepOptions& options) {
  const MckibbenModel model(parameters, options.loop.tendon, options.loop.gains);
  const MckibbenPose pose = pose_within(model, options.angle_rad);
  require_force(options.from_n, "a step from a force");
  require_force(options.to_n, "a step to a force");
  require(options.to_n != options.from_n, "a step to the same force", options.to_n, "give two different forces");
  require(options.duration_s >= 0.01 && options.duration_s <= kLongest_s, "a duration", options.duration_s,
          "give 0.01 to 600 s");
  return respond(model, pose, options);
}

FrequencyResponse frequency_response(const MckibbenParameters& parameters, const BodeOptions& options) {
  const MckibbenModel model(parameters, options.loop.tendon, options.loop.gains);
  const MckibbenPose pose = pose_within(model, options.angle_rad);
  require_force(options.mean_n, "a mean force");
  require(options.amplitude_n > 0 && options.amplitude_n <= 1000, "an amplitude", options.amplitude_n,
          "give more than 0 and at most 1000 N");
  FrequencyResponse response;
  response.frequency_rad_per_s =
      options.frequency_rad_per_s.empty() ? default_frequencies() : options.frequency_rad_per_s;
  for (const double w : response.frequency_rad_per_s)
    require(w >= 0.1 && w <= 10000, "a frequency", w, "give 0.1 to 10000 rad/s");
  std::sort(response.frequency_rad_per_s.begin(), response.frequency_rad_per_s.end());

  const ForceGains& gains = options.loop.gains;
  const double loop_gain = pose.ka_n_per_pa() * parameters.kv_pa_per_v * gains.kp;
  response.dc = gains.ki > 0 ? 1 : loop_gain / (1 + loop_gain);
  for (const double w : response.frequency_rad_per_s) {
    const Fundamental at = fundamental(model, pose, options, w);
    const double before = response.phase_rad.empty() ? 0 : response.phase_rad.back();
    response.magnitude.push_back(at.magnitude);
    response.phase_rad.push_back(before + std::remainder(at.phase_rad - before, 2 * pi));
  }
  response.bandwidth_rad_per_s = bandwidth(model, pose, options, response.dc);
  return response;
}

TrackResult track(const MckibbenParameters& parameters, const TrackOptions& options) {
  const MckibbenModel model(parameters, options.loop.tendon, options.loop.gains);
  require(options.kobj_n_per_rad > 0 && options.kobj_n_per_rad <= 1000, "an object's stiffness", options.kobj_n_per_rad,
          "give more than 0 and at most 1000 N/rad");
  require(options.frequency_hz >= 0.01 && options.frequency_hz <= 20, "a flexion frequency", options.frequency_hz,
          "give 0.01 to 20 Hz");
  const AngleRange& usable = model.linkage().usable();
  const int steps = static_cast<int>(std::ceil(1 / (options.frequency_hz * kMckibbenStep_s)));
  const double step_s = 1 / (options.frequency_hz * steps);
  // How far the finger is flexed, from straight, at a share of the cycle.
  const auto flexion = [&](double share) {
    return (usable.max_rad - usable.min_rad) * (1 - std::cos(2 * pi * share)) / 2;
  };

  TrackResult result;
  MckibbenPose pose = *model.pose(usable.min_rad);
  MckibbenState state = model.steady_state(pose, 0);
  double squares = 0, force_on_flexion = 0, flexion_squares = 0;
  for (int i = 0; i < 2 * steps; ++i) {
    const double flexed = flexion(static_cast<double>(i) / steps);
    if (i >= steps) {
      const double reference = options.kobj_n_per_rad * flexed;
      const double force = model.force_n(*model.pose(usable.min_rad + flexed), state.muscle_pa);
      if (i == steps) result.force_peak_n = result.force_min_n = force;
      result.force_peak_n = std::max(result.force_peak_n, force);
      result.force_min_n = std::min(result.force_min_n, force);
      result.reference_peak_n = std::max(result.reference_peak_n, reference);
      squares += (reference - force) * (reference - force);
      force_on_flexion += force * flexed;
      flexion_squares += flexed * flexed;
    }
    const double middle = flexion((i + 0.5) / steps);
    pose = *model.pose(usable.min_rad + middle);
    model.regulate(state, pose, options.kobj_n_per_rad * middle, step_s);
  }
  result.rms_error_n = std::sqrt(squares / steps);
  result.rendered_n_per_rad = force_on_flexion / flexion_squares;
  return result;
}

std::optional<double> onset_of_oscillation(const MckibbenParameters& parameters, double angle_rad) {
  StepOptions options{.loop = {}, .angle_rad = angle_rad, .from_n = 0, .to_n = 5, .duration_s = 6};
  const auto oscillates = [&](double kp) {
    options.loop.gains = {.kp = kp};
    const MckibbenModel model(parameters, options.loop.tendon, options.loop.gains);
    const std::optional<MckibbenPose> pose = model.pose(angle_rad);
    if (!pose)
      throw InputError(fmt::format("the linkage does not assemble at {:.6g} rad: give {:.6f} to {:.6f} rad", angle_rad,
                                   model.linkage().assembles().min_rad, model.linkage().assembles().max_rad));
    return respond(model, *pose, options).oscillation_pp_n > 0.02 * (options.to_n - options.from_n);
  };
  double low = 0, high = 10;
  if (!oscillates(high)) return std::nullopt;
  while (high - low > 1e-3) {
    const double middle = (low + high) / 2;
    (oscillates(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace jnd
