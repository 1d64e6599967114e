#include "devices/rrs3/rrs3_kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "protocols/input/input_error.h"

namespace jnd {

namespace {

// Relative size below which a determinant or a lever counts as zero: far above rounding (1e-16), far below any pose
// that a device could hold.
constexpr double kSingular = 1e-9;

// Newton doubles the digits of each step: from anywhere in the limits it takes 4 to 8.
constexpr int kMostSteps = 50;
// A step that overshoots is halved at most this often; beyond, nothing is left of it.
constexpr int kMostHalvings = 30;
// Farthest that one step goes: the kinematics bend little over it, so that no other assembly is jumped to.
constexpr double kLongestTilt_rad = 0.2;
constexpr double kLongestLift = 0.3;  // of the platform's radius b
// A residual of the joints that may be all rounding, where a leg is so near stretched that 1e-12 rad is not resolved.
constexpr double kRounding_rad = 1e-9;
constexpr double kSmallestStep = 1e-14;  // rad, or metres per b

struct Iterate {
  Rrs3Coordinates xi;
  Eigen::Matrix3d j_xi;
  Eigen::Vector3d residual;  // asked - here
  double size = 0;           // its largest element
  double side = 0;           // of the parallel singularities: sign of det J
};

std::optional<Iterate> evaluate(const Rrs3Kinematics& kinematics, const Eigen::Vector3d& asked,
                                const Rrs3Coordinates& xi) noexcept {
  const std::optional<Rrs3Configuration> at = kinematics.configuration(xi);
  if (!at) return std::nullopt;
  const std::optional<Rrs3Differential> rates = kinematics.differential(*at);
  if (!rates) return std::nullopt;
  Iterate result;
  result.xi = xi;
  result.j_xi = rates->j * Rrs3Kinematics::rate_map(*at, xi.pitch_rad);
  const Eigen::Vector3d q = kinematics.joint_angles(*at);
  for (int leg = 0; leg < 3; ++leg) result.residual[leg] = std::remainder(asked[leg] - q[leg], 2 * std::numbers::pi);
  result.size = result.residual.cwiseAbs().maxCoeff();
  result.side = std::copysign(1.0, rates->j.determinant());
  return result;
}

}  // namespace

Rrs3Geometry geometry_of(const DeviceSpec& spec) noexcept {
  return {.a_m = spec.a_m,
          .b_m = spec.b_m,
          .bh_m = spec.bh_m,
          .bd_m = spec.bd_m,
          .l1_m = spec.l1_m,
          .l2_m = spec.l2_m,
          .rest_z_m = spec.rest_z_m};
}

Rrs3Kinematics::Rrs3Kinematics(const Rrs3Geometry& geometry) : geometry_(geometry) {
  for (const double length : {geometry.a_m, geometry.b_m, geometry.bh_m, geometry.bd_m, geometry.l1_m, geometry.l2_m})
    if (!(length > 0) || !std::isfinite(length))
      throw InputError(
          std::string("a length of the platform's geometry is not positive: give a, b, bh, bd, l1 and l2 in metres"));
  if (!std::isfinite(geometry.rest_z_m)) throw InputError(std::string("the platform's rest height is not a number"));
  const double half = geometry.bd_m / 2;
  const double radius = std::hypot(half, geometry.bh_m);
  legs_[0] = {1, 0};
  legs_[1] = {-geometry.bh_m / radius, -half / radius};
  legs_[2] = {-geometry.bh_m / radius, half / radius};
  joints_in_platform_ << geometry.b_m, -geometry.bh_m, -geometry.bh_m,  //
      0, -half, half,                                                   //
      0, 0, 0;
  for (int leg = 0; leg < 3; ++leg) {
    axes_x_[leg] = joint_axis(leg).x();
    axes_y_[leg] = joint_axis(leg).y();
  }
  axes_cross_ = axes_x_.cross(axes_y_);
}

bool Rrs3Kinematics::solve_pose(const Rrs3Coordinates& xi, Rrs3Pose& at) const noexcept {
  const double sr = std::sin(xi.roll_rad), cr = std::cos(xi.roll_rad);
  const double sp = std::sin(xi.pitch_rad), cp = std::cos(xi.pitch_rad);
  // (1), general: tan(yaw) = (bd^2/4) sin(pitch) sin(roll) / (bh (b + bh) cos(pitch) + (bd^2/4) cos(roll)).
  const double square = geometry_.bd_m * geometry_.bd_m / 4;
  const double rise = square * sp * sr;
  const double run = geometry_.bh_m * (geometry_.b_m + geometry_.bh_m) * cp + square * cr;
  if (!(run > 0) || !(cr > 0) || !(cp > 0)) return false;  // also where an angle is not a number
  const double length = std::sqrt(rise * rise + run * run);
  const double sy = rise / length, cy = run / length;

  at.sin_yaw = sy;
  at.cos_yaw = cy;
  at.rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,             //
      -sp, cp * sr, cp * cr;
  // (2), (3), exact.
  at.position << geometry_.bh_m * (at.rotation(0, 0) - at.rotation(1, 1)), -geometry_.b_m * at.rotation(1, 0), xi.pz_m;
  return true;
}

std::optional<Rrs3Pose> Rrs3Kinematics::pose(const Rrs3Coordinates& xi) const noexcept {
  std::optional<Rrs3Pose> result(std::in_place);
  if (!solve_pose(xi, *result)) result.reset();
  return result;
}

// In place, with one way out: the results are too large to be copied a thousand times a second.
std::optional<Rrs3Configuration> Rrs3Kinematics::configuration(const Rrs3Coordinates& xi) const noexcept {
  std::optional<Rrs3Configuration> result(std::in_place);
  if (!solve_pose(xi, *result) || !solve_legs(*result)) result.reset();
  return result;
}

bool Rrs3Kinematics::solve_legs(Rrs3Configuration& at) const noexcept {
  for (int leg = 0; leg < 3; ++leg) {
    const Leg& azimuth = legs_[static_cast<std::size_t>(leg)];
    // (4); B_i lies in the platform's plane.
    const Eigen::Vector3d arm =
        at.rotation.col(0) * joints_in_platform_(0, leg) + at.rotation.col(1) * joints_in_platform_(1, leg);
    const Eigen::Vector3d joint = at.position + arm;
    at.platform_joints.col(leg) = joint;
    const double radial = joint.x() * azimuth.cos_azimuth + joint.y() * azimuth.sin_azimuth - geometry_.a_m;
    const double z = joint.z();
    // The triangle base joint, elbow, platform joint: the elbow at `along` the line s and `across` it, outward.
    const double squared = radial * radial + z * z;
    const double along =
        (geometry_.l1_m * geometry_.l1_m + squared - geometry_.l2_m * geometry_.l2_m) / 2;    // times |s|
    const double across_squared = geometry_.l1_m * geometry_.l1_m * squared - along * along;  // times |s|^2
    if (!(across_squared >= 0) || !(squared > 0)) return false;
    const double across = std::sqrt(across_squared);
    const double link_radial = (along * radial - across * z) / squared;
    const double link_z = (along * z + across * radial) / squared;
    at.knee.col(leg) << radial, z;
    at.link.col(leg) << link_radial, link_z;
    at.elbows.col(leg) << (geometry_.a_m + link_radial) * azimuth.cos_azimuth,
        (geometry_.a_m + link_radial) * azimuth.sin_azimuth, link_z;
  }
  return true;
}

Eigen::Vector3d Rrs3Kinematics::joint_angles(const Rrs3Configuration& at) const noexcept {
  Eigen::Vector3d q;
  for (int leg = 0; leg < 3; ++leg) {
    const double radial = at.knee(0, leg), z = at.knee(1, leg);
    const double alpha = std::atan2(z, radial);  // (7), with its sign
    // delta as the angle from s to the elbow: the same as (7)'s acos, and accurate where that is near 1. Elbows lie
    // outward, so it is 0 to pi: rounding must not turn a folded leg's pi into -pi.
    const double outward = std::max(0.0, radial * at.link(1, leg) - z * at.link(0, leg));
    const double delta = std::atan2(outward, radial * at.link(0, leg) + z * at.link(1, leg));
    q[leg] = alpha + delta;
  }
  return q;
}

Eigen::Vector3d Rrs3Kinematics::joint_axis(int leg) const noexcept {
  const Leg& azimuth = legs_[static_cast<std::size_t>(leg)];
  return {azimuth.sin_azimuth, -azimuth.cos_azimuth, 0};
}

std::optional<Rrs3Differential> Rrs3Kinematics::differential(const Rrs3Configuration& at) const noexcept {
  std::optional<Rrs3Differential> result(std::in_place);
  if (!solve_rates(at, *result)) result.reset();
  return result;
}

bool Rrs3Kinematics::solve_rates(const Rrs3Configuration& at, Rrs3Differential& out) const noexcept {
  // (9): u . v + w . (r x u) = 0 with r = b - p, for each leg; split as in (14) into chi and [vx, vy, wz].
  // Columns, an element a leg: ux, uy and turn of vx, vy and wz; about_x, about_y of wx, wy; that of vz is zero,
  // because the axes are horizontal. r0, r1, r2 are the rows of the adjoint of the dependent block.
  const Eigen::Vector3d& ux = axes_x_;
  const Eigen::Vector3d& uy = axes_y_;
  Eigen::Vector3d turn, about_x, about_y;
  for (int leg = 0; leg < 3; ++leg) {
    const double x = at.platform_joints(0, leg) - at.position.x(), y = at.platform_joints(1, leg) - at.position.y();
    const double z = at.platform_joints(2, leg) - at.position.z();
    turn[leg] = x * uy[leg] - y * ux[leg];
    about_x[leg] = -z * uy[leg];
    about_y[leg] = z * ux[leg];
  }
  const Eigen::Vector3d r0 = uy.cross(turn), r1 = turn.cross(ux);
  const Eigen::Vector3d& r2 = axes_cross_;
  const double determinant = ux.dot(r0);
  if (!(std::abs(determinant) > kSingular * geometry_.b_m)) return false;

  out.det_u = determinant;
  const double scale = -1 / determinant;
  const double vx_wx = scale * r0.dot(about_x), vx_wy = scale * r0.dot(about_y);
  const double vy_wx = scale * r1.dot(about_x), vy_wy = scale * r1.dot(about_y);
  const double wz_wx = scale * r2.dot(about_x), wz_wy = scale * r2.dot(about_y);
  // (17)
  out.h << 0, vx_wx, vx_wy,  //
      0, vy_wx, vy_wy,       //
      1, 0, 0,               //
      0, 1, 0,               //
      0, 0, 1,               //
      0, wz_wx, wz_wy;

  for (int leg = 0; leg < 3; ++leg) {
    const Leg& azimuth = legs_[static_cast<std::size_t>(leg)];
    const double along = at.knee(0, leg) - at.link(0, leg), z = at.knee(1, leg) - at.link(1, leg);
    const Eigen::Vector3d distal(along * azimuth.cos_azimuth, along * azimuth.sin_azimuth, z);  // b - d
    const Eigen::Vector3d turning = (at.platform_joints.col(leg) - at.position).cross(distal);
    // (20), signs corrected: E = [(b-d)^T, ((b-p) x (b-d))^T]; F = (b-d) . (u x (d-a)), here in the leg's plane.
    const double lever = at.knee(1, leg) * at.link(0, leg) - at.knee(0, leg) * at.link(1, leg);
    if (!(std::abs(lever) > kSingular * geometry_.l1_m * geometry_.l2_m)) return false;
    const double inverse = 1 / lever;
    out.j(leg, 0) = z * inverse;
    out.j(leg, 1) = (distal.x() * vx_wx + distal.y() * vy_wx + turning.x() + turning.z() * wz_wx) * inverse;
    out.j(leg, 2) = (distal.x() * vx_wy + distal.y() * vy_wy + turning.y() + turning.z() * wz_wy) * inverse;
  }
  const Eigen::Vector3d column = out.j.col(0);
  return std::abs(column.dot(out.j.col(1).cross(out.j.col(2)))) * geometry_.b_m > kSingular;
}

Eigen::Matrix3d Rrs3Kinematics::rate_map(const Rrs3Configuration& at, double pitch_rad) noexcept {
  const double cp = std::cos(pitch_rad);
  Eigen::Matrix3d map;
  map << 1, 0, 0,                       //
      0, at.cos_yaw * cp, -at.sin_yaw,  //
      0, at.sin_yaw * cp, at.cos_yaw;
  return map;
}

double Rrs3Kinematics::condition_number(const Eigen::Matrix3d& j) const noexcept {
  Eigen::Matrix3d scaled = j;
  scaled.col(0) *= geometry_.b_m;
  const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(scaled).singularValues();
  return singular[0] / singular[2];
}

double yaw_of(const Rrs3Pose& at) noexcept {
  return std::atan2(at.sin_yaw, at.cos_yaw);
}

std::optional<Rrs3Coordinates> forward_kinematics(const Rrs3Kinematics& kinematics, const Eigen::Vector3d& joint_angles,
                                                  const Rrs3Coordinates& from) noexcept {
  if (!std::isfinite(joint_angles.sum())) return std::nullopt;
  const double radius = kinematics.geometry().b_m;
  std::optional<Iterate> now = evaluate(kinematics, joint_angles, from);
  for (int step = 0; now && step < kMostSteps; ++step) {
    Eigen::Vector3d move = now->j_xi.inverse() * now->residual;
    const double tilt = std::max(std::abs(move[1]), std::abs(move[2]));
    const double lift = std::abs(move[0]) / radius;
    if (!std::isfinite(tilt + lift)) return std::nullopt;
    const bool still = std::max(tilt, lift) < kSmallestStep;
    if (now->size <= kForwardTolerance_rad || (still && now->size <= kRounding_rad)) return now->xi;
    move /= std::max({1.0, tilt / kLongestTilt_rad, lift / kLongestLift});

    std::optional<Iterate> next;
    for (int halving = 0; halving < kMostHalvings; ++halving, move /= 2) {
      next = evaluate(kinematics, joint_angles,
                      {.pz_m = now->xi.pz_m + move[0],
                       .roll_rad = now->xi.roll_rad + move[1],
                       .pitch_rad = now->xi.pitch_rad + move[2]});
      if (next && next->side == now->side && next->residual.squaredNorm() < now->residual.squaredNorm()) break;
      next.reset();
    }
    if (!next && now->size <= kRounding_rad) return now->xi;  // no step improves on rounding
    now = next;
  }
  return std::nullopt;
}

}  // namespace jnd
