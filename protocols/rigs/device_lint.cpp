#include "protocols/rigs/device_lint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <fmt/format.h>

#include "analysis/numerics/decimal_order.h"
#include "analysis/numerics/normal.h"
#include "protocols/reading/protocol_reading.h"

namespace jnd {

namespace {

constexpr double kPressSd_m = 0.001;
constexpr double kPressSdOfJoint = 0.2;  // of the expected depth
constexpr double kHandPeriod_s = 1, kJointPeriod_s = 2;
constexpr int kDepths = 400;  // equally probable ones, in place of the distribution: the share is good to 0.1 %

bool flexes_joint(const Protocol& protocol) noexcept {
  return protocol.rig.contact_flexion_rad > 0;
}

}  // namespace

double depth_at_force_limit(double stiffness, const DeviceSpec& spec, double force_gain) noexcept {
  return spec.max_force_n / (force_gain * stiffness);
}

double expected_press_sd(const Protocol& protocol) noexcept {
  return flexes_joint(protocol) ? kPressSdOfJoint * protocol.stimulus.expected_press : kPressSd_m;
}

double expected_saturated_intervals(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                    double force_gain) noexcept {
  const double period_s = flexes_joint(protocol) ? kJointPeriod_s : kHandPeriod_s;
  const double presses = std::max(1.0, std::floor(protocol.timeline.explore_s / period_s)) *
                         static_cast<double>(protocol.rig.fingers.size());
  const double margin = depth_at_force_limit(stiffness, spec, force_gain) - protocol.stimulus.expected_press;
  return 1 - std::pow(normal_cdf(margin / expected_press_sd(protocol)), presses);
}

double expected_saturated_share(double stiffness, const Protocol& protocol, const DeviceSpec& spec,
                                double force_gain) noexcept {
  const double limit = depth_at_force_limit(stiffness, spec, force_gain);
  double sum = 0;
  for (int i = 0; i < kDepths; ++i) {
    const double depth =
        protocol.stimulus.expected_press + expected_press_sd(protocol) * normal_quantile((i + 0.5) / kDepths);
    if (depth > limit) sum += 1 - std::asin(limit / depth) / (std::numbers::pi / 2);
  }
  return sum / kDepths;
}

namespace {

// A lint in the making: what is asked, of which rig, and what was found.
struct DeviceLinting {
  const Protocol& protocol;
  const RigSpec& rig;
  const std::string& file;
  JsonNode root;
  const AdaptiveProcedure* procedure = nullptr;  // null where the levels are given
  DeviceLint lint = {};

  void error(const std::string& path, std::string message, std::string suggestion) {
    lint.errors.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
  }
  void warn(const std::string& path, std::string message, std::string suggestion) {
    lint.warnings.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
  }

  // Does any condition have it?
  bool any(bool Cues::*cue) const {
    return std::any_of(protocol.conditions.begin(), protocol.conditions.end(),
                       [cue](const Condition& condition) { return condition.cues.*cue; });
  }
  // Of all series.
  std::set<double> stiffnesses() const {
    std::set<double> all;
    for (const Series& series : protocol.series) {
      all.insert(series.pair.begin(), series.pair.end());
      all.insert(series.levels.begin(), series.levels.end());
    }
    if (procedure != nullptr)
      for (const double start : procedure->starts) all.insert(plain_sum(protocol.stimulus.reference, -start));
    if (protocol.explore) all.insert(protocol.stimulus.reference);
    return all;
  }
  bool in_metres() const { return protocol.stimulus.unit == Unit::n_per_m; }
  std::string_view unit() const { return to_string(protocol.stimulus.unit); }
  // "5.22 mm" or "0.240 rad"
  std::string depth(double value) const {
    return in_metres() ? fmt::format("{:.2f} mm", 1e3 * value) : fmt::format("{:.3f} rad", value);
  }
  // Of the expected press.
  std::string press_path() const {
    return fmt::format("$.stimulus.expected_press_{}", length_suffix(protocol.stimulus.unit));
  }
  // Where the stiffnesses of a series are written; beside an adaptive procedure, which makes its own series: its clamp
  // or its levels.
  std::string series_path() const {
    if (procedure != nullptr) return limits_path(*procedure);
    return std::string(task_of(protocol.task.kind).values_path());
  }
  std::string pair_path(std::size_t series) const {
    const bool pairs = task_of(protocol.task.kind).has_pairs() && procedure == nullptr;
    return pairs ? fmt::format("{}[{}].pair", series_path(), series) : series_path();
  }
  // The pair of a procedure is the comparison of the largest level, and the reference.
  std::string stiffness_path(std::size_t series, std::size_t of_pair) const {
    if (!task_of(protocol.task.kind).has_pairs()) return series_path();
    if (procedure == nullptr) return fmt::format("{}[{}]", pair_path(series), of_pair);
    if (of_pair != 0) return "$.stimulus.reference";
    return procedure->kind == AdaptiveProcedure::Kind::posterior ? series_path() : series_path() + "[1]";
  }
  // "spheres" where they are spheres
  std::string objects(bool plural) const {
    const bool spheres = rig.kinaesthetic() == nullptr && protocol.rig.object.empty() && !protocol.explore;
    return std::string(spheres ? "sphere" : "object") + (plural ? "s" : "");
  }

  // Force asked of a device per force of the contact. A McKibben finger gives the torque of a contact, k L x, out of
  // its own lever arm l: L / l.
  double force_gain(const DeviceSpec& spec) const {
    return in_metres() && facts_of(spec.model).acts_on_joint ? rig.lever_arm_m / spec.lever_arm_m : 1;
  }
  // In the McKibben finger's own N/rad: a contact of k N/m is k L^2 / l.
  double at_joint(double stiffness, const DeviceSpec& joint) const {
    return in_metres() ? stiffness * rig.lever_arm_m * force_gain(joint) : stiffness;
  }
  // A depth as an angle of the joint.
  double angle_of(double depth) const { return in_metres() ? depth / rig.lever_arm_m : depth; }
};

constexpr double kToldShare = 0.05;  // rarer saturation is not worth a warning
constexpr double kUsablePressShare = 0.25;

double clamped_g(double stiffness, const DeviceSpec& spec) {
  return std::clamp(burst_amplitude_g(stiffness), spec.min_vibration_g, spec.max_vibration_g);
}

void look_at_platform_limit(DeviceLinting& linting, double stiffness, const std::string& path) {
  const DeviceSpec* const platform = linting.rig.cutaneous();
  if (platform == nullptr || stiffness <= platform->max_stiffness) return;
  linting.error(path,
                fmt::format("{} N/m is more than the {} renders stably, {} N/m", plain(stiffness), platform->name,
                            plain(platform->max_stiffness)),
                "take a softer " + linting.objects(false));
}

void look_at_limits(DeviceLinting& linting, std::size_t series) {
  for (std::size_t j = 0; j < 2; ++j) {
    const double stiffness = linting.protocol.series[series].pair[j];
    const std::string path = linting.stiffness_path(series, j);
    const std::string softer = "take a softer " + linting.objects(false);
    look_at_platform_limit(linting, stiffness, path);
    const DeviceSpec* const joint = linting.rig.kinaesthetic();
    if (joint == nullptr || !linting.any(&Cues::kinaesthetic)) continue;
    const double at_joint = linting.at_joint(stiffness, *joint);
    if (at_joint <= joint->max_stiffness) continue;
    const std::string asked =
        linting.in_metres()
            ? fmt::format("{} N/m, {} m from the joint, asks {:.4g} N/rad at the device's own lever arm of {} m, which",
                          plain(stiffness), plain(linting.rig.lever_arm_m), at_joint, plain(joint->lever_arm_m))
            : fmt::format("{} N/rad", plain(stiffness));
    linting.error(
        path, fmt::format("{} is more than the {} renders, {} N/rad", asked, joint->name, plain(joint->max_stiffness)),
        softer);
  }
}

// Only the force limit is felt where even the softer object reaches it early in the press.
bool forces_differ(const DeviceLinting& linting, const DeviceSpec& spec, double softer) {
  return depth_at_force_limit(softer, spec, linting.force_gain(spec)) >=
         kUsablePressShare * linting.protocol.stimulus.expected_press;
}

std::string force_reason(const DeviceLinting& linting, const DeviceSpec& spec, double softer) {
  return fmt::format("reach the force limit of {} N of the {} within {} of a {} press", plain(spec.max_force_n),
                     spec.name, linting.depth(depth_at_force_limit(softer, spec, linting.force_gain(spec))),
                     linting.depth(linting.protocol.stimulus.expected_press));
}

// Why a pair is not told apart by any cue of a condition, and what would help; empty where it is.
struct Alike {
  std::string reason, remedy;
};
Alike alike_in(const DeviceLinting& linting, const std::array<double, 2>& pair, const Condition& condition) {
  const double softer = std::min(pair[0], pair[1]);
  const DeviceSpec* const platform = linting.rig.cutaneous();
  const DeviceSpec* const joint = linting.rig.kinaesthetic();
  Alike alike;
  const auto say = [&](const std::string& reason, const std::string& suggestion) {
    alike.reason += alike.reason.empty() ? reason : " and " + reason;
    if (alike.remedy.empty()) alike.remedy = suggestion;
  };
  const std::string take_softer = "take softer " + linting.objects(true);
  if (condition.cues.force && platform != nullptr) {
    if (forces_differ(linting, *platform, softer)) return {};
    say(force_reason(linting, *platform, softer), take_softer);
  }
  if (condition.cues.vibration && platform != nullptr) {
    if (clamped_g(pair[0], *platform) != clamped_g(pair[1], *platform)) return {};
    say(fmt::format("vibrate with {} g ({:.3f} and {:.3f} g asked)", plain(clamped_g(pair[0], *platform)),
                    burst_amplitude_g(pair[0]), burst_amplitude_g(pair[1])),
        fmt::format("the {} gives {} to {} g: take stiffnesses whose k/1500 + 0.4 lies within", platform->name,
                    plain(platform->min_vibration_g), plain(platform->max_vibration_g)));
  }
  if (condition.cues.kinaesthetic && joint != nullptr) {
    if (forces_differ(linting, *joint, softer)) return {};
    say(force_reason(linting, *joint, softer), take_softer);
  }
  return alike;
}

// A pair must be told apart by one cue of a condition at least.
void look_at_pair(DeviceLinting& linting, std::size_t series, const Condition& condition) {
  const Alike alike = alike_in(linting, linting.protocol.series[series].pair, condition);
  if (alike.reason.empty()) return;
  linting.error(linting.pair_path(series),
                fmt::format("in condition {} both {} {}: they would feel the same", condition.name,
                            linting.objects(true), alike.reason),
                alike.remedy);
}

// The smaller levels of an adaptive procedure, down to where the clamp ends: a track that gets there gets no further.
void look_at_levels(DeviceLinting& linting, const AdaptiveProcedure& procedure, const Condition& condition) {
  const double reference = linting.protocol.stimulus.reference;
  const auto alike_at = [&](double level) { return alike_in(linting, {reference - level, reference}, condition); };
  if (!alike_at(procedure.clamp[1]).reason.empty()) return;  // told as an error of the pair
  const auto tell = [&](double level, const std::string& path, bool start) {
    const Alike alike = alike_at(level);
    if (alike.reason.empty()) return;
    linting.warn(path,
                 fmt::format("in condition {} both {} {}: a difference of {} {} cannot be felt{}", condition.name,
                             linting.objects(true), alike.reason, plain(level), linting.unit(),
                             start ? "" : ", and no track can settle there"),
                 alike.remedy);
  };
  const bool chooses = procedure.kind == AdaptiveProcedure::Kind::posterior;  // among levels, without starts
  tell(procedure.clamp[0], chooses ? limits_path(procedure) : limits_path(procedure) + "[0]", false);
  if (chooses) return;
  for (std::size_t i = 0; i < procedure.starts.size(); ++i)
    tell(procedure.starts[i], fmt::format("{}[{}]", procedure_path("starts"), i), true);
}

void warn_about_forces(DeviceLinting& linting, const DeviceSpec& spec) {
  const Protocol& protocol = linting.protocol;
  std::string numbers;
  double worst = 0;
  for (const double stiffness : linting.stiffnesses()) {
    const double share = expected_saturated_intervals(stiffness, protocol, spec, linting.force_gain(spec));
    worst = std::max(worst, share);
    numbers += fmt::format("{}{} {} at {}, in {:.0f} % of intervals and {:.1f} % of contact time",
                           numbers.empty() ? "" : "; ", plain(stiffness), linting.unit(),
                           linting.depth(depth_at_force_limit(stiffness, spec, linting.force_gain(spec))), 100 * share,
                           100 * expected_saturated_share(stiffness, protocol, spec, linting.force_gain(spec)));
  }
  if (worst <= kToldShare) return;
  const bool repeats = protocol.stimulus.on_saturation == OnSaturation::repeat;
  linting.warn(linting.press_path(),
               fmt::format("presses of {} ± {} reach the {}'s limit of {} N: {}",
                           linting.depth(protocol.stimulus.expected_press), linting.depth(expected_press_sd(protocol)),
                           spec.name, plain(spec.max_force_n), numbers),
               repeats
                   ? "\"on_saturation\": \"repeat\" would void these trials, mostly stiff ones, and bias the study: "
                     "write \"flag\""
                   : "recorded for every interval; the delivered stiffness is fitted on unsaturated samples");
}

void warn_about_vibrations(DeviceLinting& linting, const DeviceSpec& spec) {
  std::string numbers;
  for (const double stiffness : linting.stiffnesses()) {
    if (clamped_g(stiffness, spec) == burst_amplitude_g(stiffness)) continue;
    numbers += fmt::format("{}{} N/m asks {:.3f} g and gets {} g", numbers.empty() ? "" : "; ", plain(stiffness),
                           burst_amplitude_g(stiffness), plain(clamped_g(stiffness, spec)));
  }
  if (numbers.empty()) return;
  linting.warn(linting.series_path(),
               fmt::format("vibrations are clamped to {} to {} g: {}", plain(spec.min_vibration_g),
                           plain(spec.max_vibration_g), numbers),
               "flagged in every interval");
}

}  // namespace

namespace {

// A tap is a vibration of the motor at the pulp.
void look_at_taps(DeviceLinting& linting) {
  if (linting.rig.cutaneous() != nullptr) return;
  const Timeline& timeline = linting.protocol.timeline;
  for (const auto& [name, cue] : {std::pair<const char*, const CueSignal&>{"first", timeline.interval_cues[0]},
                                  {"second", timeline.interval_cues[1]},
                                  {"third", timeline.interval_cues[2]},
                                  {"question", timeline.question_cue}})
    if (cue.kind == "tap")
      linting.error(fmt::format("$.trial.cues.{}.kind", name), "no device of this rig can tap: none vibrates",
                    "take \"sound\", or \"none\"");
}

// ---- presses, objects and contacts that leave the devices' ranges or what a 1 kHz loop can render

constexpr double kDeepPress_sd = 2;   // presses this far above the mean are still to be expected
constexpr double kLoopLag_s = 0.002;  // a period of 1 ms, and one of delay

double series_stiffness(double rendered, double finger) {
  return rendered * finger / (rendered + finger);
}

// How far the platform goes into the pulp, m: as deep as its force presses it.
double platform_travel_m(const DeviceLinting& linting, const DeviceSpec& spec, double stiffness, double press_m) {
  const double felt = linting.protocol.rig.mode == RenderingMode::wrench
                          ? stiffness
                          : series_stiffness(stiffness, kPulpStiffness_n_per_m);
  return std::min(felt * press_m, spec.max_force_n) / kPulpStiffness_n_per_m;
}

void lint_platform_travel(DeviceLinting& linting, const DeviceSpec& spec) {
  const Protocol& protocol = linting.protocol;
  const double press = protocol.stimulus.expected_press;
  const double stiffest = *linting.stiffnesses().rbegin();
  const double room = spec.highest_travel - spec.rest_z_m;
  const double usual = platform_travel_m(linting, spec, stiffest, press);
  const double deep = platform_travel_m(linting, spec, stiffest, press + kDeepPress_sd * expected_press_sd(protocol));
  const auto message = [&](double travel) {
    return fmt::format(
        "with {} N/m the platform of the {} goes {:.2f} mm into a finger pulp of {} N/m (assumed), but it can go "
        "{:.2f} "
        "mm only, and gives no force beyond",
        plain(stiffest), spec.name, 1e3 * travel, plain(kPulpStiffness_n_per_m), 1e3 * room);
  };
  if (usual > room) {
    linting.error(linting.press_path(), message(usual), "expect shallower presses, or take softer objects");
  } else if (deep > room) {
    linting.warn(linting.press_path(), message(deep), "so do the deepest presses; recorded for every interval");
  } else if (press > spec.stroke_m) {
    linting.warn(linting.press_path(),
                 fmt::format("presses of {} are deeper than the {}'s stroke of {}", linting.depth(press), spec.name,
                             linting.depth(spec.stroke_m)),
                 "only the force, up to its limit, stands for such a depth; 5 mm are typical");
  }
}

void lint_joint_travel(DeviceLinting& linting, const DeviceSpec& spec) {
  const Protocol& protocol = linting.protocol;
  const double range = spec.highest_travel - spec.lowest_travel;
  const double contact = protocol.rig.contact_flexion_rad;
  if (contact >= range) {
    linting.error("$.rig.contact_flexion_rad",
                  fmt::format("an object {} rad from straight is never met: the {} flexes by {:.3f} rad",
                              plain(contact), spec.name, range),
                  "bring it nearer");
    return;
  }
  const double press = protocol.stimulus.expected_press;
  const double reach = contact + linting.angle_of(press);
  const double sd = linting.angle_of(expected_press_sd(protocol));
  const std::string pressed = linting.in_metres()
                                  ? fmt::format("{} ({:.3f} rad at a lever arm of {} m)", linting.depth(press),
                                                linting.angle_of(press), plain(linting.rig.lever_arm_m))
                                  : linting.depth(press);
  if (reach > range) {
    linting.error(linting.press_path(),
                  fmt::format("presses of {} from a contact at {} rad end at {:.3f} rad: the {} flexes by {:.3f} rad",
                              pressed, plain(contact), reach, spec.name, range),
                  "expect shallower presses, or bring the object nearer");
  } else if (reach + kDeepPress_sd * sd > range) {
    linting.warn(
        linting.press_path(),
        fmt::format("{:.1f} % of presses of {} from a contact at {} rad meet the end of the {}'s range, {:.3f} "
                    "rad",
                    100 * normal_cdf((reach - range) / sd), pressed, plain(contact), spec.name, range),
        "there the finger feels a stop instead of the object: expect shallower presses, or bring it nearer");
  }
}

void lint_travel(DeviceLinting& linting) {
  if (linting.stiffnesses().empty()) return;
  const DeviceSpec* const platform = linting.rig.cutaneous();
  if (platform != nullptr && linting.any(&Cues::force)) lint_platform_travel(linting, *platform);
  if (const DeviceSpec* const joint = linting.rig.kinaesthetic()) lint_joint_travel(linting, *joint);
}

void lint_mode(DeviceLinting& linting) {
  const RenderingMode mode = linting.protocol.rig.mode;
  if (mode == RenderingMode::wrench || linting.rig.cutaneous() == nullptr || !linting.any(&Cues::force)) return;
  const auto felt = [](double stiffness) { return series_stiffness(stiffness, kPulpStiffness_n_per_m); };
  std::string numbers;
  double widest = 0, narrowest = 0, widest_felt = 0, narrowest_felt = 0;
  for (const Series& series : linting.protocol.series) {
    const double asked = std::abs(series.pair[0] - series.pair[1]);
    const double left = std::abs(felt(series.pair[0]) - felt(series.pair[1]));
    if (numbers.empty() || asked > widest) widest = asked, widest_felt = left;
    if (numbers.empty() || asked < narrowest) narrowest = asked, narrowest_felt = left;
    numbers += fmt::format("{}{} and {} N/m become {:.0f} and {:.0f}", numbers.empty() ? "" : "; ",
                           plain(series.pair[0]), plain(series.pair[1]), felt(series.pair[0]), felt(series.pair[1]));
  }
  const std::string shrink = widest == narrowest
                                 ? fmt::format("a difference of {} N/m shrinks to {:.0f}", plain(widest), widest_felt)
                                 : fmt::format("differences of {} to {} N/m shrink to {:.0f} to {:.0f}",
                                               plain(narrowest), plain(widest), narrowest_felt, widest_felt);
  linting.warn("$.rig.mode",
               fmt::format("position control (\"{}\") renders kS kf / (kS + kf) on a finger pulp of kf = {} N/m "
                           "(assumed): {}; {}",
                           to_string(mode), plain(kPulpStiffness_n_per_m), numbers, shrink),
               "\"wrench\" renders kS itself");
}

void lint_sampled_contact(DeviceLinting& linting) {
  const Protocol& protocol = linting.protocol;
  if (linting.stiffnesses().empty() || (!linting.any(&Cues::force) && !linting.any(&Cues::kinaesthetic))) return;
  const double viscosity = protocol.stimulus.damping_n_s_per_m;
  // Of a joint in N s/rad: the fingertip moves lever_arm_m a radian.
  const DeviceSpec* const joint = linting.rig.kinaesthetic();
  const bool at_joint = !linting.in_metres() && joint != nullptr;
  const double own = kFingerDamping_n_s_per_m * (at_joint ? joint->lever_arm_m : 1);
  const std::string_view unit = at_joint ? "N s/rad" : "N s/m";
  const double stiffest = *linting.stiffnesses().rbegin();
  const double needed = needed_damping(stiffest, viscosity);
  if (needed <= own) return;
  const std::string message = fmt::format(
      "{} {} with a viscosity of {} {} needs {:.4g} {} of the finger's own damping to be passive at 1 kHz (K T / 2 + "
      "B, "
      "T = {} ms); a finger is assumed to have {:.4g}",
      plain(stiffest), linting.unit(), plain(viscosity), unit, needed, unit, plain(1e3 * kLoopLag_s), own);
  const double most = own - needed_damping(stiffest, 0);
  const std::string remedy = most > 0 ? fmt::format("at most {:.3g} {} with this stiffness", most, unit)
                                      : "take a softer " + linting.objects(false);
  if (viscosity > 0)
    linting.error(fmt::format("$.stimulus.viscosity_n_s_per_{}", length_suffix(protocol.stimulus.unit)), message,
                  remedy);
  else
    linting.warn(linting.series_path(), message, remedy + "; the device's specification allows it");
}

}  // namespace

double needed_damping(double stiffness, double viscosity) noexcept {
  return stiffness * kLoopLag_s / 2 + viscosity;
}

DeviceLint lint_against_device(const Protocol& protocol, const RigSpec& rig, const std::string& file) {
  DeviceLinting linting{protocol, rig, file, protocol.bytes.empty() ? JsonNode{} : parse_json(protocol.bytes, file),
                        protocol.design.procedure ? &*protocol.design.procedure : nullptr};
  for (std::size_t i = 0; i < protocol.series.size(); ++i) {
    look_at_limits(linting, i);
    for (const Condition& condition : protocol.conditions) look_at_pair(linting, i, condition);
  }
  if (protocol.explore) look_at_platform_limit(linting, protocol.stimulus.reference, linting.series_path());
  if (linting.procedure != nullptr)
    for (const Condition& condition : protocol.conditions) look_at_levels(linting, *linting.procedure, condition);
  look_at_taps(linting);
  lint_travel(linting);
  lint_mode(linting);
  lint_sampled_contact(linting);
  if (rig.cutaneous() != nullptr) {
    if (linting.any(&Cues::force)) warn_about_forces(linting, *rig.cutaneous());
    if (linting.any(&Cues::vibration)) warn_about_vibrations(linting, *rig.cutaneous());
  }
  if (rig.kinaesthetic() != nullptr && linting.any(&Cues::kinaesthetic))
    warn_about_forces(linting, *rig.kinaesthetic());
  return std::move(linting.lint);
}

}  // namespace jnd
