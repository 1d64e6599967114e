// Presses, objects and contacts that leave the devices' ranges or what a 1 kHz loop can render.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/normal.h"
#include "protocols/rigs/device_linting.h"

namespace jnd {
namespace {

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

}  // namespace

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

double needed_damping(double stiffness, double viscosity) noexcept {
  return stiffness * kLoopLag_s / 2 + viscosity;
}

}  // namespace jnd
