// Shapes: distances against brute force, normals against differences, where a line meets the surface, what is refused.
#include "devices/contact/virtual_object.h"

#include <cmath>

#include <Eigen/Geometry>
#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/contact/object_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// Distance by sampling the whole surface of a capsule: rings along the barrel, and a grid over both caps.
double sampled_distance(const Capsule& capsule, const Eigen::Vector3d& point) {
  const Eigen::Vector3d axis = (capsule.b_m - capsule.a_m).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  const double length = (capsule.b_m - capsule.a_m).norm();
  double least = kInf;
  constexpr int kAround = 240, kAlong = 160;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * M_PI * i / kAround;
    const Eigen::Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
    for (int j = 0; j <= kAlong; ++j) {
      const double share = static_cast<double>(j) / kAlong, polar = M_PI / 2 * share;
      const Eigen::Vector3d cap = capsule.radius_m * (std::sin(polar) * out + std::cos(polar) * axis);
      const Eigen::Vector3d end = capsule.radius_m * (std::sin(polar) * out - std::cos(polar) * axis);
      for (const Eigen::Vector3d& on : {Eigen::Vector3d(capsule.a_m + share * length * axis + capsule.radius_m * out),
                                        Eigen::Vector3d(capsule.b_m + cap), Eigen::Vector3d(capsule.a_m + end)})
        least = std::min(least, (on - point).norm());
    }
  }
  return least;
}

template <typename Shape>
Eigen::Vector3d gradient(const Shape& shape, const Eigen::Vector3d& point) {
  constexpr double kStep = 1e-6;
  Eigen::Vector3d result;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    result(i) =
        (surface_from(shape, point + step).distance_m - surface_from(shape, point - step).distance_m) / (2 * kStep);
  }
  return result;
}

std::string complaint(const VirtualObject& object) {
  try {
    check(object);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the distance to a capsule is that of a sampled surface, with its sign") {
  const Capsule capsule{.a_m = {0.01, -0.005, 0.002}, .b_m = {-0.015, 0.01, 0.012}, .radius_m = 0.008};
  std::uint64_t state = 7;
  int inside = 0;
  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector3d point = 0.02 * random_vector(state);
    const SurfaceDistance found = surface_from(capsule, point);
    // No sample is nearer than the surface, and one is within 0.2 mm of the nearest point, which from outside is seen
    // farther away by the roundness.
    const double sampled = sampled_distance(capsule, point);
    CHECK(sampled >= std::abs(found.distance_m) - 1e-12);
    CHECK(sampled <= std::hypot(found.distance_m, 5e-4));
    double core = kInf;
    for (int k = 0; k <= 4000; ++k)
      core = std::min(core, (capsule.a_m + k / 4000.0 * (capsule.b_m - capsule.a_m) - point).norm());
    CHECK((found.distance_m < 0) == (core < capsule.radius_m));
    inside += found.distance_m < 0;
  }
  CHECK(inside > 10);
}

TEST_CASE("normals are the gradients of the distances, and lead to the surface") {
  REQUIRE(rc::check("normals", [] {
    std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
    const Sphere sphere{.centre_m = 0.02 * random_vector(state), .radius_m = 0.01};
    const Capsule capsule{.a_m = 0.02 * random_vector(state), .b_m = 0.02 * random_vector(state), .radius_m = 0.006};
    const Plane plane{.point_m = 0.02 * random_vector(state), .normal = random_vector(state).normalized()};
    const Eigen::Vector3d point = 0.04 * random_vector(state);
    const auto holds = [&point](const auto& shape) {
      const SurfaceDistance found = surface_from(shape, point);
      RC_ASSERT(std::abs(found.normal.norm() - 1) < 1e-12);
      const Eigen::Vector3d foot = point - found.distance_m * found.normal;
      RC_ASSERT(std::abs(surface_from(shape, foot).distance_m) < 1e-12);
      // Differences need room: not on the core, where the gradient turns round.
      if (found.distance_m > -0.004) RC_ASSERT((gradient(shape, point) - found.normal).norm() < 1e-3);
    };
    holds(sphere);
    holds(capsule);
    holds(plane);
  }));
}

TEST_CASE("a union's distance is the least one of its parts") {
  const VirtualObject object{.spheres = {{{0, 0, 0}, 0.02}, {{0.03, 0, 0}, 0.01}},
                             .capsules = {{{0, 0, 0}, {0, 0.05, 0}, 0.005}}};
  CHECK(object.surface_from({-0.03, 0, 0}).distance_m == Approx(0.01));
  CHECK(object.surface_from({0.05, 0, 0}).distance_m == Approx(0.01));
  CHECK(object.surface_from({0.05, 0, 0}).normal == Eigen::Vector3d::UnitX());
  CHECK(object.surface_from({0.015, 0.04, 0}).distance_m == Approx(0.01));
  CHECK(object.surface_from({0.001, 0, 0}).distance_m == Approx(-0.019));
  CHECK(std::isinf(VirtualObject{}.surface_from({0, 0, 0}).distance_m));
}

TEST_CASE("a line from the origin meets the object where marching along it does") {
  REQUIRE(rc::check("surface_along", [] {
    std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
    VirtualObject object = random_object(state);
    // The origin inside, so that every line meets it.
    object.spheres.push_back({.centre_m = Eigen::Vector3d::Zero(), .radius_m = 0.004});
    const Eigen::Vector3d direction = random_vector(state).normalized();
    const double found = object.surface_along(direction);
    RC_ASSERT(std::abs(object.surface_from(found * direction).distance_m) < 1e-10);
    for (double t = found + 1e-7; t < 0.15; t += 2e-4) RC_ASSERT(object.surface_from(t * direction).distance_m > 0);
  }));
  const VirtualObject apart{.spheres = {{{0.05, 0, 0}, 0.01}}};
  CHECK(apart.surface_along(Eigen::Vector3d::UnitX()) == Approx(0.06));
  CHECK(apart.surface_along(-Eigen::Vector3d::UnitX()) == Approx(-0.04));  // it ends behind the origin
  CHECK(apart.surface_along(Eigen::Vector3d::UnitY()) == 0);
  const VirtualObject rod{.capsules = {{{0.02, -0.03, 0}, {0.02, 0.03, 0}, 0.005}}};
  CHECK(rod.surface_along(Eigen::Vector3d::UnitX()) == Approx(0.025));
  const VirtualObject wall{.plane = Plane{.point_m = {-0.04, 0, 0}, .normal = {-1, 0, 0}}};
  CHECK(wall.surface_along(-Eigen::Vector3d::UnitX()) == Approx(0.04));
  CHECK(wall.surface_along(Eigen::Vector3d::UnitX()) == 0);
  CHECK(wall.surface_along(Eigen::Vector3d(-1, 1, 0).normalized()) == Approx(0.04 * std::sqrt(2.0)));
}

TEST_CASE("objects that cannot be touched are refused, with every reason") {
  CHECK(complaint(sphere_object({.centre_m = {0, 0, 0}, .radius_m = 0.04})).empty());
  CHECK(complaint({.plane = Plane{}}).empty());
  CHECK(complaint({}).find("empty") != std::string::npos);
  CHECK(complaint({.plane = Plane{}, .spheres = {{{0, 0, 0}, 0.01}}}).find("stands alone") != std::string::npos);
  CHECK(complaint({.plane = Plane{.normal = {1, 1, 0}}}).find("unit vector") != std::string::npos);
  const double nan = kNaN;
  const std::string both = complaint({.spheres = {{{0, 0, 0}, 0.01}, {{nan, 0, 0}, 0}},
                                      .capsules = {{{0, 0, 0}, {0, 0, 0}, 0.01}, {{0, 0, 9}, {0, 0, 0}, nan}}});
  CHECK(both.find("sphere 1:") == std::string::npos);
  CHECK(both.find("sphere 2: centre_m") != std::string::npos);
  CHECK(both.find("sphere 2: radius_m") != std::string::npos);
  CHECK(both.find("capsule 1: its ends are the same point") != std::string::npos);
  CHECK(both.find("capsule 2: a_m") != std::string::npos);
  CHECK(both.find("capsule 2: radius_m") != std::string::npos);
  VirtualObject many;
  many.spheres.assign(kMostPrimitives + 1, {{0, 0, 0}, 0.01});
  CHECK(complaint(many).find("at most 1000") != std::string::npos);
}
