#include "devices/rrs3/rrs3_workspace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

void check_points(int points, const char* side) {
  if (points < 1) throw InputError(fmt::format("a grid of {} {}: give at least 1", points, side));
}

// Point `index` of `points` from low to high.
double point(double low, double high, int index, int points) noexcept {
  return points < 2 ? (low + high) / 2 : low + (high - low) * index / (points - 1);
}

}  // namespace

Rrs3Box box_of(const DeviceSpec& spec) noexcept {
  return {.lowest_m = spec.rest_z_m - spec.stroke_m / 2,
          .highest_m = spec.rest_z_m + spec.stroke_m / 2,
          .max_roll_rad = spec.max_roll_rad,
          .max_pitch_rad = spec.max_pitch_rad};
}

std::optional<double> condition_at(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& xi) noexcept {
  const std::optional<Rrs3Configuration> at = kinematics.configuration(xi);
  if (!at) return std::nullopt;
  const std::optional<Rrs3Differential> rates = kinematics.differential(*at);
  if (!rates) return std::nullopt;
  return kinematics.condition_number(rates->j);
}

Rrs3Workspace workspace_of(const Rrs3Kinematics& kinematics, const Rrs3Box& box, const Rrs3Grid& grid) {
  check_points(grid.heights, "heights");
  check_points(grid.rolls, "rolls");
  check_points(grid.pitches, "pitches");
  Rrs3Workspace result;
  for (int z = 0; z < grid.heights; ++z) {
    for (int r = 0; r < grid.rolls; ++r) {
      for (int p = 0; p < grid.pitches; ++p) {
        const Rrs3Coordinates xi{.pz_m = point(box.lowest_m, box.highest_m, z, grid.heights),
                                 .roll_rad = point(-box.max_roll_rad, box.max_roll_rad, r, grid.rolls),
                                 .pitch_rad = point(-box.max_pitch_rad, box.max_pitch_rad, p, grid.pitches)};
        ++result.poses;
        const std::optional<double> condition = condition_at(kinematics, xi);
        if (!condition) continue;
        ++result.reachable;
        if (*condition > result.worst_condition) {
          result.worst_condition = *condition;
          result.worst = xi;
        }
      }
    }
  }
  return result;
}

Rrs3ConditionMap condition_map(const Rrs3Kinematics& kinematics, const Rrs3Box& box, double pz_m, int rolls,
                               int pitches) {
  check_points(rolls, "rolls");
  check_points(pitches, "pitches");
  Rrs3ConditionMap map;
  map.pz_m = pz_m;
  for (int r = 0; r < rolls; ++r) map.rolls_rad.push_back(point(-box.max_roll_rad, box.max_roll_rad, r, rolls));
  for (int p = 0; p < pitches; ++p) map.pitches_rad.push_back(point(-box.max_pitch_rad, box.max_pitch_rad, p, pitches));
  for (const double roll : map.rolls_rad)
    for (const double pitch : map.pitches_rad)
      map.conditions.push_back(
          condition_at(kinematics, {.pz_m = pz_m, .roll_rad = roll, .pitch_rad = pitch}).value_or(kInf));
  return map;
}

std::string condition_csv(const Rrs3ConditionMap& map) {
  std::string text = "pz_m,roll_rad,pitch_rad,reachable,condition\n";
  for (std::size_t r = 0; r < map.rolls_rad.size(); ++r) {
    for (std::size_t p = 0; p < map.pitches_rad.size(); ++p) {
      const double condition = map.at(r, p);
      const bool reachable = std::isfinite(condition);
      text += fmt::format("{},{},{},{},{}\n", map.pz_m, map.rolls_rad[r], map.pitches_rad[p], reachable ? 1 : 0,
                          reachable ? fmt::format("{}", condition) : "");
    }
  }
  return text;
}

// Distances to the singularities of the 3RRS platform (declared in rrs3_workspace.h).

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
