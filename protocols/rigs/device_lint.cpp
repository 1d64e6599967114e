#include "protocols/rigs/device_lint.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "protocols/rigs/device_linting.h"

namespace jnd {
namespace {

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
void look_at_levels(DeviceLinting& linting, const Condition& condition) {
  const AdaptiveProcedure& procedure = *linting.protocol.design.procedure;
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
  tell(procedure.clamp[0], "$.design.procedure.clamp[0]", false);
  for (std::size_t i = 0; i < procedure.starts.size(); ++i)
    tell(procedure.starts[i], fmt::format("$.design.procedure.starts[{}]", i), true);
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
               fmt::format("presses of {} +- {} reach the {}'s limit of {} N: {}",
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

void DeviceLinting::error(const std::string& path, std::string message, std::string suggestion) {
  lint.errors.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
}

void DeviceLinting::warn(const std::string& path, std::string message, std::string suggestion) {
  lint.warnings.push_back(diagnostic_at_path(root, file, path, std::move(message), std::move(suggestion)));
}

bool DeviceLinting::any(bool Cues::*cue) const {
  return std::any_of(protocol.conditions.begin(), protocol.conditions.end(),
                     [cue](const Condition& condition) { return condition.cues.*cue; });
}

std::set<double> DeviceLinting::stiffnesses() const {
  std::set<double> all;
  for (const Series& series : protocol.series) all.insert(series.pair.begin(), series.pair.end());
  if (protocol.design.procedure)
    for (const double start : protocol.design.procedure->starts) all.insert(protocol.stimulus.reference - start);
  if (protocol.explore) all.insert(protocol.stimulus.reference);
  return all;
}

std::string DeviceLinting::depth(double value) const {
  return in_metres() ? fmt::format("{:.2f} mm", 1e3 * value) : fmt::format("{:.3f} rad", value);
}

std::string DeviceLinting::press_path() const {
  return fmt::format("$.stimulus.expected_press_{}", length_suffix(protocol.stimulus.unit));
}

std::string DeviceLinting::series_path() const {
  if (protocol.explore) return "$.stimulus.reference";
  return protocol.design.procedure ? "$.design.procedure.clamp" : "$.series";
}

std::string DeviceLinting::pair_path(std::size_t series) const {
  return protocol.design.procedure ? series_path() : fmt::format("$.series[{}].pair", series);
}

// The pair of a procedure is the comparison of the largest level, and the reference.
std::string DeviceLinting::stiffness_path(std::size_t series, std::size_t of_pair) const {
  if (!protocol.design.procedure) return fmt::format("{}[{}]", pair_path(series), of_pair);
  return of_pair == 0 ? series_path() + "[1]" : "$.stimulus.reference";
}

std::string DeviceLinting::objects(bool plural) const {
  const bool spheres = rig.kinaesthetic() == nullptr && protocol.rig.object.empty() && !protocol.explore;
  return std::string(spheres ? "sphere" : "object") + (plural ? "s" : "");
}

double burst_amplitude_g(double stiffness_n_per_m) noexcept {
  return stiffness_n_per_m / 1500 + 0.4;
}

namespace {

// A tap is a vibration of the motor at the pulp.
void look_at_taps(DeviceLinting& linting) {
  if (linting.rig.cutaneous() != nullptr) return;
  const Timeline& timeline = linting.protocol.timeline;
  for (const auto& [name, cue] : {std::pair<const char*, const CueSignal&>{"first", timeline.first_cue},
                                  {"second", timeline.second_cue},
                                  {"question", timeline.question_cue}})
    if (cue.kind == "tap")
      linting.error(fmt::format("$.trial.cues.{}.kind", name), "no device of this rig can tap: none vibrates",
                    "take \"sound\", or \"none\"");
}

}  // namespace

DeviceLint lint_against_device(const Protocol& protocol, const RigSpec& rig, const std::string& file) {
  DeviceLinting linting{protocol, rig, file, protocol.bytes.empty() ? JsonNode{} : parse_json(protocol.bytes, file)};
  for (std::size_t i = 0; i < protocol.series.size(); ++i) {
    look_at_limits(linting, i);
    for (const Condition& condition : protocol.conditions) look_at_pair(linting, i, condition);
  }
  if (protocol.explore) look_at_platform_limit(linting, protocol.stimulus.reference, linting.series_path());
  if (protocol.design.procedure)
    for (const Condition& condition : protocol.conditions) look_at_levels(linting, condition);
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
