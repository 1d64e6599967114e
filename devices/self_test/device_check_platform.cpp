// What a 3RRS platform can do, measured: reach, tilt, rendered stiffness, vibration.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_rendering.h"
#include "devices/rrs3/rrs3_workspace.h"
#include "devices/self_test/device_bench.h"

namespace jnd {

namespace {

constexpr int kPlatformSettled_ticks = 400;

// Each coordinate alone through its published range, the others at rest.
Check ranges(const DeviceSpec& spec) {
  constexpr int kPoints = 101;
  constexpr double kMostCondition = 2.5;
  const Rrs3Kinematics kinematics(geometry_of(spec));
  const Rrs3Box box = box_of(spec);
  int reached = 0;
  double worst = 0;
  const auto visit = [&](const Rrs3Coordinates& at) {
    const std::optional<double> condition = condition_at(kinematics, at);
    if (condition) worst = std::max(worst, *condition);
    reached += condition ? 1 : 0;
  };
  for (int i = 0; i < kPoints; ++i) {
    const double share = static_cast<double>(i) / (kPoints - 1), both_ways = 2 * share - 1;
    visit({.pz_m = box.lowest_m + share * (box.highest_m - box.lowest_m)});
    visit({.pz_m = spec.rest_z_m, .roll_rad = both_ways * box.max_roll_rad});
    visit({.pz_m = spec.rest_z_m, .pitch_rad = both_ways * box.max_pitch_rad});
  }
  return measured("stroke, roll and pitch, one at a time",
                  fmt::format("{} of {} poses, condition {:.2f}", reached, 3 * kPoints, worst),
                  fmt::format("all, condition at most {:g}", kMostCondition),
                  reached == 3 * kPoints && worst <= kMostCondition);
}

// From the joints' encoders back to the pose.
Check forward(const DeviceSpec& spec) {
  const Rrs3Kinematics kinematics(geometry_of(spec));
  const Rrs3Coordinates rest{.pz_m = spec.rest_z_m};
  double worst_m = 0;
  int solved = 0, poses = 0;
  for (const double up : {-0.5, 0.0, 0.5})
    for (const double roll : {-0.5, 0.0, 0.5})
      for (const double pitch : {-0.5, 0.0, 0.5}) {
        const Rrs3Coordinates at{.pz_m = spec.rest_z_m + up * spec.stroke_m / 2,
                                 .roll_rad = roll * spec.max_roll_rad,
                                 .pitch_rad = pitch * spec.max_pitch_rad};
        ++poses;
        const auto configuration = kinematics.configuration(at);
        if (!configuration) continue;
        const auto found = forward_kinematics(kinematics, kinematics.joint_angles(*configuration), rest);
        if (!found) continue;
        ++solved;
        worst_m =
            std::max({worst_m, std::abs(found->pz_m - at.pz_m), spec.b_m * std::abs(found->roll_rad - at.roll_rad),
                      spec.b_m * std::abs(found->pitch_rad - at.pitch_rad)});
      }
  return measured("pose from the joints' angles", fmt::format("{} of {} poses, {:.1g} m off", solved, poses, worst_m),
                  "all, at most 1e-09 m off", solved == poses && worst_m <= 1e-9);
}

Check tilt(const DeviceSpec& spec) {
  DeviceBench bench(spec);
  bench.make_ready();
  DeviceCommand command = bench.push(0);
  command.roll_rad = 10;
  command.pitch_rad = -10;
  bench.ticks(kPlatformSettled_ticks, command);
  const PlatformPose& at = bench.reading().platform;
  const bool inside =
      std::abs(at.roll_rad) <= spec.max_roll_rad + 1e-12 && std::abs(at.pitch_rad) <= spec.max_pitch_rad + 1e-12;
  return measured("10 rad of roll and pitch asked",
                  fmt::format("roll {:.4f}, pitch {:.4f} rad", at.roll_rad, at.pitch_rad),
                  fmt::format("within {:.4f} and {:.4f} rad", spec.max_roll_rad, spec.max_pitch_rad), inside);
}

Check joint_speed(const DeviceSpec& spec) {
  const Rrs3Kinematics kinematics(geometry_of(spec));
  DeviceBench bench(spec);
  bench.make_ready();
  DeviceCommand command = bench.push(0);
  command.roll_rad = spec.max_roll_rad / 2;
  const auto joints = [&]() -> std::optional<Eigen::Vector3d> {
    const PlatformPose& at = bench.reading().platform;
    const auto configuration =
        kinematics.configuration({.pz_m = at.pz_m, .roll_rad = at.roll_rad, .pitch_rad = at.pitch_rad});
    if (!configuration) return std::nullopt;
    return kinematics.joint_angles(*configuration);
  };
  std::optional<Eigen::Vector3d> before = joints();
  double fastest = 0;
  bool known = before.has_value();
  for (int i = 0; i < kPlatformSettled_ticks && known; ++i) {
    (void)bench.tick(command);
    const std::optional<Eigen::Vector3d> now = joints();
    known = now.has_value();
    if (known) fastest = std::max(fastest, (*now - *before).cwiseAbs().maxCoeff() * 1000);
    before = now;
  }
  const double limit = spec.max_joint_speed_rad_per_s;
  // The speed is limited along the tangent; over a millisecond the joints' path bends a little.
  return measured("speed of the joints while it tilts", fmt::format("{:.2f} rad/s", fastest),
                  fmt::format("at most {:.2f} rad/s + 1 %", limit), known && fastest > 0 && fastest <= 1.01 * limit);
}

Check platform_rendering(const DeviceSpec& spec, double stiffness) {
  constexpr double kTolerance = 0.005;
  const Rrs3StiffnessAnswer answer = measure_rendered_stiffness(spec, {.stiffness_n_per_m = stiffness});
  return measured(fmt::format("renders {:g} N/m on a finger of 1000 N/m", stiffness),
                  fmt::format("{:.2f} N/m", answer.rendered_n_per_m), fmt::format("within {:g} %", 100 * kTolerance),
                  std::abs(answer.rendered_n_per_m - stiffness) <= kTolerance * stiffness);
}

Check rest(const DeviceSpec& spec) {
  DeviceBench bench(spec);
  bench.make_ready();
  bench.ticks(kPlatformSettled_ticks, bench.push(spec.max_force_n / 2));
  bench.device().neutral();
  bench.silence();
  const DeviceReading& reading = bench.reading();
  const double off_mm = 1e3 * std::abs(reading.platform.pz_m - spec.rest_z_m);
  return measured("neutral: force and height one tick later",
                  fmt::format("{:g} N, {:g} mm off", reading.force_n, off_mm), "0 N, at rest",
                  reading.force_n == 0 && off_mm < 1e-6);
}

Check vibration(const DeviceSpec& spec, double asked_g) {
  DeviceBench bench(spec);
  bench.make_ready();
  DeviceCommand command = bench.push(0);
  command.vibration_g = asked_g;
  command.vibration_hz = 200;
  double most_g = 0;
  for (int i = 0; i < 100; ++i) {
    (void)bench.tick(command);
    most_g = std::max(most_g, bench.reading().vibration_g);
  }
  const double expected = std::clamp(asked_g, spec.min_vibration_g, spec.max_vibration_g);
  return measured(fmt::format("vibration: {:g} g asked", asked_g), fmt::format("{:.4f} g", most_g),
                  fmt::format("{:g} g (range {:g} to {:g} g)", expected, spec.min_vibration_g, spec.max_vibration_g),
                  std::abs(most_g - expected) <= 0.01 * expected);
}

Check burst(const DeviceSpec& spec) {
  DeviceBench bench(spec);
  bench.make_ready();
  DeviceCommand command = bench.push(0);
  command.vibration_g = spec.max_vibration_g / 2;
  command.vibration_hz = 1000;
  int vibrating = 0;
  double hz = 0;
  for (int i = 0; i < 1000; ++i) {
    const GovernorOutput& out = bench.tick(command);
    vibrating += out.given.vibration_g > 0 ? 1 : 0;
    hz = std::max(hz, out.given.vibration_hz);
  }
  const auto most_ms = static_cast<int>(kMaxBurst_ns / DeviceBench::kTick_ns);
  return measured("vibration: 1 s at 1000 Hz asked", fmt::format("{} ms at {:g} Hz", vibrating, hz),
                  fmt::format("at most {} ms, {:g} Hz", most_ms, spec.max_vibration_hz),
                  vibrating > 0 && vibrating <= most_ms && hz <= spec.max_vibration_hz);
}

}  // namespace

void check_platform(const DeviceSpec& spec, Checks& checks) {
  Checks own = {ranges(spec), forward(spec), tilt(spec), joint_speed(spec), rest(spec)};
  for (const double stiffness : {500.0, 600.0, 700.0, 900.0})  // the paper's
    if (stiffness <= spec.max_stiffness) own.push_back(platform_rendering(spec, stiffness));
  for (const double asked_g : {0.01, 0.5, 3.0}) own.push_back(vibration(spec, asked_g));
  own.push_back(burst(spec));
  for (Check& check : own) {
    check.device = spec.name;
    checks.push_back(std::move(check));
  }
}

}  // namespace jnd
