// Fingers on the shipped objects: pressed from every side, let go, counted, moved over the seam of the baseball, lost
// sight of, and begun again.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "devices/contact/god_object.h"
#include "tests/catch.h"
#include "tests/devices/contact/object_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using Eigen::Vector3d;

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
