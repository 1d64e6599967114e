// The firmware's kinematics and statics, in single precision, against the C++ model in double precision over the whole
// box of limits, and against finite differences and virtual work of their own.
#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <rapidcheck.h>

#include "devices/hid/firmware/jnd_forward.h"
#include "devices/hid/firmware/jnd_position.h"
#include "devices/hid/firmware/jnd_statics.h"
#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_position_control.h"
#include "devices/rrs3/rrs3_statics.h"
#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

jnd_geometry shipped_geometry() {
  return jnd_fingertip_default_config("TEST-1", JND_FINGER_ANY).geometry;
}

jnd_coordinates single(const Rrs3Coordinates& xi) {
  return {static_cast<float>(xi.pz_m), static_cast<float>(xi.roll_rad), static_cast<float>(xi.pitch_rad)};
}
// What the single-precision coordinates really are.
Rrs3Coordinates rounded(const Rrs3Coordinates& xi) {
  const jnd_coordinates to = single(xi);
  return {.pz_m = to.pz_m, .roll_rad = to.roll_rad, .pitch_rad = to.pitch_rad};
}

template <int kRows>
Eigen::Matrix<double, kRows, 3> matrix_of(const float (&rows)[kRows][3]) {
  Eigen::Matrix<double, kRows, 3> m;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < 3; ++c) m(r, c) = rows[r][c];
  return m;
}
Eigen::Vector3d vector_of(const float (&values)[3]) {
  return {values[0], values[1], values[2]};
}

template <typename A, typename B>
double off(const A& ours, const B& theirs) {
  return (ours - theirs).cwiseAbs().maxCoeff() / theirs.cwiseAbs().maxCoeff();
}

// The smallest |sine| between the links of a leg: 0 where one is stretched or folded.
double bend(const Rrs3Configuration& at) {
  double least = 1;
  for (int leg = 0; leg < 3; ++leg) {
    const Eigen::Vector2d link = at.link.col(leg), distal = at.knee.col(leg) - at.link.col(leg);
    least = std::min(least, std::abs(link.x() * distal.y() - link.y() * distal.x()) / (link.norm() * distal.norm()));
  }
  return least;
}

// Every pose of a grid over the limits, and a little beyond.
template <typename Visit>
void over_the_box(Visit visit) {
  for (int z = -1; z <= 31; ++z)
    for (int r = -13; r <= 13; ++r)
      for (int p = -13; p <= 13; ++p)
        visit(rounded({.pz_m = -0.0275 + 0.015 * z / 30, .roll_rad = 0.6283 * r / 12, .pitch_rad = 0.5236 * p / 12}));
}

double share() {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-100000, 100001)) / 100000.0;
}
Rrs3Coordinates some_pose() {
  return rounded({.pz_m = -0.020 + 0.0075 * share(), .roll_rad = 0.62 * share(), .pitch_rad = 0.52 * share()});
}

}  // namespace

TEST_CASE("firmware: kinematics and statics agree with the model over the whole box of limits") {
  const jnd_linkage linkage = [] {
    const jnd_geometry geometry = shipped_geometry();
    return jnd_linkage_of(&geometry);
  }();
  const Rrs3Kinematics model = model_of(shipped_geometry());
  int reachable = 0, near_stretch = 0, undecided = 0;
  double angles = 0, position = 0, h = 0, j = 0, torques = 0, force = 0, stiffness = 0;
  double angles_everywhere = 0;
  over_the_box([&](const Rrs3Coordinates& xi) {
    const jnd_coordinates to = single(xi);
    jnd_configuration at{};
    const bool reached = jnd_configuration_at(&linkage, &to, &at);
    const auto theirs = model.configuration(xi);
    if (reached != theirs.has_value()) {
      ++undecided;  // the edge of reach, to rounding
      return;
    }
    if (!reached) return;
    ++reachable;
    float q[3];
    jnd_joint_angles(&at, q);
    const double apart = (vector_of(q) - model.joint_angles(*theirs)).cwiseAbs().maxCoeff();
    angles_everywhere = std::max(angles_everywhere, apart);
    if (bend(*theirs) < 0.1) {
      ++near_stretch;
      return;
    }
    jnd_differential rates{};
    REQUIRE(jnd_differential_at(&linkage, &at, &rates));
    const auto exact = model.differential(*theirs);
    REQUIRE(exact);
    angles = std::max(angles, apart);
    position = std::max(position, (vector_of(at.platform.position) - theirs->position).cwiseAbs().maxCoeff());
    h = std::max(h, off(matrix_of(rates.h), exact->h));
    j = std::max(j, off(matrix_of(rates.j), exact->j));
    const float wrench[6] = {0.7F, -0.4F, 3.1F, 0.002F, -0.004F, 0.001F};
    Wrench same;
    for (int i = 0; i < 6; ++i) same[i] = wrench[i];
    float tau[3];
    jnd_joint_torques(&rates, wrench, tau);
    torques = std::max(torques, off(vector_of(tau), joint_torques(*exact, same)));
    force = std::max(force, std::abs(jnd_force_along(&rates, tau, jnd_normal_z(&at.platform)) -
                                     force_along(*exact, joint_torques(*exact, same), theirs->rotation.col(2))));
    const float error[3] = {0.01F, -0.02F, 0.015F};
    jnd_stiffness_torques(&rates, 900, 0.9F, 1000, error, tau);
    stiffness = std::max(stiffness, off(vector_of(tau), joint_space_torques(*exact, vector_of(error), 900)));
  });
  INFO("of " << reachable << " reachable poses " << near_stretch << " have a leg within 6 degrees of its end and "
             << undecided << " more lie on the edge of reach; worst elsewhere: angles " << angles << " rad, position "
             << position << " m, relative H " << h << ", J " << j << ", torques " << torques << ", stiffness "
             << stiffness << ", force " << force << " N; angles everywhere " << angles_everywhere << " rad");
  CHECK(reachable > 20000);
  CHECK(near_stretch < reachable / 50);
  CHECK(undecided < 20);
  CHECK(angles < 1e-5);
  CHECK(angles_everywhere < 1e-4);
  CHECK(position < 1e-8);
  CHECK(h < 1e-5);
  CHECK(j < 1e-4);
  CHECK(torques < 1e-4);
  CHECK(stiffness < 1e-4);
  CHECK(force < 1e-4);
}

TEST_CASE("firmware: J is the derivative of the inverse kinematics by finite differences of the firmware's own") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  double worst = 0;
  REQUIRE(rc::check("central differences", [&] {
    const Rrs3Coordinates xi = some_pose();
    const jnd_coordinates to = single(xi);
    jnd_configuration at{};
    RC_PRE(jnd_configuration_at(&linkage, &to, &at));
    jnd_differential rates{};
    RC_PRE(jnd_differential_at(&linkage, &at, &rates));
    // chi = Brate xi': the rates of roll and pitch turn about axes that the yaw and the pitch have turned.
    const double cp = std::cos(xi.pitch_rad), cy = at.platform.cos_yaw, sy = at.platform.sin_yaw;
    const Eigen::Matrix3d brate = (Eigen::Matrix3d() << 1, 0, 0, 0, cy * cp, -sy, 0, sy * cp, cy).finished();
    const Eigen::Matrix3d exact = matrix_of(rates.j) * brate;
    for (int coordinate = 0; coordinate < 3; ++coordinate) {
      // Wide steps: single precision resolves 1e-7 of an angle. The curvature costs the square of the step.
      const float step = coordinate == 0 ? 4e-5F : 4e-3F;
      float q[2][3];
      float distance = 0;
      for (int side = 0; side < 2; ++side) {
        jnd_coordinates beside = to;
        float& changed = coordinate == 0 ? beside.pz_m : coordinate == 1 ? beside.roll_rad : beside.pitch_rad;
        changed += side == 0 ? -step : step;
        distance += side == 0 ? -changed : changed;
        jnd_configuration there{};
        RC_PRE(jnd_configuration_at(&linkage, &beside, &there));
        jnd_joint_angles(&there, q[side]);
      }
      const Eigen::Vector3d measured = (vector_of(q[1]) - vector_of(q[0])) / distance;
      // Within 17 degrees of a leg's end the inverse kinematics bend too much for such steps.
      const auto theirs = model_of(geometry).configuration(xi);
      RC_PRE(theirs && bend(*theirs) > 0.3);
      const double apart = (measured - exact.col(coordinate)).norm() / exact.col(coordinate).norm();
      worst = std::max(worst, apart);
      RC_ASSERT(apart < 2e-3);
    }
  }));
  INFO("worst difference " << worst);
  CHECK(worst > 0);  // there were poses to look at
}

TEST_CASE("firmware: torques and wrench do the same work in every motion") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  REQUIRE(rc::check("virtual work", [&] {
    const jnd_coordinates to = single(some_pose());
    jnd_configuration at{};
    jnd_differential rates{};
    RC_PRE(jnd_configuration_at(&linkage, &to, &at) && jnd_differential_at(&linkage, &at, &rates));
    float wrench[6], tau[3];
    for (int i = 0; i < 6; ++i) wrench[i] = static_cast<float>(share() * (i < 3 ? 4 : 0.02));
    const Eigen::Vector3d chi(0.05 * share(), share(), share());
    jnd_joint_torques(&rates, wrench, tau);
    const Eigen::Matrix<double, 6, 1> twist = matrix_of(rates.h) * chi;
    const Eigen::Vector3d speeds = matrix_of(rates.j) * chi;
    double outside = 0, sum = 0;
    for (int i = 0; i < 6; ++i) {
      outside += wrench[i] * twist[i];
      sum += std::abs(wrench[i] * twist[i]);
    }
    const double inside = vector_of(tau).dot(speeds);
    sum += vector_of(tau).cwiseAbs().dot(speeds.cwiseAbs());
    RC_ASSERT(std::abs(outside - inside) <= 1e-5 * sum + 1e-12);
  }));
}

TEST_CASE("firmware: forward kinematics gives back every pose of the limits, from rest and from a neighbour") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  const Rrs3Kinematics model = model_of(geometry);
  int found = 0, missed = 0, missed_near = 0;
  double lift = 0, tilt = 0;
  over_the_box([&](const Rrs3Coordinates& xi) {
    const auto at = model.configuration(xi);
    if (!at || bend(*at) < 0.05) return;
    const Eigen::Vector3d q = model.joint_angles(*at);
    const float joints[3] = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
    jnd_coordinates from_rest{-0.02F, 0, 0};
    jnd_coordinates from_near = single(
        {.pz_m = xi.pz_m * 1.01, .roll_rad = xi.roll_rad * 0.97 + 0.005, .pitch_rad = xi.pitch_rad * 0.97 - 0.005});
    jnd_configuration configuration{};
    jnd_differential rates{};
    if (jnd_forward(&linkage, joints, &from_rest, &configuration, &rates)) {
      ++found;
      lift = std::max(lift, std::abs(from_rest.pz_m - xi.pz_m));
      tilt = std::max({tilt, std::abs(from_rest.roll_rad - xi.roll_rad), std::abs(from_rest.pitch_rad - xi.pitch_rad)});
    } else {
      ++missed;
    }
    const jnd_coordinates started = from_near;
    jnd_configuration there{};
    if (jnd_configuration_at(&linkage, &started, &there) &&
        !jnd_forward(&linkage, joints, &from_near, &configuration, &rates))
      ++missed_near;
  });
  INFO("found " << found << ", worst " << lift << " m and " << tilt << " rad");
  CHECK(found > 20000);
  CHECK(missed == 0);
  CHECK(missed_near == 0);
  CHECK(lift < 5e-8);
  CHECK(tilt < 2e-5);
}

TEST_CASE("firmware: joints that no pose has give nothing, and leave the last pose") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  const std::array<std::array<float, 3>, 5> none = {
      {{NAN, 0, 0}, {0, INFINITY, 0}, {1.5F, -1.5F, -1.5F}, {1e30F, 0, 0}, {0, 0, -3e38F}}};
  for (const auto& joints : none) {
    jnd_coordinates xi{-0.02F, 0.1F, 0};
    jnd_configuration configuration{};
    jnd_differential rates{};
    CHECK_FALSE(jnd_forward(&linkage, joints.data(), &xi, &configuration, &rates));
    CHECK(xi.pz_m == -0.02F);
    CHECK(xi.roll_rad == 0.1F);
  }
}

TEST_CASE("firmware: forward kinematics stays on its side of the parallel singularities, whatever the joints say") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  const Rrs3Kinematics model = model_of(geometry);
  const double side = model.differential(*model.configuration({.pz_m = -0.02}))->j.determinant();
  int found = 0;
  for (int a = -32; a <= 32; ++a) {
    for (int b = -32; b <= 32; ++b) {
      for (int c = -32; c <= 32; ++c) {
        const float joints[3] = {0.05F * static_cast<float>(a), 0.05F * static_cast<float>(b),
                                 0.05F * static_cast<float>(c)};
        jnd_coordinates xi{-0.02F, 0, 0};
        jnd_configuration configuration{};
        jnd_differential rates{};
        if (!jnd_forward(&linkage, joints, &xi, &configuration, &rates)) continue;
        ++found;
        float q[3];
        jnd_joint_angles(&configuration, q);
        for (int leg = 0; leg < 3; ++leg) REQUIRE(std::abs(q[leg] - joints[leg]) <= 3e-5F);
        REQUIRE(matrix_of(rates.j).determinant() * side > 0);
      }
    }
  }
  CHECK(found > 10000);
  // From beside a singularity to joints of poses beyond it, which have an assembly on this side too.
  int beside = 0;
  for (int start = 0; start < 40; ++start) {
    for (int end = 0; end < 40; ++end) {
      const auto beyond = model.configuration({.pz_m = -0.02, .roll_rad = 1.035 + 0.005 * end});
      if (!beyond) continue;
      const Eigen::Vector3d q = model.joint_angles(*beyond);
      const float joints[3] = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
      jnd_coordinates xi{-0.02F, 1.025F - 0.005F * static_cast<float>(start), 0};
      jnd_configuration configuration{};
      jnd_differential rates{};
      if (!jnd_forward(&linkage, joints, &xi, &configuration, &rates)) continue;
      ++beside;
      REQUIRE(matrix_of(rates.j).determinant() * side > 0);
    }
  }
  CHECK(beside > 0);
}

TEST_CASE("firmware: the angle of a folded leg does not turn round by rounding") {
  const jnd_geometry geometry = shipped_geometry();
  const jnd_linkage linkage = jnd_linkage_of(&geometry);
  const Rrs3Kinematics model = model_of(geometry);
  int folded = 0;
  for (int r = -30; r <= 30; ++r) {
    for (int p = -30; p <= 30; ++p) {
      // As deep as the legs reach: the search ends where one of them is folded.
      const double roll = 0.02 * r, pitch = 0.017 * p;
      float joints[3];
      const auto theirs = reachable_joints(model, 0.02, roll, pitch);
      if (!jnd_reachable_joints(&linkage, 0.02F, static_cast<float>(roll), static_cast<float>(pitch), joints) ||
          !theirs)
        continue;
      ++folded;
      // Of the fold itself each search tells a micrometre or so: some hundredths of a radian.
      REQUIRE((vector_of(joints) - *theirs).cwiseAbs().maxCoeff() < 0.1);
    }
  }
  CHECK(folded > 3000);
}
