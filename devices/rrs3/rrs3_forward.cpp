#include "devices/rrs3/rrs3_forward.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace jnd {

namespace {

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
