// Distances to the singularities of the 3RRS platform (declared in rrs3_workspace.h).
#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "devices/rrs3/rrs3_workspace.h"

namespace jnd {

namespace {

constexpr double kHeightStep_m = 1e-4;
constexpr double kTiltStep_rad = 0.25 * std::numbers::pi / 180;
constexpr double kResolution = 1e-9;  // m or rad

// What changes sign, or ends, at a singularity.
struct Signs {
  bool reached = false;
  double constraint = 0;  // det U
  double parallel = 0;    // det of E H, whose sign det J has too: levers never change theirs
  double serial_size = 0, parallel_size = 0, constraint_size = 0;  // 0..1
};

double volume(const Eigen::Matrix3d& rows) noexcept {
  return rows.row(0).dot(rows.row(1).cross(rows.row(2)));
}

double relative_volume(const Eigen::Matrix3d& rows) noexcept {
  const double lengths = rows.row(0).norm() * rows.row(1).norm() * rows.row(2).norm();
  return lengths > 0 ? std::abs(volume(rows)) / lengths : 0;
}

Signs signs_at(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& xi) noexcept {
  Signs signs;
  const Rrs3Geometry& geometry = kinematics.geometry();
  const std::optional<Rrs3Configuration> at = kinematics.configuration(xi);
  if (!at) return signs;
  signs.reached = true;

  // E of (20) beside U of (11), [v, w b] for unknowns: each singularity is the determinant of a part of them.
  Eigen::Matrix3d u_dependent, u_independent, e_dependent, e_independent;
  signs.serial_size = 1;
  for (int leg = 0; leg < 3; ++leg) {
    const Eigen::Vector3d axis = kinematics.joint_axis(leg);
    const Eigen::Vector3d arm = at->platform_joints.col(leg) - at->position;
    const Eigen::Vector3d distal = at->platform_joints.col(leg) - at->elbows.col(leg);
    const Eigen::Vector3d turn = arm.cross(axis) / geometry.b_m, turning = arm.cross(distal) / geometry.b_m;
    u_dependent.row(leg) << axis.x(), axis.y(), turn.z();
    u_independent.row(leg) << 0, turn.x(), turn.y();
    e_dependent.row(leg) << distal.x(), distal.y(), turning.z();
    e_independent.row(leg) << distal.z(), turning.x(), turning.y();
    const double lever = at->knee(1, leg) * at->link(0, leg) - at->knee(0, leg) * at->link(1, leg);
    signs.serial_size = std::min(signs.serial_size, std::abs(lever) / (geometry.l1_m * geometry.l2_m));
  }
  signs.constraint = volume(u_dependent);
  signs.constraint_size = relative_volume(u_dependent);
  if (signs.constraint == 0) return signs;
  // Cramer's rule: det U times the inverse of U's dependent part.
  Eigen::Matrix3d adjoint;
  const Eigen::Vector3d c0 = u_dependent.col(0), c1 = u_dependent.col(1), c2 = u_dependent.col(2);
  adjoint.row(0) = c1.cross(c2);
  adjoint.row(1) = c2.cross(c0);
  adjoint.row(2) = c0.cross(c1);
  const Eigen::Matrix3d motion = e_independent - e_dependent * adjoint * u_independent / signs.constraint;
  signs.parallel = volume(motion);
  signs.parallel_size = relative_volume(motion);
  return signs;
}

double& coordinate(Rrs3Coordinates& xi, int which) noexcept {
  return which == 0 ? xi.pz_m : which == 1 ? xi.roll_rad : xi.pitch_rad;
}

// Walks from a pose in one direction and notes where each kind of singularity is first met.
class Walk {
 public:
  Walk(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& from, int which, double direction) noexcept
      : kinematics_(kinematics), from_(from), which_(which), direction_(direction), start_(at(0)) {}

  void run(double& serial, double& parallel, double& constraint) const noexcept {
    const double step = which_ == 0 ? kHeightStep_m : kTiltStep_rad;
    const double end = which_ == 0
                           ? 2 * (kinematics_.geometry().l1_m + kinematics_.geometry().l2_m) + std::abs(from_.pz_m)
                           : std::numbers::pi / 2 - direction_ * start_angle();
    Signs before = start_;
    const int steps = static_cast<int>(end / step);
    for (int i = 1; i <= steps; ++i) {
      const double far = step * i;
      const Signs here = at(far);
      if (!here.reached) {
        serial = edge(far - step, far, [](const Signs& a, const Signs&) { return !a.reached; });
        break;
      }
      if (here.constraint * before.constraint < 0 && std::isinf(constraint))
        constraint =
            edge(far - step, far, [](const Signs& a, const Signs& b) { return a.constraint * b.constraint < 0; });
      // Where det U passes through zero, H and with it the sign of J jump: that is no parallel singularity.
      else if (here.parallel * before.parallel < 0 && std::isinf(parallel))
        parallel = edge(far - step, far, [](const Signs& a, const Signs& b) { return a.parallel * b.parallel < 0; });
      before = here;
    }
  }

 private:
  double start_angle() const noexcept {
    Rrs3Coordinates xi = from_;
    return coordinate(xi, which_);
  }
  Signs at(double far) const noexcept {
    Rrs3Coordinates xi = from_;
    coordinate(xi, which_) += direction_ * far;
    return signs_at(kinematics_, xi);
  }
  template <typename Passed>
  double edge(double low, double high, Passed passed) const noexcept {
    const Signs before = at(low);
    while (high - low > kResolution) {
      const double middle = (low + high) / 2;
      (passed(at(middle), before) ? high : low) = middle;
    }
    return (low + high) / 2;
  }

  const Rrs3Kinematics& kinematics_;
  Rrs3Coordinates from_;
  int which_;
  double direction_;
  Signs start_;
};

Rrs3SingularityDistances::Along along(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& xi, int which) noexcept {
  Rrs3SingularityDistances::Along result;
  Walk(kinematics, xi, which, -1).run(result.serial.down, result.parallel.down, result.constraint.down);
  Walk(kinematics, xi, which, +1).run(result.serial.up, result.parallel.up, result.constraint.up);
  return result;
}

}  // namespace

std::optional<Rrs3SingularityDistances> singularity_distances(const Rrs3Kinematics& kinematics,
                                                              const Rrs3Coordinates& xi) noexcept {
  if (!condition_at(kinematics, xi)) return std::nullopt;
  const Signs here = signs_at(kinematics, xi);
  Rrs3SingularityDistances result;
  result.pz = along(kinematics, xi, 0);
  result.roll = along(kinematics, xi, 1);
  result.pitch = along(kinematics, xi, 2);
  result.serial = here.serial_size;
  result.parallel = here.parallel_size;
  result.constraint = here.constraint_size;
  return result;
}

}  // namespace jnd
