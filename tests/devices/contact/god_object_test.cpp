// God-object contact: the laws of one primitive, of the joins between several, and of a whole motion. What the shipped
// objects feel like is in shipped_objects_tests.cpp.
#include "devices/contact/god_object.h"

#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <rapidcheck.h>

#include "tests/catch.h"
#include "tests/devices/contact/object_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using Eigen::Vector3d;

namespace {

Vector3d force(const Contact& contact) {
  return contact.touching ? Vector3d(contact.penetration_m * contact.normal) : Vector3d(Vector3d::Zero());
}

// Two balls side by side, a groove in the plane x = 0: the circle of radius sqrt(r^2 - h^2).
constexpr double kBall_m = 0.02, kHalf_m = 0.015;
const VirtualObject kPair{.spheres = {{{-kHalf_m, 0, 0}, kBall_m}, {{kHalf_m, 0, 0}, kBall_m}}};

// A rod along y that is thin for a finger.
constexpr double kRod_m = 0.003;
const VirtualObject kRod{.capsules = {{{0, -0.03, 0}, {0, 0.03, 0}, kRod_m}}};

// Depth over curvature in the direction that the touched primitives leave, from their normals alone; 1 and more is no
// minimum. None where the proxy is not at rest: the finger is not behind its surfaces.
std::optional<double> bend(const VirtualObject& object, const Contact& contact) {
  std::vector<std::pair<Vector3d, double>> touched;
  const auto consider = [&](const auto& shape) {
    const SurfaceDistance at = surface_from(shape, contact.proxy_m);
    if (at.distance_m < 1e-8) touched.emplace_back(at.normal, shape.radius_m);
  };
  for (const Sphere& sphere : object.spheres) consider(sphere);
  for (const Capsule& capsule : object.capsules) consider(capsule);
  if (touched.size() == 1) return contact.penetration_m / touched[0].second;
  if (touched.size() != 2) return std::nullopt;
  Eigen::Matrix<double, 3, 2> normals;
  normals << touched[0].first, touched[1].first;
  const Eigen::Vector2d pushes =
      (normals.transpose() * normals).inverse() * normals.transpose() * (contact.penetration_m * contact.normal);
  // A surface that would have to pull holds nothing: then one of them is alone, the one that is bent more.
  if (pushes.minCoeff() < 0)
    return contact.penetration_m * std::max(contact.normal.dot(touched[0].first) / touched[0].second,
                                            contact.normal.dot(touched[1].first) / touched[1].second);
  return pushes(0) / touched[0].second + pushes(1) / touched[1].second;
}

// How much nearer to the finger a point of the surface near the proxy is than the proxy, at the most, m.
double gain_nearby(const VirtualObject& object, const Contact& contact, const Vector3d& finger, std::uint64_t& state) {
  constexpr double kStep = 2e-5;
  double most = 0;
  for (int i = 0; i < 40; ++i) {
    Vector3d point = contact.proxy_m + kStep * random_vector(state);
    for (int k = 0; k < 8; ++k) {
      const SurfaceDistance at = object.surface_from(point);
      point -= at.distance_m * at.normal;
    }
    if (std::abs(object.surface_from(point).distance_m) > 1e-12) continue;
    if ((point - contact.proxy_m).norm() > 4 * kStep) continue;
    most = std::max(most, contact.penetration_m - (point - finger).norm());
  }
  return most;
}

// A finger that is drawn to the origin and pushed about; hurry 1 is a person's hand, 50 crosses the object in a tick.
class Walk {
 public:
  explicit Walk(std::uint64_t seed, double hurry) : state_(seed), hurry_(hurry) {}
  const Vector3d& next() {
    velocity_ = 0.95 * velocity_ + 1e-4 * hurry_ * random_vector(state_) - 5e-4 * hurry_ * at_;
    at_ += velocity_;
    return at_;
  }

 private:
  std::uint64_t state_;
  double hurry_;
  Vector3d at_ = {0.08, 0, 0};
  Vector3d velocity_ = Vector3d::Zero();
};

// One walk on one random union; the finger waits for six ticks at every place.
bool only_comes_nearer(std::uint64_t seed, double hurry) {
  std::uint64_t state = seed;
  GodObject god = begun(random_object(state));
  Walk walk(state, hurry);
  for (int i = 0; i < 600; ++i) {
    const Vector3d finger = walk.next();
    Contact before = god.update(finger);
    for (int k = 0; k < 6; ++k) {
      const Contact& now = god.update(finger);
      if (now.touching > before.touching || now.penetration_m > before.penetration_m + 1e-12) return false;
      before = now;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("a lone sphere gives the nearest point, to the last bit") {
  const Sphere sphere{.centre_m = {0.01, -0.02, 0.03}, .radius_m = 0.04};
  REQUIRE(rc::check("sphere", [&sphere] {
    std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
    GodObject god = begun(sphere_object(sphere));
    bool touched = false;
    for (int i = 0; i < 50; ++i) {
      const Vector3d finger = sphere.centre_m + 0.05 * random_vector(state);
      const Contact& now = god.update(finger);
      const Vector3d from_centre = finger - sphere.centre_m;
      const double distance = std::sqrt(from_centre.squaredNorm());
      const Vector3d normal = from_centre * (1 / distance);
      RC_ASSERT(now.normal == normal);
      RC_ASSERT(now.proxy_m == Vector3d(sphere.centre_m + sphere.radius_m * normal));
      RC_ASSERT(now.touching == (sphere.radius_m - distance > 1e-12));
      RC_ASSERT(now.penetration_m == (now.touching ? sphere.radius_m - distance : 0));
      RC_ASSERT(now.event == (now.touching == touched ? ContactEvent::none
                              : now.touching          ? ContactEvent::made
                                                      : ContactEvent::broken));
      touched = now.touching;
    }
  }));
}

TEST_CASE("at a lone sphere's centre the last normal is kept, and its surface is not contact") {
  const Sphere sphere{.centre_m = {0.01, -0.02, 0.03}, .radius_m = 0.04};
  GodObject god = begun(sphere_object(sphere), Vector3d::UnitZ());
  CHECK(god.update(sphere.centre_m).normal == Vector3d::UnitZ());
  CHECK(god.contact().penetration_m == sphere.radius_m);
  (void)god.update(sphere.centre_m + 0.01 * Vector3d::UnitY());
  CHECK(god.update(sphere.centre_m).normal == Vector3d::UnitY());
  CHECK(god.update(sphere.centre_m + 0.04 * Vector3d::UnitY()).event == ContactEvent::broken);
}

TEST_CASE("a wall pushes along its normal, however deep and however fast") {
  const Plane plane{.point_m = {0.01, 0, 0}, .normal = Vector3d(1, 2, -2).normalized()};
  GodObject god = begun({.plane = plane});
  std::uint64_t state = 4;
  bool touched = false;
  for (int i = 0; i < 500; ++i) {
    const Vector3d finger = plane.point_m + 0.5 * random_vector(state);
    const Contact& now = god.update(finger);
    const double above = plane.normal.dot(finger - plane.point_m);
    CHECK(now.touching == (above < -1e-12));
    CHECK(now.penetration_m == Approx(std::max(-above, 0.0)).margin(1e-15));
    CHECK(now.normal == plane.normal);
    CHECK(std::abs(plane.normal.dot(now.proxy_m - plane.point_m)) < 1e-15);
    CHECK((now.event == ContactEvent::none) == (now.touching == touched));
    touched = now.touching;
  }
}

TEST_CASE("a capsule alone gives the nearest point of its surface") {
  REQUIRE(rc::check("capsule", [] {
    std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
    const Capsule capsule{.a_m = {-0.02, 0, 0.001}, .b_m = {0.02, 0.003, 0}, .radius_m = 0.01};
    // Pressed from above, down to less than the core.
    GodObject god = begun({.capsules = {capsule}});
    Vector3d finger(0, 0, 0.02);
    (void)god.update(finger);
    for (int i = 0; i < 200; ++i) {
      finger += 3e-4 * random_vector(state);
      finger.z() = std::clamp(finger.z() - 1e-4, 0.005, 0.02);
      const Contact& now = god.update(finger);
      const SurfaceDistance nearest = surface_from(capsule, finger);
      RC_ASSERT(now.touching == (nearest.distance_m < -1e-12));
      RC_ASSERT((now.normal - nearest.normal).norm() < 1e-9);
      RC_ASSERT((now.proxy_m - (finger - nearest.distance_m * nearest.normal)).norm() < 1e-11);
    }
  }));
}

TEST_CASE("on a random walk over a random union the proxy never enters it, and the books are kept") {
  for (const double hurry : {1.0, 7.0, 50.0}) {
    REQUIRE(rc::check("walk", [hurry] {
      std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
      const VirtualObject object = random_object(state);
      GodObject god = begun(object);
      Walk walk(state, hurry);
      bool touched = false;
      int made = 0, broken = 0;
      for (int i = 0; i < 600; ++i) {
        const Vector3d finger = walk.next();
        const Contact& now = god.update(finger);
        const double depth = -object.surface_from(finger).distance_m;
        RC_ASSERT(std::abs(now.normal.norm() - 1) < 1e-12);
        RC_ASSERT(object.surface_from(now.proxy_m).distance_m > -1e-12);
        if (depth > 1e-9) RC_ASSERT(now.touching);
        if (now.touching) {
          const Vector3d offset = now.proxy_m - finger;
          RC_ASSERT(std::abs(now.penetration_m - offset.norm()) < 1e-12);
          RC_ASSERT(now.penetration_m >= depth - 1e-12);
          if (now.penetration_m > 1e-6) RC_ASSERT((now.normal - offset / now.penetration_m).norm() < 1e-6);
        } else {
          RC_ASSERT(now.penetration_m == 0);
          RC_ASSERT(std::abs(object.surface_from(now.proxy_m).distance_m) < 1e-12);  // the nearest surface point
          RC_ASSERT((now.proxy_m - finger).norm() <= std::abs(depth) + 1e-12);
        }
        RC_ASSERT(now.event == (now.touching == touched ? ContactEvent::none
                                : now.touching          ? ContactEvent::made
                                                        : ContactEvent::broken));
        made += now.event == ContactEvent::made;
        broken += now.event == ContactEvent::broken;
        touched = now.touching;
        RC_ASSERT(made - broken == (touched ? 1 : 0));
      }
    }));
  }
}

TEST_CASE("under a finger that stays where it is the proxy only comes nearer") {
  // Where it once went to and fro, between a groove and a place along a capsule.
  for (const std::uint64_t seed : {14691236U, 1047811U}) CHECK(only_comes_nearer(seed, 1));
  for (const double hurry : {1.0, 7.0})
    REQUIRE(rc::check("nearer", [hurry] { return only_comes_nearer(*rc::gen::arbitrary<std::uint64_t>(), hurry); }));
}

TEST_CASE("at rest no point of the surface nearby is nearer to the finger") {
  int checked = 0, held = 0;
  REQUIRE(rc::check("local minimum", [&checked, &held] {
    std::uint64_t state = *rc::gen::arbitrary<std::uint64_t>();
    const VirtualObject object = random_object(state);
    GodObject god = begun(object);
    Walk walk(state, 1);
    for (int i = 0; i < 600; ++i) {
      const Vector3d finger = walk.next();
      // Sliding off a ridge may take more than a tick, and down a groove nearly as deep as it is round many more: the
      // finger waits until the proxy rests. One that is held may go on following along a capsule, ever more slowly.
      for (int k = 0; k < 3; ++k) (void)god.update(finger);
      for (int k = 0; k < 200; ++k) {
        const Vector3d before = god.contact().proxy_m;
        if ((god.update(finger).proxy_m - before).norm() < 1e-9) break;
      }
      const Contact& now = god.contact();
      if (!now.touching) continue;
      const std::optional<double> depth = bend(object, now);
      if (!depth || *depth > 0.8) {
        ++held;
        continue;
      }
      ++checked;
      RC_ASSERT(gain_nearby(object, now, finger, state) < 1e-9);
    }
  }));
  CHECK(checked > 2000);
  CHECK(checked > held);
}

TEST_CASE("in the groove between two balls the proxy lies on the circle where they meet") {
  const double groove = std::sqrt(kBall_m * kBall_m - kHalf_m * kHalf_m);
  GodObject god = begun(kPair);
  for (int i = 0; i <= 400; ++i) {
    const double angle = 0.5 + 0.004 * i;
    const Vector3d out(0, std::cos(angle), std::sin(angle));
    const double depth = std::min(1e-4 * i, 0.006) - 0.004;
    // Off the middle by less than would lift the proxy out of the groove.
    const Vector3d finger = (groove - depth) * out + Vector3d(0.0005 * std::sin(0.1 * i), 0, 0);
    const Contact& now = god.update(finger);
    if (depth < 0.001) continue;
    REQUIRE(now.touching);
    CHECK((now.proxy_m - groove * out).norm() < 1e-8);
    CHECK((now.normal - (groove * out - finger).normalized()).norm() < 1e-5);
  }
}

TEST_CASE("in the dent between three balls the proxy lies on all three") {
  VirtualObject object;
  constexpr double kRing_m = 0.012;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * M_PI * i / 3 + 0.3;
    object.spheres.push_back({{kRing_m * std::cos(angle), kRing_m * std::sin(angle), 0}, 0.02});
  }
  const Vector3d dent(0, 0, std::sqrt(0.02 * 0.02 - kRing_m * kRing_m));
  GodObject god = begun(object);
  for (int i = 0; i <= 300; ++i) {
    const Vector3d finger = dent + Vector3d(0.0003 * std::sin(0.2 * i), 0.0003 * std::cos(0.13 * i), 0.01 - 5e-5 * i);
    const Contact& now = god.update(finger);
    if (finger.z() > dent.z() - 0.001) continue;
    REQUIRE(now.touching);
    CHECK((now.proxy_m - dent).norm() < 1e-8);
    CHECK(now.penetration_m == Approx((finger - dent).norm()).epsilon(1e-6));
  }
}

TEST_CASE("crossing a groove the force changes no faster than the finger moves") {
  GodObject god = begun(kPair);
  const double height = std::sqrt(kBall_m * kBall_m - kHalf_m * kHalf_m) - 0.003;
  constexpr double kStep = 2e-6;
  const auto place = [height](int i) { return Vector3d(kStep * i, 0.001, height); };
  (void)god.update(place(-4000) + 0.03 * Vector3d::UnitZ());
  Vector3d last_force = force(god.update(place(-4000)));
  double most = 0;
  int sheets = 0;
  for (int i = -3999; i <= 4000; ++i) {
    const Contact& now = god.update(place(i));
    REQUIRE(now.touching);
    most = std::max(most, (force(now) - last_force).norm() / kStep);
    last_force = force(now);
    sheets += std::abs(now.proxy_m.x()) < 1e-9;
  }
  CHECK(sheets > 500);   // it was in the groove,
  CHECK(sheets < 6000);  // and on both sides of it
  CHECK(most < 5);       // a jump of a micrometre would be 0.5 here
}

TEST_CASE("a closed loop of the finger does no work") {
  // Over the groove and both balls; the force is minus the gradient of half the squared depth.
  const double height = std::sqrt(kBall_m * kBall_m - kHalf_m * kHalf_m);
  GodObject god = begun(kPair);
  (void)god.update({0, 0, 0.05});
  constexpr int kTicks = 20000;
  double work = 0, moved = 0, most_error = 0, start_energy = 0;
  Vector3d last_finger = Vector3d::Zero(), last_force = Vector3d::Zero();
  for (int i = 0; i <= 2 * kTicks; ++i) {
    const double t = 2 * M_PI * i / kTicks;
    const Vector3d finger(0.007 * std::sin(t), 0.003 * std::sin(2 * t + 1), height - 0.003 + 0.0015 * std::cos(3 * t));
    const Contact& now = god.update(finger);
    REQUIRE(now.touching);
    const double energy = 0.5 * now.penetration_m * now.penetration_m;
    if (i == 0) start_energy = energy;
    if (i > 0) {
      const double step = 0.5 * (force(now) + last_force).dot(finger - last_finger);
      work += step;
      moved += std::abs(step);
      most_error = std::max(most_error, std::abs(start_energy - energy - work));
    }
    last_finger = finger;
    last_force = force(now);
  }
  CHECK(moved > 1e-5);  // m^2 of work per N/m: it really pressed
  CHECK(std::abs(work) < 1e-5 * moved);
  CHECK(most_error < 1e-5 * moved);
}

TEST_CASE("pressed through a thin rod the proxy stays on the near side, and comes off the way it came") {
  for (const double aside : {0.0, 1e-6, 1e-4, 3e-4}) {
    CAPTURE(aside);
    GodObject god = begun(kRod);
    int made = 0, broken = 0;
    double last = 0;
    const auto at = [&](double height) -> const Contact& {
      const Contact& now = god.update({aside, 0.002, height});
      made += now.event == ContactEvent::made;
      broken += now.event == ContactEvent::broken;
      return now;
    };
    for (double height = 0.01; height > -0.02; height -= 5e-5) {
      const Contact& now = at(height);
      REQUIRE(now.touching == (height < std::sqrt(kRod_m * kRod_m - aside * aside) - 1e-12));
      if (!now.touching) continue;
      REQUIRE(now.proxy_m.z() > 0.55 * kRod_m);
      REQUIRE(now.normal.z() > 0.5);
      REQUIRE(now.penetration_m > last);
      last = now.penetration_m;
    }
    // Deep below it goes along with the finger, as far as the rod goes.
    for (double y = 0.002; y < 0.05; y += 5e-5) (void)god.update({aside, y, -0.02});
    CHECK(god.contact().touching);
    CHECK(god.contact().proxy_m.y() == Approx(0.03).margin(1e-4));
    CHECK(god.contact().normal.z() > 0.5);
    for (double y = 0.05; y > 0.002; y -= 5e-5) (void)god.update({aside, y, -0.02});
    for (double height = -0.02; height < 0.01; height += 5e-5) (void)at(height);
    CHECK(made == 1);
    CHECK(broken == 1);
  }
}

TEST_CASE("a finger that presses beside the axis slips off smoothly") {
  GodObject god = begun(kRod);
  Vector3d last = Vector3d(0.0008, 0, std::sqrt(kRod_m * kRod_m - 0.0008 * 0.0008)) / kRod_m;
  int broken = 0;
  for (double height = 0.01; height > -0.01; height -= 2e-5) {
    const Contact& now = god.update({0.0008, 0, height});
    broken += now.event == ContactEvent::broken;
    if (!now.touching) continue;
    CHECK((now.normal - last).norm() < 1.1 * 2e-5 / 0.0008);  // step over distance from the axis
    last = now.normal;
  }
  CHECK(broken == 1);
  CHECK(last.z() < -0.5);
  CHECK_FALSE(god.contact().touching);
}

TEST_CASE("a finger that crosses a thin part within one tick is caught on the near side") {
  for (const double aside : {0.0, 0.001, -0.002}) {
    GodObject god = begun(kRod);
    (void)god.update({aside, 0, 0.02});
    const Contact& now = god.update({aside, 0.004, -0.02});
    CHECK(now.event == ContactEvent::made);
    CHECK(now.proxy_m.z() > 0);
    CHECK(now.normal.z() > 0.8);
    CHECK(god.update({aside, 0, 0.02}).event == ContactEvent::broken);
  }
  // And one that passes beside it is not.
  GodObject god = begun(kRod);
  (void)god.update({0.0031, 0, 0.02});
  CHECK(god.update({0.0031, 0, -0.02}).event == ContactEvent::none);
  CHECK_FALSE(god.contact().touching);
}

TEST_CASE("a finger that begins inside is where it comes from") {
  VirtualObject object = kPair;
  object.capsules.push_back({{0, 0, 0}, {0, 0.02, 0}, 0.01});
  for (const double side : {-1.0, 1.0}) {
    GodObject god = begun(object, Vector3d(side, 0, 0));
    const Contact& now = god.update({side * 0.030, 0.001, 0});
    CHECK(now.event == ContactEvent::made);
    CHECK(now.normal.x() * side > 0.9);
    CHECK(now.penetration_m == Approx(kBall_m - std::hypot(0.015, 0.001)));
  }
  // Deep on the other side, it still is.
  GodObject god = begun(kRod, Vector3d::UnitZ());
  CHECK(god.update({0, 0, -0.001}).normal.z() == Approx(1));
}
