// What the firmware makes of a force in each mode, against the C++ model's mathematics at the same pose: the laws of
// devices/rrs3/rrs3_device.cpp.
#include <algorithm>
#include <cmath>

#include <rapidcheck.h>

#include "devices/hid/firmware/jnd_forward.h"
#include "devices/rrs3/rrs3_position_control.h"
#include "devices/rrs3/rrs3_statics.h"
#include "tests/catch.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

double render_share() {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-100000, 100001)) / 100000.0;
}

// A pose where the C++ model has everything that it needs, and the firmware's own idea of it.
struct Scene {
  Rrs3Kinematics model;
  jnd_linkage linkage;
  Rrs3Configuration at;
  Rrs3Differential rates;
  jnd_here here;
};

std::optional<Scene> scene_at(const Rrs3Coordinates& xi) {
  const jnd_geometry geometry = jnd_fingertip_default_config("TEST-1", JND_INDEX).geometry;
  Scene scene{.model = model_of(geometry), .linkage = jnd_linkage_of(&geometry), .at = {}, .rates = {}, .here = {}};
  const auto at = scene.model.configuration(xi);
  const auto rates = at ? scene.model.differential(*at) : std::nullopt;
  if (!rates) return std::nullopt;
  scene.at = *at;
  scene.rates = *rates;
  const Eigen::Vector3d q = scene.model.joint_angles(*at);
  const float joints[3] = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
  scene.here.xi = {static_cast<float>(xi.pz_m), static_cast<float>(xi.roll_rad), static_cast<float>(xi.pitch_rad)};
  if (!jnd_forward(&scene.linkage, joints, &scene.here.xi, &scene.here.configuration, &scene.here.differential))
    return std::nullopt;
  return scene;
}

struct Drawn {
  Rrs3Coordinates xi;
  jnd_target target;
  Eigen::Vector3d normal;
};

Drawn some_target(jnd_mode mode) {
  Drawn drawn;
  drawn.xi = {
      .pz_m = -0.0195 + 0.004 * render_share(), .roll_rad = 0.5 * render_share(), .pitch_rad = 0.4 * render_share()};
  drawn.normal = Eigen::Vector3d(0.5 * render_share(), 0.5 * render_share(), 1).normalized();
  drawn.target.mode = mode;
  drawn.target.force_n = static_cast<float>(2.36 + 2.34 * render_share());
  for (int i = 0; i < 3; ++i) drawn.target.normal[i] = static_cast<float>(drawn.normal[i]);
  drawn.target.stiffness_n_per_m = static_cast<float>(1010 + 990 * render_share());
  drawn.target.roll_rad = static_cast<float>(drawn.xi.roll_rad + 0.1 * render_share());
  drawn.target.pitch_rad = static_cast<float>(drawn.xi.pitch_rad + 0.1 * render_share());
  drawn.target.most_pull_n = drawn.target.most_moment_n_m = 1000;
  return drawn;
}

Eigen::Vector3d torques_of(const jnd_actuation& actuation) {
  return {actuation.torque_n_m[0], actuation.torque_n_m[1], actuation.torque_n_m[2]};
}

double off(const Eigen::Vector3d& ours, const Eigen::Vector3d& theirs) {
  return (ours - theirs).cwiseAbs().maxCoeff() / theirs.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("firmware: mode wrench gives the model's torques, and never more than the force") {
  double worst = 0;
  REQUIRE(rc::check("wrench", [&] {
    const Drawn drawn = some_target(JND_MODE_WRENCH);
    const auto scene = scene_at(drawn.xi);
    RC_PRE(scene.has_value());
    jnd_actuation given{};
    jnd_render(&scene->linkage, &scene->here, &drawn.target, &given);
    const Eigen::Vector3d normal = scene->at.rotation.col(2);
    Wrench wrench = Wrench::Zero();
    wrench.head<3>() = drawn.target.force_n * std::min(1.0, normal.z() / drawn.normal.z()) * drawn.normal;
    worst = std::max(worst, off(torques_of(given), joint_torques(scene->rates, wrench)));
    RC_ASSERT(off(torques_of(given), joint_torques(scene->rates, wrench)) < 1e-4);
    const double force = force_along(scene->rates, torques_of(given), normal);
    RC_ASSERT(force <= drawn.target.force_n * (1 + 1e-5));
    RC_ASSERT(force > 0);
    RC_ASSERT(given.hold_n_per_m == 0);
  }));
  INFO("worst relative difference " << worst);
  CHECK(worst > 0);
}

TEST_CASE("firmware: mode pd sends the platform where the model sends it") {
  double worst = 0;
  REQUIRE(rc::check("pd", [&] {
    const Drawn drawn = some_target(JND_MODE_PD);
    const auto scene = scene_at(drawn.xi);
    RC_PRE(scene.has_value());
    jnd_actuation given{};
    jnd_render(&scene->linkage, &scene->here, &drawn.target, &given);
    const double stiffness = drawn.target.stiffness_n_per_m, displacement = drawn.target.force_n / stiffness;
    const auto desired = scene->model.pose(
        pressed_by(scene->model.geometry(), displacement, drawn.target.roll_rad, drawn.target.pitch_rad));
    RC_PRE(desired.has_value());
    const Eigen::Vector3d expected = joint_torques(
        scene->rates, position_wrench(scene->at, *desired, stiffness, static_cast<double>(drawn.target.force_n)));
    const double scale = std::max(0.002, expected.cwiseAbs().maxCoeff());
    const double apart = (torques_of(given) - expected).cwiseAbs().maxCoeff() / scale;
    worst = std::max(worst, apart);
    RC_ASSERT(apart < 5e-4);  // of a torque that a tenth of the force needs: 20 nm of the pose count
    RC_ASSERT(given.hold_n_per_m == drawn.target.stiffness_n_per_m);
    RC_ASSERT(force_along(scene->rates, torques_of(given), scene->at.rotation.col(2)) <=
              drawn.target.force_n * (1 + 1e-4) + 1e-5);
  }));
  INFO("worst difference " << worst);
  CHECK(worst > 0);
}

TEST_CASE("firmware: mode pd_literal follows (36) in the joints") {
  double worst = 0;
  REQUIRE(rc::check("pd_literal", [&] {
    const Drawn drawn = some_target(JND_MODE_PD_LITERAL);
    const auto scene = scene_at(drawn.xi);
    RC_PRE(scene.has_value());
    jnd_actuation given{};
    jnd_render(&scene->linkage, &scene->here, &drawn.target, &given);
    const double stiffness = drawn.target.stiffness_n_per_m, displacement = drawn.target.force_n / stiffness;
    const auto joints = reachable_joints(scene->model, displacement, drawn.target.roll_rad, drawn.target.pitch_rad);
    RC_PRE(joints.has_value());
    Eigen::Vector3d expected =
        joint_space_torques(scene->rates, *joints - scene->model.joint_angles(scene->at), stiffness);
    const double force = force_along(scene->rates, expected, scene->at.rotation.col(2));
    if (force > drawn.target.force_n) expected *= drawn.target.force_n / force;
    const double scale = std::max(0.002, expected.cwiseAbs().maxCoeff());
    const double apart = (torques_of(given) - expected).cwiseAbs().maxCoeff() / scale;
    // At its end a leg's angle changes with the square root of the height: there the search's own micrometre counts.
    const bool within_reach = scene->model
                                  .configuration(pressed_by(scene->model.geometry(), displacement,
                                                            drawn.target.roll_rad, drawn.target.pitch_rad))
                                  .has_value();
    RC_ASSERT(apart < (within_reach ? 2e-3 : 0.05));
    if (within_reach) worst = std::max(worst, apart);
    RC_ASSERT(given.hold_n_per_m == drawn.target.stiffness_n_per_m);
    RC_ASSERT(force_along(scene->rates, torques_of(given), scene->at.rotation.col(2)) <=
              drawn.target.force_n * (1 + 1e-4) + 1e-5);
  }));
  INFO("worst difference " << worst);
  CHECK(worst > 0);
}

TEST_CASE("firmware: a contact without a stiffness is rendered as a wrench in every mode") {
  const auto scene = scene_at({.pz_m = -0.019});
  REQUIRE(scene);
  for (const jnd_mode mode : {JND_MODE_PD, JND_MODE_PD_LITERAL}) {
    jnd_target target{};
    target.mode = mode;
    target.force_n = 2;
    target.normal[2] = 1;
    target.stiffness_n_per_m = 0.9F;
    target.most_pull_n = 5;
    jnd_actuation given{};
    jnd_render(&scene->linkage, &scene->here, &target, &given);
    CHECK(given.hold_n_per_m == 0);
    CHECK(force_along(scene->rates, torques_of(given), {0, 0, 1}) == Approx(2).epsilon(1e-4));
  }
}

TEST_CASE("firmware: a platform that lies far too deep is drawn back no harder than it may press") {
  const auto scene = scene_at({.pz_m = -0.0135});
  REQUIRE(scene);
  for (const jnd_mode mode : {JND_MODE_PD, JND_MODE_PD_LITERAL}) {
    jnd_target target{};
    target.mode = mode;
    target.force_n = 0.1F;
    target.normal[2] = 1;
    target.stiffness_n_per_m = 2000;
    target.most_pull_n = 4.7F;
    target.most_moment_n_m = 1;
    jnd_actuation given{};
    jnd_render(&scene->linkage, &scene->here, &target, &given);
    CHECK(force_along(scene->rates, torques_of(given), {0, 0, 1}) == Approx(-4.7).epsilon(1e-4));
  }
}

TEST_CASE("firmware: the moment that turns a platform is bounded, and leaves the force as it is") {
  const auto scene = scene_at({.pz_m = -0.0195, .roll_rad = 0.3, .pitch_rad = -0.2});
  REQUIRE(scene);
  for (const jnd_mode mode : {JND_MODE_PD, JND_MODE_PD_LITERAL}) {
    jnd_target target{};
    target.mode = mode;
    target.force_n = 1.5F;
    target.normal[2] = 1;
    target.stiffness_n_per_m = 1500;
    target.roll_rad = -0.3F;
    target.pitch_rad = 0.2F;
    target.most_pull_n = 1000;
    double forces[2], moments[2];
    for (const int bounded : {0, 1}) {
      target.most_moment_n_m = bounded == 1 ? 0.04F : 1000;
      jnd_actuation given{};
      jnd_render(&scene->linkage, &scene->here, &target, &given);
      forces[bounded] = force_along(scene->rates, torques_of(given), scene->at.rotation.col(2));
      moments[bounded] = (scene->rates.j.transpose() * torques_of(given)).tail<2>().norm();
    }
    CHECK(forces[1] == Approx(forces[0]).epsilon(1e-3));
    CHECK(moments[0] > 0.3);
    CHECK(moments[1] < 0.06);
  }
}

TEST_CASE("firmware: the joints of a tilt out of reach are those where the platform is") {
  const auto scene = scene_at({.pz_m = -0.0275});
  REQUIRE(scene);
  float joints[3];
  CHECK(jnd_tilted_joints(&scene->linkage, &scene->here, 0.05F, 0, joints));
  CHECK_FALSE(jnd_tilted_joints(&scene->linkage, &scene->here, 0.6283F, 0.5236F, joints));
  const Eigen::Vector3d present = scene->model.joint_angles(scene->at);
  for (int leg = 0; leg < 3; ++leg) CHECK(joints[leg] == Approx(present[leg]).margin(1e-6));
}
