#include "devices/contact/virtual_object.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr double kUnit = 1e-9;  // how far the length of a unit vector may be from 1

// Distance to, and direction from, a point of the core (the centre, or the axis of a capsule).
SurfaceDistance from_core(const Eigen::Vector3d& core_m, double radius_m, const Eigen::Vector3d& point_m) noexcept {
  const Eigen::Vector3d outward = point_m - core_m;
  const double distance = outward.norm();
  return {.distance_m = distance - radius_m,
          .normal = distance > 0 ? Eigen::Vector3d(outward / distance) : Eigen::Vector3d(Eigen::Vector3d::UnitX())};
}

constexpr double kNowhere = -kInf;

// How far along a unit direction the line through the origin leaves a sphere for good.
double exit_of(const Sphere& sphere, const Eigen::Vector3d& direction) noexcept {
  const double along = sphere.centre_m.dot(direction);
  const double within =
      sphere.radius_m * sphere.radius_m - (sphere.centre_m - along * direction).squaredNorm();  // half chord, squared
  return within < 0 ? kNowhere : along + std::sqrt(within);
}

double exit_of(const Capsule& capsule, const Eigen::Vector3d& direction) noexcept {
  double last = std::max(exit_of(Sphere{capsule.a_m, capsule.radius_m}, direction),
                         exit_of(Sphere{capsule.b_m, capsule.radius_m}, direction));
  const Eigen::Vector3d whole = capsule.b_m - capsule.a_m;
  const double length = whole.norm();
  if (!(length > 0)) return last;
  // The barrel between them: a quadratic across the axis, good where its exit lies between the ends.
  const Eigen::Vector3d axis = whole / length;
  const Eigen::Vector3d across = direction - direction.dot(axis) * axis;
  const Eigen::Vector3d start = -capsule.a_m + capsule.a_m.dot(axis) * axis;
  const double a = across.squaredNorm(), b = start.dot(across);
  const double c = start.squaredNorm() - capsule.radius_m * capsule.radius_m;
  const double discriminant = b * b - a * c;
  if (!(a > 0) || discriminant < 0) return last;
  const double exit = (-b + std::sqrt(discriminant)) / a;
  const double at = (exit * direction - capsule.a_m).dot(axis);
  if (at >= 0 && at <= length) last = std::max(last, exit);
  return last;
}

bool within_limits(const Eigen::Vector3d& point_m) noexcept {
  return std::isfinite(point_m.sum()) && point_m.cwiseAbs().maxCoeff() <= kGreatestObject_m;
}

// What is wrong with a primitive, in words that follow its name.
class Complaints {
 public:
  void point(std::string_view name, std::string_view member, const Eigen::Vector3d& point_m) {
    if (!within_limits(point_m))
      add(fmt::format("{}: {} ({}, {}, {}) is not a place within {} m of the origin", name, member, point_m.x(),
                      point_m.y(), point_m.z(), kGreatestObject_m));
  }
  void radius(std::string_view name, double radius_m) {
    if (!(radius_m >= kLeastRadius_m && radius_m <= kGreatestObject_m))
      add(fmt::format("{}: radius_m {} must be {} to {} m", name, radius_m, kLeastRadius_m, kGreatestObject_m));
  }
  void add(std::string message) {
    Diagnostic diagnostic;
    diagnostic.message = std::move(message);
    all_.push_back(std::move(diagnostic));
  }
  void throw_any() {
    if (!all_.empty()) throw InputError(std::move(all_));
  }

 private:
  std::vector<Diagnostic> all_;
};

}  // namespace

SurfaceDistance surface_from(const Sphere& sphere, const Eigen::Vector3d& point_m) noexcept {
  return from_core(sphere.centre_m, sphere.radius_m, point_m);
}

SurfaceDistance surface_from(const Capsule& capsule, const Eigen::Vector3d& point_m) noexcept {
  const Eigen::Vector3d whole = capsule.b_m - capsule.a_m;
  const double squared = whole.squaredNorm();
  const double share = squared > 0 ? std::clamp((point_m - capsule.a_m).dot(whole) / squared, 0.0, 1.0) : 0;
  return from_core(capsule.a_m + share * whole, capsule.radius_m, point_m);
}

SurfaceDistance surface_from(const Plane& plane, const Eigen::Vector3d& point_m) noexcept {
  return {.distance_m = plane.normal.dot(point_m - plane.point_m), .normal = plane.normal};
}

SurfaceDistance VirtualObject::surface_from(const Eigen::Vector3d& point_m) const noexcept {
  SurfaceDistance least{.distance_m = kInf};
  const auto consider = [&least, &point_m](const auto& primitive) {
    const SurfaceDistance next = jnd::surface_from(primitive, point_m);
    if (next.distance_m < least.distance_m) least = next;
  };
  if (plane) consider(*plane);
  for (const Sphere& sphere : spheres) consider(sphere);
  for (const Capsule& capsule : capsules) consider(capsule);
  return least;
}

double VirtualObject::surface_along(const Eigen::Vector3d& direction) const noexcept {
  double last = kNowhere;
  if (plane) {
    const double facing = plane->normal.dot(direction);
    if (facing > 0) last = plane->normal.dot(plane->point_m) / facing;
  }
  for (const Sphere& sphere : spheres) last = std::max(last, exit_of(sphere, direction));
  for (const Capsule& capsule : capsules) last = std::max(last, exit_of(capsule, direction));
  return std::isfinite(last) ? last : 0;
}

VirtualObject sphere_object(const Sphere& sphere) {
  return {.spheres = {sphere}};
}

void check(const VirtualObject& object) {
  Complaints complaints;
  const std::size_t primitives = object.spheres.size() + object.capsules.size();
  if (!object.plane && primitives == 0)
    complaints.add("the virtual object is empty: give it a plane, or at least one sphere or capsule");
  if (object.plane && primitives > 0)
    complaints.add("a plane stands alone: leave out the plane, or the spheres and capsules");
  if (primitives > kMostPrimitives)
    complaints.add(fmt::format("the virtual object has {} spheres and capsules: at most {} are allowed", primitives,
                               kMostPrimitives));
  if (object.plane) {
    complaints.point("plane", "point_m", object.plane->point_m);
    if (!(std::abs(object.plane->normal.norm() - 1) <= kUnit)) complaints.add("plane: normal is not a unit vector");
  }
  for (std::size_t i = 0; i < object.spheres.size(); ++i) {
    const std::string name = fmt::format("sphere {}", i + 1);
    complaints.point(name, "centre_m", object.spheres[i].centre_m);
    complaints.radius(name, object.spheres[i].radius_m);
  }
  for (std::size_t i = 0; i < object.capsules.size(); ++i) {
    const std::string name = fmt::format("capsule {}", i + 1);
    complaints.point(name, "a_m", object.capsules[i].a_m);
    complaints.point(name, "b_m", object.capsules[i].b_m);
    complaints.radius(name, object.capsules[i].radius_m);
    if (!((object.capsules[i].b_m - object.capsules[i].a_m).norm() >= kLeastRadius_m))
      complaints.add(fmt::format("{}: its ends are the same point: make it a sphere", name));
  }
  complaints.throw_any();
}

}  // namespace jnd
