// The shape of a virtual object: a wall, or a union of spheres and capsules. How far a point is from its surface, which
// way the surface faces, and where a finger that comes along a line meets it first.
//
// World frame and units as in tracker.h: metres, x from thumb to index, z up. Every primitive is convex; the god object
// (god_object.h) relies on it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace jnd {

struct Sphere {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

// All points within radius_m of the segment from a to b.
struct Capsule {
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

// A half space: solid behind the plane through point_m, free where the unit normal points.
struct Plane {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
};

// Where a primitive's surface lies, seen from a point.
struct SurfaceDistance {
  double distance_m = 0;                              // to the surface; negative inside
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, outward, at the nearest surface point
};

// The nearest surface point is point - distance_m * normal. On the sphere's centre or the capsule's axis, where every
// direction is as good, the normal is one of them.
SurfaceDistance surface_from(const Sphere& sphere, const Eigen::Vector3d& point_m) noexcept;
SurfaceDistance surface_from(const Capsule& capsule, const Eigen::Vector3d& point_m) noexcept;
SurfaceDistance surface_from(const Plane& plane, const Eigen::Vector3d& point_m) noexcept;

// A plane alone, or at least one sphere or capsule and no plane.
struct VirtualObject {
  std::optional<Plane> plane{};
  std::vector<Sphere> spheres{};
  std::vector<Capsule> capsules{};

  // The least of the primitives' distances, with its normal. Outside it is the distance to the object's surface; inside
  // it only says how deep the point is in the primitive that covers it best. +inf for an object without primitives.
  SurfaceDistance surface_from(const Eigen::Vector3d& point_m) const noexcept;

  // How far along a unit direction from the origin the last point of the object's surface lies: a finger that comes in
  // along that line from afar meets the object there. Negative where all of it lies behind the origin. 0 where the line
  // misses the object, and for a wall that does not face the finger: there is nothing to meet.
  double surface_along(const Eigen::Vector3d& direction) const noexcept;
};

// A sphere about a centre, the object of the published experiment.
VirtualObject sphere_object(const Sphere& sphere);

// Coordinates and radii beyond this are no object for two fingers, m.
inline constexpr double kGreatestObject_m = 1;
// Smaller radii are sharper than any device can show, and their contact would be rounding, m.
inline constexpr double kLeastRadius_m = 1e-4;
inline constexpr std::size_t kMostPrimitives = 1000;

// Throws InputError, with every reason, where the object cannot be touched as it should: nothing in it, a plane beside
// other shapes, more than kMostPrimitives, numbers that are not finite or beyond the limits above, a capsule without
// length, a normal that is not a unit vector.
void check(const VirtualObject& object);

}  // namespace jnd
