// Shapes, taps and the shipped objects: what a finger meets.
#include "devices/contact/virtual_object.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <rapidcheck.h>
#include <unistd.h>

#include "analysis/numerics/special_values.h"
#include "devices/contact/god_object.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/contact/object_fixtures.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using Eigen::Vector3d;

namespace {

// Shapes: distances against brute force, normals against differences, where a line meets the surface, what is refused.

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

// A cue from the devices: one short vibration, whatever the object would be, and never a force.

TEST_CASE("a tap is one vibration on every pulp, without an object and without a force") {
  SimulatedClock clock{0};
  const std::unique_ptr<Rig> rig =
      make_simulated_rig(small_protocol(), rrs3_rig(), shipped_profile("chinello2017"), 3, 7, clock);
  for (int trial = 1; trial <= 3; ++trial) {
    PresentRequest tap;
    tap.tap_g = 0.5;
    tap.explore_s = 0.15;
    tap.id = {trial, 1, 0};
    const Presentation given = rig->present(tap);
    REQUIRE(given.fault == Fault::none);
    CHECK(given.duration_s == Approx(0.15).margin(1e-9));
    CHECK(given.first_contact_s == -1);
    REQUIRE(given.fingers.size() == 2);
    for (const FingerPresentation& finger : given.fingers) {
      CHECK(finger.vibration_g == Approx(0.5));
      CHECK(finger.peak_force_n == 0);
      CHECK(finger.contacts == 0);
    }
    // The stimulus after it is what it is without a tap.
    const Presentation stimulus = rig->present(request(600, kForce, {.trial = trial}));
    REQUIRE(stimulus.fault == Fault::none);
    CHECK(stimulus.fingers[0].vibration_g == 0);
    REQUIRE(stimulus.fingers[0].stiffness.has_value());
    CHECK(*stimulus.fingers[0].stiffness == Approx(600).epsilon(0.01));
  }
}

// Fingers on the shipped objects: pressed from every side, let go, counted, moved over the seam of the baseball, lost
// sight of, and begun again.

TEST_CASE("two fingers on one object do not know of each other") {
  const VirtualObject bear = shipped_object("teddy-bear");
  const auto path = [](int finger, int i) {
    const double t = 0.004 * i;
    return Vector3d((finger == 0 ? -1 : 1) * (0.045 + 0.02 * std::cos(t)), 0.005 * std::sin(2 * t), 0.02 * std::sin(t));
  };
  GodObject thumb = begun(bear, -Vector3d::UnitX()), index = begun(bear);
  GodObject alone[2] = {begun(bear, -Vector3d::UnitX()), begun(bear)};
  std::vector<Contact> together[2];
  for (int i = 0; i < 3000; ++i) {
    together[0].push_back(thumb.update(path(0, i)));
    together[1].push_back(index.update(path(1, i)));
  }
  int touching = 0;
  for (int finger = 0; finger < 2; ++finger) {
    for (int i = 0; i < 3000; ++i) {
      const Contact& now = alone[finger].update(path(finger, i));
      const Contact& then = together[finger][static_cast<std::size_t>(i)];
      REQUIRE(now.penetration_m == then.penetration_m);
      REQUIRE(now.normal == then.normal);
      REQUIRE(now.event == then.event);
      touching += now.touching;
    }
  }
  CHECK(touching > 1000);
}

TEST_CASE("pressed from any side the shipped objects push back, and let go") {
  for (const char* name : {"teddy-bear", "baseball", "sphere"}) {
    CAPTURE(name);
    const VirtualObject object = shipped_object(name);
    int straight = 0;
    for (const Vector3d& direction : directions(300)) {
      CAPTURE(direction.transpose());
      // Straight toward the origin.
      GodObject god = begun(object, direction);
      const double surface = object.surface_along(direction);
      int made = 0, broken = 0;
      double deepest = 0;
      const auto at = [&](const Vector3d& finger) {
        const Contact& now = god.update(finger);
        made += now.event == ContactEvent::made;
        broken += now.event == ContactEvent::broken;
        deepest = std::max(deepest, now.penetration_m);
        // Outward, whatever part it rests on.
        if (now.touching) REQUIRE(now.normal.dot(object.surface_from(now.proxy_m).normal) > 0);
        return now.touching;
      };
      for (double above = 0.02; above > 1e-6; above -= 1e-4) REQUIRE_FALSE(at((surface + above) * direction));
      REQUIRE(at((surface - 1e-6) * direction));
      for (double above = 0; above > -0.004; above -= 1e-4) (void)at((surface + above) * direction);
      CHECK(deepest > 0.0001);  // a straight way may graze an ear and slip off
      for (double above = -0.004; above < 0.02; above += 1e-4) (void)at((surface + above) * direction);
      CHECK_FALSE(god.contact().touching);
      CHECK(made == broken);
      CHECK(made >= 1);

      // Square onto the surface, where nothing stands in the way: it pushes the way it was pressed.
      const Vector3d foot = surface * direction, out = object.surface_from(foot).normal;
      if (object.surface_from(foot + 0.01 * out).distance_m < 0.0099) continue;
      ++straight;
      god.begin(object, out);
      for (double above = 0.01; above > -0.003; above -= 1e-4) (void)at(foot + above * out);
      REQUIRE(god.contact().touching);
      CHECK(god.contact().normal.dot(out) > 0.8);
      CHECK(god.contact().penetration_m > 0.0015);
      CHECK_FALSE(at(foot + 0.001 * out));
    }
    CHECK(straight > 100);
  }
}

TEST_CASE("presses are counted, one making and one breaking each") {
  const VirtualObject ball = shipped_object("baseball");
  GodObject god = begun(ball);
  const double surface = ball.surface_along(Vector3d::UnitX());
  int made = 0, broken = 0;
  for (int ms = 0; ms < 10000; ++ms) {
    const double t = 1e-3 * ms;
    // Ten presses, moving over the seam meanwhile.
    const Vector3d direction = Vector3d(1, 0.5 * std::sin(0.6 * t), 0.3 * std::cos(0.7 * t)).normalized();
    const Contact& now = god.update((surface + 0.003 + 0.008 * std::cos(2 * M_PI * t)) * direction);
    made += now.event == ContactEvent::made;
    broken += now.event == ContactEvent::broken;
  }
  CHECK(made == 10);
  CHECK(broken == 10);
}

TEST_CASE("the seam is felt as a bump, and passed without a catch") {
  const VirtualObject ball = shipped_object("baseball");
  // Around the ball at a constant depth below the leather: over the seam several times.
  const double radius = ball.spheres[0].radius_m - 0.002;
  GodObject god = begun(ball, Vector3d::UnitY());
  (void)god.update({0, 0.06, 0});
  double least = 1, most = 0, tilt = 1;
  for (int i = 0; i <= 6000; ++i) {
    const double angle = 2 * M_PI * i / 6000;
    const Vector3d out(std::sin(angle), std::cos(angle), 0);
    const Contact& now = god.update(radius * out);
    REQUIRE(now.touching);
    least = std::min(least, now.penetration_m);
    most = std::max(most, now.penetration_m);
    tilt = std::min(tilt, now.normal.dot(out));
  }
  CHECK(least == Approx(0.002).margin(1e-6));
  CHECK(most > 0.0026);  // on the seam it is lifted by 0.75 mm,
  CHECK(most < 0.0030);  // and does not stay behind
  CHECK(tilt > 0.85);    // it pushes outward all the way, on the flanks a little aside
  CHECK(tilt < 0.999);
}

TEST_CASE("what is no position is no contact, and the next position goes on") {
  const double nan = kNaN, inf = kInf;
  for (const char* name : {"sphere", "wall", "teddy-bear", "baseball"}) {
    CAPTURE(name);
    GodObject god = begun(shipped_object(name), -Vector3d::UnitX());
    (void)god.update({-0.06, 0, 0});
    REQUIRE(god.update({-0.022, 0, 0}).touching);
    const Contact pressed = god.contact();
    for (const Vector3d& bad : {Vector3d(nan, 0, 0), Vector3d(0, nan, nan), Vector3d(0, inf, 0),
                                Vector3d(-inf, inf, nan), Vector3d(1e300, -1e300, 0)}) {
      const Contact& now = god.update(bad);
      CHECK((now.event == ContactEvent::broken || name == std::string("wall")));
      CHECK((!now.touching || name == std::string("wall")));
      CHECK(god.update({-0.022, 0, 0}).touching);
      CHECK(god.contact().penetration_m == pressed.penetration_m);
      CHECK(god.contact().normal == pressed.normal);
    }
  }
}

TEST_CASE("a new interval begins afresh") {
  const VirtualObject bear = shipped_object("teddy-bear");
  GodObject god = begun(bear);
  (void)god.update({0.06, 0, 0});
  REQUIRE(god.update({0.02, 0, 0}).event == ContactEvent::made);
  god.begin(bear, Vector3d::UnitX());
  CHECK_FALSE(god.contact().touching);
  CHECK(god.update({0.02, 0, 0}).event == ContactEvent::made);
  // The same, whatever came before: nothing of it is kept.
  const Contact once = god.contact();
  god.begin(shipped_object("sphere"), Vector3d::UnitX());
  (void)god.update({0.01, 0, 0});
  god.begin(bear, Vector3d::UnitX());
  CHECK(god.update({0.02, 0, 0}).proxy_m == once.proxy_m);
}

// The shipped objects are what they say, and mistakes in object files are named with their places.

std::string file_complaint(const std::string& text) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("jnd_object_" + std::to_string(::getpid()) + ".json");
  std::ofstream(path) << text;
  std::string result;
  try {
    (void)load_object(path);
  } catch (const InputError& error) {
    result = error.what();
  }
  std::filesystem::remove(path);
  return result;
}

bool tells(const std::string& text, const std::string& words) {
  return file_complaint(text).find(words) != std::string::npos;
}

std::string with(const std::string& rest) {
  return R"({"format": 1, "name": "x", "title": "t", )" + rest + "}";
}

// Length of the free way of each of two fingers 130 mm apart along x.
double free_travel_m(const VirtualObject& object, double side) {
  return 0.065 - object.surface_along(Eigen::Vector3d(side, 0, 0));
}

TEST_CASE("every shipped object loads, is named as its file, and leaves the fingers room") {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(JND_SOURCE_DIR) + "/devices/objects")) {
    const ObjectFile file = load_object(entry.path());
    CAPTURE(file.name);
    CHECK(file.name == entry.path().stem().string());
    CHECK_FALSE(file.notes.empty());
    CHECK(file.sha256.size() == 64);
    CHECK(free_travel_m(file.shape, -1) >= 0.010);
    if (!file.shape.plane) {
      CHECK(free_travel_m(file.shape, 1) >= 0.010);
      // Not only along x itself: no part of it reaches a finger's rest position.
      CHECK(file.shape.surface_from({-0.065, 0, 0}).distance_m >= 0.010);
      CHECK(file.shape.surface_from({0.065, 0, 0}).distance_m >= 0.010);
    }
    ++count;
  }
  CHECK(count == 4);
}

TEST_CASE("the baseball is a regulation one, with one closed seam a little proud of the leather") {
  const VirtualObject ball = shipped_object("baseball");
  REQUIRE(ball.spheres.size() == 1);
  const double radius = ball.spheres[0].radius_m;
  CHECK(2 * std::numbers::pi * radius >= 0.2286);
  CHECK(2 * std::numbers::pi * radius <= 0.2350);
  double length = 0;
  for (std::size_t i = 0; i < ball.capsules.size(); ++i) {
    const Capsule& part = ball.capsules[i];
    CHECK(part.b_m == ball.capsules[(i + 1) % ball.capsules.size()].a_m);
    for (const double share : {0.0, 0.25, 0.5, 0.75}) {
      const double proud = (part.a_m + share * (part.b_m - part.a_m)).norm() + part.radius_m - radius;
      CHECK(proud >= 0.0005);
      CHECK(proud <= 0.001);
    }
    length += (part.b_m - part.a_m).norm() * radius / part.a_m.norm();  // on the leather
  }
  // A real seam measures about 17.5 inches (0.44 m).
  CHECK(length == Approx(0.43).margin(0.03));
}

TEST_CASE("the seam lies on the published curve") {
  const VirtualObject ball = shipped_object("baseball");
  const double radius = ball.spheres[0].radius_m;
  const double a = (radius + 0.0127) / 2, b = (radius - 0.0127) / 2;
  for (const Capsule& part : ball.capsules) {
    double nearest = 1;
    for (int i = 0; i < 20000; ++i) {
      const double t = 2 * std::numbers::pi * i / 20000;
      const Eigen::Vector3d on(2 * std::sqrt(a * b) * std::cos(2 * t), a * std::sin(t) + b * std::sin(3 * t),
                               a * std::cos(t) - b * std::cos(3 * t));
      nearest = std::min(nearest, (on.normalized() - part.a_m.normalized()).norm());
    }
    CHECK(nearest * radius < 2e-5);
  }
}

TEST_CASE("the teddy bear is 120 mm tall, in one piece and the same left and right") {
  const VirtualObject bear = shipped_object("teddy-bear");
  const auto reach = [&bear](const Eigen::Vector3d& direction) {
    double most = -1;
    for (const Sphere& part : bear.spheres) most = std::max(most, part.centre_m.dot(direction) + part.radius_m);
    for (const Capsule& part : bear.capsules)
      most = std::max(most, std::max(part.a_m.dot(direction), part.b_m.dot(direction)) + part.radius_m);
    return most;
  };
  CHECK(reach(Eigen::Vector3d::UnitZ()) + reach(-Eigen::Vector3d::UnitZ()) == Approx(0.12).margin(0.002));
  CHECK(reach(Eigen::Vector3d::UnitX()) == Approx(reach(-Eigen::Vector3d::UnitX())));
  CHECK(reach(Eigen::Vector3d::UnitX()) <= 0.055);
  // Every part overlaps the body or the head.
  for (std::size_t i = 1; i < bear.spheres.size(); ++i)
    CHECK(surface_from(bear.spheres[0], bear.spheres[i].centre_m).distance_m < bear.spheres[i].radius_m);
  CHECK(surface_from(bear.capsules[0], bear.spheres[0].centre_m).distance_m < bear.spheres[0].radius_m);
  for (std::size_t i = 1; i < bear.capsules.size(); ++i)
    CHECK(surface_from(bear.capsules[0], bear.capsules[i].a_m).distance_m < bear.capsules[i].radius_m);
  std::uint64_t state = 3;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = 0.07 * random_vector(state);
    CHECK(bear.surface_from(point).distance_m ==
          Approx(bear.surface_from({-point.x(), point.y(), point.z()}).distance_m).margin(1e-15));
  }
}

TEST_CASE("both forms of an object file are read as written") {
  const std::string sphere = R"({"sphere": {"centre_m": [0.01, 0, -0.02], "radius_m": 0.03}})";
  const std::string capsule = R"({"capsule": {"a_m": [0, 0, 0], "b_m": [0, 0.04, 0], "radius_m": 0.002}})";
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("jnd_good_object_" + std::to_string(::getpid()) + ".json");
  std::ofstream(path) << with(R"("shapes": [)" + capsule + "," + sphere + "]");
  const ObjectFile shapes = load_object(path);
  CHECK(shapes.title == "t");
  REQUIRE(shapes.shape.spheres.size() == 1);
  REQUIRE(shapes.shape.capsules.size() == 1);
  CHECK(shapes.shape.spheres[0].centre_m == Eigen::Vector3d(0.01, 0, -0.02));
  CHECK(shapes.shape.spheres[0].radius_m == 0.03);
  CHECK(shapes.shape.capsules[0].b_m == Eigen::Vector3d(0, 0.04, 0));
  CHECK(shapes.shape.capsules[0].radius_m == 0.002);
  std::ofstream(path) << with(R"("plane": {"point_m": [0, 0, 0.5], "normal": [0, 0, -2]})");
  const ObjectFile wall = load_object(path);
  std::filesystem::remove(path);
  REQUIRE(wall.shape.plane);
  CHECK(wall.shape.plane->normal == Eigen::Vector3d(0, 0, -1));
  CHECK(wall.shape.plane->point_m.z() == 0.5);
}

TEST_CASE("mistakes in an object file are named, all at once and with their places") {
  const std::string ball = R"({"sphere": {"centre_m": [0, 0, 0], "radius_m": 0.03}})";
  CHECK(file_complaint(with(R"("shapes": [)" + ball + "]")).empty());
  CHECK(tells(with(R"("notes": "n")"), "neither"));
  CHECK(tells(with(R"("shapes": [], "notes": "n")"), "$.shapes"));
  CHECK(tells(with(R"("shapes": [)" + ball + R"(], "plane": {"point_m": [0,0,0], "normal": [1,0,0]})"), "alone"));
  CHECK(tells(with(R"("plane": {"point_m": [0,0,0], "normal": [0,0,0]})"), "$.plane.normal"));
  CHECK(tells(with(R"("shapes": [{"spere": {}}])"), "did you mean \"sphere\"?"));
  CHECK(tells(with(R"("shapes": [{}])"), "is no shape"));
  CHECK(
      tells(with(R"("shapes": [{"sphere": {"centre_m": [0, 0], "radius_m": 0.03}}])"), "$.shapes[0].sphere.centre_m"));
  CHECK(tells(with(R"("shapes": [{"capsule": {"a_m": [0,0,0], "b_m": [0,0,0], "radius_m": 0.01}}])"),
              "make it a sphere"));
  const std::string all = file_complaint("{\"format\": 2, \"name\": \"x\",\n\"titel\": \"t\",\n\"shapes\": [\n" + ball +
                                         ",\n{\"sphere\": {\"centre_m\": [0, \"0\", 3], \"radius_m\": -1}}]}");
  CHECK(all.find("$.format") != std::string::npos);
  CHECK(all.find(":2:1: $.titel") != std::string::npos);
  CHECK(all.find(":5:29: $.shapes[1].sphere.centre_m[1]") != std::string::npos);
  CHECK(all.find(":5:34: $.shapes[1].sphere.centre_m[2]") != std::string::npos);
  CHECK(all.find("$.shapes[1].sphere.radius_m") != std::string::npos);
  CHECK(all.find("$.shapes[0]") == std::string::npos);
  CHECK_THROWS_AS(load_object("no/such/object.json"), InputError);
}

}  // namespace
