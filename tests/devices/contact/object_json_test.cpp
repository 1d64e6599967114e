// The shipped objects are what they say, and mistakes in object files are named with their places.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <unistd.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/contact/object_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

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

}  // namespace

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
