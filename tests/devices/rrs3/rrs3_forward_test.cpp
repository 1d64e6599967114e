// Forward kinematics gives back the pose that the joint angles came from, and nothing where there is none.
#include <cmath>

#include <Eigen/LU>
#include <rapidcheck.h>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_workspace.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

double share() {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001)) / 1000.0;
}

// Largest difference of two poses, rad or radii b.
double apart(const Rrs3Coordinates& a, const Rrs3Coordinates& b, double radius) {
  return std::max(
      {std::abs(a.pz_m - b.pz_m) / radius, std::abs(a.roll_rad - b.roll_rad), std::abs(a.pitch_rad - b.pitch_rad)});
}

}  // namespace

TEST_CASE("every reachable pose of the limits is found from rest") {
  const Rrs3Kinematics kinematics(geometry_of(rrs3_spec()));
  const Rrs3Box box = box_of(rrs3_spec());
  const Rrs3Coordinates rest{.pz_m = kinematics.geometry().rest_z_m};
  int found = 0, missed = 0;
  double worst = 0;
  for (int z = 0; z <= 20; ++z) {
    for (int r = -9; r <= 9; ++r) {
      for (int p = -9; p <= 9; ++p) {
        const Rrs3Coordinates xi{.pz_m = box.lowest_m + (box.highest_m - box.lowest_m) * z / 20,
                                 .roll_rad = box.max_roll_rad * r / 9,
                                 .pitch_rad = box.max_pitch_rad * p / 9};
        const auto at = kinematics.configuration(xi);
        if (!at) continue;
        const auto back = forward_kinematics(kinematics, kinematics.joint_angles(*at), rest);
        ++(back ? found : missed);
        if (back) worst = std::max(worst, apart(*back, xi, 0.01));
      }
    }
  }
  CHECK(missed == 0);
  CHECK(found > 7000);
  CHECK(worst < 1e-10);
}

TEST_CASE("a pose is found from its neighbours, in any geometry that holds both") {
  REQUIRE(rc::check("round trip", [] {
    Rrs3Geometry geometry = geometry_of(rrs3_spec());
    for (double* length :
         {&geometry.a_m, &geometry.b_m, &geometry.bh_m, &geometry.bd_m, &geometry.l1_m, &geometry.l2_m})
      *length *= 1 + 0.2 * share();
    const Rrs3Kinematics kinematics(geometry);
    const Rrs3Coordinates xi{.pz_m = -0.02 + 0.0075 * share(), .roll_rad = 0.62 * share(), .pitch_rad = 0.52 * share()};
    const Rrs3Coordinates near{.pz_m = xi.pz_m + 0.0005 * share(),
                               .roll_rad = xi.roll_rad + 0.03 * share(),
                               .pitch_rad = xi.pitch_rad + 0.03 * share()};
    const auto at = kinematics.configuration(xi);
    const auto here = at ? kinematics.differential(*at) : std::nullopt;
    const auto from = kinematics.configuration(near);
    const auto there = from ? kinematics.differential(*from) : std::nullopt;
    // Beyond a parallel singularity the same joints have another assembly, which is rightly not crossed to.
    RC_PRE(here && there && kinematics.condition_number(here->j) < 20 && kinematics.condition_number(there->j) < 20);
    RC_PRE(here->j.determinant() * there->j.determinant() > 0);
    const Eigen::Vector3d q = kinematics.joint_angles(*at);
    const auto back = forward_kinematics(kinematics, q, near);
    RC_ASSERT(back.has_value());
    RC_ASSERT(apart(*back, xi, geometry.b_m) < 1e-10);
    RC_ASSERT((kinematics.joint_angles(*kinematics.configuration(*back)) - q).cwiseAbs().maxCoeff() <= 1e-12);
    // Whole turns of an encoder do not matter.
    const auto turned = forward_kinematics(kinematics, q + Eigen::Vector3d(2, -4, 6) * std::acos(-1.0), near);
    RC_ASSERT(turned && apart(*turned, xi, geometry.b_m) < 1e-9);
  }));
}

TEST_CASE("a path is tracked pose by pose") {
  const Rrs3Kinematics kinematics(geometry_of(rrs3_spec()));
  Rrs3Coordinates last{.pz_m = -0.02};
  for (int i = 0; i < 2000; ++i) {
    const double t = 0.001 * i;
    const Rrs3Coordinates xi{
        .pz_m = -0.02 + 0.003 * std::sin(5 * t), .roll_rad = 0.5 * std::sin(7 * t), .pitch_rad = 0.4 * std::sin(3 * t)};
    const auto back = forward_kinematics(kinematics, kinematics.joint_angles(*kinematics.configuration(xi)), last);
    REQUIRE(back);
    REQUIRE(apart(*back, xi, 0.01) < 1e-11);
    last = *back;
  }
}

TEST_CASE("joints that no pose has give nothing, and neither does a start that is none") {
  const Rrs3Kinematics kinematics(geometry_of(rrs3_spec()));
  const Rrs3Coordinates rest{.pz_m = -0.02};
  const Eigen::Vector3d q = kinematics.joint_angles(*kinematics.configuration(rest));
  CHECK(forward_kinematics(kinematics, q, rest));
  CHECK_FALSE(forward_kinematics(kinematics, {std::nan(""), 0, 0}, rest));
  CHECK_FALSE(forward_kinematics(kinematics, {q[0], INFINITY, q[2]}, rest));
  CHECK_FALSE(forward_kinematics(kinematics, q, {.pz_m = -0.034}));
  CHECK_FALSE(forward_kinematics(kinematics, q, {.pz_m = std::nan("")}));
  // One leg far up, two far down: the platform's sides cannot bridge it.
  CHECK_FALSE(forward_kinematics(kinematics, {1.5, -1.5, -1.5}, rest));
}

TEST_CASE("the answer stays on the starting pose's side of the parallel singularities") {
  const Rrs3Kinematics kinematics(geometry_of(rrs3_spec()));
  REQUIRE(rc::check("side", [&kinematics] {
    const Eigen::Vector3d q(1.6 * share(), 1.6 * share(), 1.6 * share());
    const Rrs3Coordinates rest{.pz_m = -0.02};
    const auto back = forward_kinematics(kinematics, q, rest);
    if (!back) return;
    const auto at = kinematics.configuration(*back), from = kinematics.configuration(rest);
    RC_ASSERT((kinematics.joint_angles(*at) - q).cwiseAbs().maxCoeff() < 1e-9);
    RC_ASSERT(kinematics.differential(*at)->j.determinant() * kinematics.differential(*from)->j.determinant() > 0);
  }));
}
