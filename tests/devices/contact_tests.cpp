// God-object contact with a sphere.
#include <cmath>

#include <rapidcheck.h>

#include "devices/contact.h"
#include "tests/catch.h"

using namespace jnd;

namespace {
const Sphere kSphere{.centre_m = {0.01, -0.02, 0.03}, .radius_m = 0.04};
}

TEST_CASE("the proxy lies on the surface and the normal points out") {
  REQUIRE(rc::check("contact", [] {
    const auto share = [] { return *rc::gen::inRange(-1000, 1001) / 1000.0; };
    const Eigen::Vector3d offset(0.05 * share(), 0.05 * share(), 0.05 * share());
    RC_PRE(offset.norm() > 1e-6);
    SphereContact contact;
    contact.begin(kSphere, Eigen::Vector3d::UnitX());
    const Contact& now = contact.update(kSphere.centre_m + offset);
    RC_ASSERT(std::abs(now.normal.norm() - 1) < 1e-12);
    RC_ASSERT(std::abs((now.proxy_m - kSphere.centre_m).norm() - kSphere.radius_m) < 1e-12);
    RC_ASSERT(std::abs(now.normal.dot(offset) - offset.norm()) < 1e-12);
    RC_ASSERT(now.penetration_m >= 0);
    RC_ASSERT(now.touching == (offset.norm() < kSphere.radius_m));
    if (now.touching) RC_ASSERT(std::abs(now.penetration_m - (0.04 - offset.norm())) < 1e-12);
  }));
}

TEST_CASE("making and breaking are each told once") {
  SphereContact contact;
  contact.begin(kSphere, Eigen::Vector3d::UnitX());
  const auto at = [&](double distance) {
    return contact.update(kSphere.centre_m + distance * Eigen::Vector3d::UnitY()).event;
  };
  CHECK(at(0.05) == ContactEvent::none);
  CHECK(at(0.04) == ContactEvent::none);  // on the surface is not in it
  CHECK(at(0.039) == ContactEvent::made);
  CHECK(at(0.035) == ContactEvent::none);
  CHECK(at(0.041) == ContactEvent::broken);
  CHECK(at(0.045) == ContactEvent::none);
  CHECK(at(0.030) == ContactEvent::made);
  contact.begin(kSphere, Eigen::Vector3d::UnitX());
  CHECK(at(0.030) == ContactEvent::made);
}

TEST_CASE("at the centre the last normal is kept") {
  SphereContact contact;
  contact.begin(kSphere, Eigen::Vector3d::UnitZ());
  CHECK(contact.update(kSphere.centre_m).normal == Eigen::Vector3d::UnitZ());
  CHECK(contact.contact().penetration_m == kSphere.radius_m);
  (void)contact.update(kSphere.centre_m + 0.01 * Eigen::Vector3d::UnitY());
  CHECK(contact.update(kSphere.centre_m).normal == Eigen::Vector3d::UnitY());
}
