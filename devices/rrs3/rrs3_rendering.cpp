#include "devices/rrs3/rrs3_rendering.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/loop/governor.h"
#include "devices/loop/rendering.h"
#include "devices/rrs3/rrs3_device.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr double kPressSpeed_m_per_s = 0.01;  // below the governor's limit of rise by a factor of ten
constexpr int kSettle_ticks = 150;            // thirty time constants of the softest pulp
constexpr double kUsedForce = 0.9;            // of the device's largest: nothing saturates

void check(const DeviceSpec& spec, const Rrs3StiffnessQuery& query) {
  if (!(query.stiffness_n_per_m > 0) || query.stiffness_n_per_m > spec.max_stiffness)
    throw InputError(fmt::format("a stiffness of {} N/m cannot be rendered by {}: give more than 0 and at most {} N/m",
                                 query.stiffness_n_per_m, spec.name, spec.max_stiffness));
  if (!(std::abs(query.roll_rad) <= spec.max_roll_rad) || !(std::abs(query.pitch_rad) <= spec.max_pitch_rad))
    throw InputError(fmt::format("roll {} and pitch {} rad are beyond the limits of {}: give at most {} and {} rad",
                                 query.roll_rad, query.pitch_rad, spec.name, spec.max_roll_rad, spec.max_pitch_rad));
  if (query.depths < 1 || !(query.deepest_m > 0) || !std::isfinite(query.deepest_m))
    throw InputError(fmt::format("{} depths down to {} m press nothing: give at least one depth, and more than 0 m",
                                 query.depths, query.deepest_m));
}

// One finger's path from a commanded depth to the sensor.
class Press {
 public:
  Press(const DeviceSpec& spec, const Rrs3StiffnessQuery& query)
      : query_(query), device_(spec, {.pulp_stiffness_n_per_m = query.finger_n_per_m, .mode = query.mode}) {
    const Rrs3Kinematics kinematics(geometry_of(spec));
    const auto pose = kinematics.pose({.roll_rad = query.roll_rad, .pitch_rad = query.pitch_rad});
    normal_ = pose ? Eigen::Vector3d(pose->rotation.col(2)) : Eigen::Vector3d::UnitZ();
    governor_.configure(spec);
    governor_.activate(now_ns_);
    (void)device_.engage(now_ns_);
  }

  // One millisecond at that depth; returns the measured force, N.
  double tick(double depth_m) {
    (void)device_.read(now_ns_, reading_);
    GovernorInput input;
    input.asked.force_n = contact_force_n(query_.stiffness_n_per_m, depth_m);
    input.asked.stiffness_n_per_m = query_.stiffness_n_per_m;
    input.asked.normal = normal_;
    input.asked.roll_rad = query_.roll_rad;
    input.asked.pitch_rad = query_.pitch_rad;
    input.travel = reading_.travel;
    input.pose_time_ns = now_ns_;
    const GovernorOutput out = governor_.govern(input, now_ns_);
    if (out.fault != Fault::none)
      throw DeviceError(
          fmt::format("the governor stopped the press at {:.2f} mm: {}", 1e3 * depth_m, to_string(out.fault)));
    (void)device_.write(out.given, now_ns_);
    now_ns_ += kTick_ns;
    return reading_.force_n;
  }

 private:
  Rrs3StiffnessQuery query_;
  Rrs3Device device_;
  Governor governor_;
  Eigen::Vector3d normal_;
  DeviceReading reading_;
  std::int64_t now_ns_ = 0;
};

}  // namespace

double series_stiffness_n_per_m(double rendered_n_per_m, double finger_n_per_m) noexcept {
  return rendered_n_per_m * finger_n_per_m / (rendered_n_per_m + finger_n_per_m);
}

Rrs3StiffnessAnswer measure_rendered_stiffness(const DeviceSpec& spec, const Rrs3StiffnessQuery& query) {
  check(spec, query);
  Press press(spec, query);
  Rrs3StiffnessAnswer answer{.mode = query.mode, .asked_n_per_m = query.stiffness_n_per_m, .curve = {}};
  answer.expected_n_per_m = query.mode == RenderingMode::wrench
                                ? query.stiffness_n_per_m
                                : series_stiffness_n_per_m(query.stiffness_n_per_m, query.finger_n_per_m);

  // The platform turns and the governor's soft start passes before anything is pressed.
  for (std::int64_t waited_ns = 0; waited_ns <= 2 * kSoftStart_ns; waited_ns += kTick_ns) (void)press.tick(0);
  const double deepest = std::min(query.deepest_m, kUsedForce * spec.max_force_n / query.stiffness_n_per_m);
  constexpr double kStep_m = kPressSpeed_m_per_s * 1e-9 * static_cast<double>(kTick_ns);
  double depth = 0, product = 0, square = 0;
  for (int i = 1; i <= query.depths; ++i) {
    const double held = deepest * i / query.depths;
    while (depth < held) {
      (void)press.tick(depth);
      depth += kStep_m;
    }
    depth = held;
    double force = 0;
    for (int settling = 0; settling < kSettle_ticks; ++settling) force = press.tick(depth);
    answer.curve.push_back({.depth_m = depth, .force_n = force});
    product += force * depth;
    square += depth * depth;
  }
  answer.rendered_n_per_m = product / square;
  return answer;
}

}  // namespace jnd
