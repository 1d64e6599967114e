// The 3RRS kinematics and statics against an independent numpy model (rrs3_reference.json), against finite differences,
// and against what the geometry of Chinello et al. 2017 must be able to do.
#include "devices/rrs3/rrs3_kinematics.h"

#include <cmath>
#include <fstream>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "devices/rrs3/rrs3_statics.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/rrs3/rrs3_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;
using nlohmann::json;

namespace {

json reference() {
  std::ifstream file(source_path("tests/devices/rrs3_reference.json"));
  return json::parse(file);
}

Eigen::MatrixXd matrix_of(const json& rows) {
  Eigen::MatrixXd m(rows.size(), rows[0].size());
  for (Eigen::Index r = 0; r < m.rows(); ++r)
    for (Eigen::Index c = 0; c < m.cols(); ++c)
      m(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return m;
}

Eigen::VectorXd vector_of(const json& values) {
  Eigen::VectorXd v(values.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = values[static_cast<std::size_t>(i)];
  return v;
}

// Relative to the largest element: single ones may be zero.
void check_near(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& theirs, double relative) {
  REQUIRE(ours.rows() == theirs.rows());
  REQUIRE(ours.cols() == theirs.cols());
  CHECK((ours - theirs).cwiseAbs().maxCoeff() <= relative * theirs.cwiseAbs().maxCoeff() + 1e-15);
}

Rrs3Coordinates pose_of(const json& xi) {
  return {.pz_m = xi.at("pz"), .roll_rad = xi.at("roll"), .pitch_rad = xi.at("pitch")};
}

// A pose in the middle of the limits, where all finite differences stay reachable.
Rrs3Coordinates some_pose() {
  const auto share = [] { return *rc::gen::inRange(-1000, 1001) / 1000.0; };
  return {.pz_m = -0.020 + 0.004 * share(), .roll_rad = 0.5 * share(), .pitch_rad = 0.4 * share()};
}

Rrs3Coordinates moved(const Rrs3Coordinates& at, int coordinate, double step) {
  Rrs3Coordinates to = at;
  (coordinate == 0 ? to.pz_m : coordinate == 1 ? to.roll_rad : to.pitch_rad) += step;
  return to;
}

}  // namespace

TEST_CASE("kinematics and statics agree with the independent model") {
  const json vectors = reference().at("vectors");
  REQUIRE(vectors.size() == 8);
  for (const json& entry : vectors) {
    INFO("vector " << entry.at("id"));
    const json& g = entry.at("geometry");
    const json& out = entry.at("out");
    const Rrs3Kinematics device({.a_m = g.at("a"),
                                 .b_m = g.at("b"),
                                 .bh_m = g.at("bh"),
                                 .bd_m = g.at("bd"),
                                 .l1_m = g.at("l1"),
                                 .l2_m = g.at("l2"),
                                 .rest_z_m = g.at("pz0")});
    const Rrs3Coordinates xi = pose_of(entry.at("xi"));
    const auto at = device.configuration(xi);
    REQUIRE(at);
    CHECK(yaw_of(*at) == Approx(out.at("yaw").get<double>()).epsilon(1e-9).margin(1e-15));
    check_near(at->position, vector_of(out.at("p")), 1e-9);
    check_near(at->platform_joints.transpose(), matrix_of(out.at("B")), 1e-9);
    check_near(at->elbows.transpose(), matrix_of(out.at("D")), 1e-9);
    check_near(device.joint_angles(*at), vector_of(out.at("q")), 1e-9);
    const auto rates = device.differential(*at);
    REQUIRE(rates);
    check_near(rates->h, matrix_of(out.at("H")), 1e-9);
    check_near(rates->j, matrix_of(out.at("J_chi")), 1e-9);
    check_near(rates->j * Rrs3Kinematics::rate_map(*at, xi.pitch_rad), matrix_of(out.at("J_xi")), 1e-9);
    check_near(joint_torques(*rates, Wrench(vector_of(entry.at("w")))), vector_of(out.at("tau")), 1e-9);
    check_near(joint_stiffness(*rates, entry.at("kS"), entry.at("Kphi")), matrix_of(out.at("Kq")), 1e-9);
    CHECK(device.condition_number(rates->j) == Approx(out.at("cond_scaled_b").get<double>()).epsilon(1e-9));
    CHECK(std::abs(rates->det_u) == Approx(std::abs(out.at("detUx").get<double>())).epsilon(1e-9));
  }
}

TEST_CASE("unreachable poses are empty, not numbers") {
  const Rrs3Kinematics device = default_device();
  const json unreachable = reference().at("unreachable_for_default_geometry");
  REQUIRE(unreachable.size() == 1);
  for (const json& entry : unreachable) CHECK_FALSE(device.configuration(pose_of(entry.at("xi"))));
  CHECK_FALSE(device.configuration({.pz_m = -0.02, .roll_rad = 100 * kDegree}));
  CHECK_FALSE(device.configuration({.pz_m = std::nan("")}));
  CHECK_FALSE(device.configuration({.pz_m = -0.02, .roll_rad = std::nan("")}));
}

TEST_CASE("a geometry without lengths is refused") {
  CHECK_THROWS_AS(Rrs3Kinematics(Rrs3Geometry{}), InputError);
}

TEST_CASE("parasitic yaw and shift at the corner of the limits") {
  const auto at = default_device().configuration({.pz_m = -0.02, .roll_rad = 36 * kDegree, .pitch_rad = 30 * kDegree});
  REQUIRE(at);
  // Independent numpy model.
  CHECK(yaw_of(*at) / kDegree == Approx(9.9515).margin(5e-5));
  CHECK(at->position.x() * 1e3 == Approx(0.0268).margin(5e-5));
  CHECK(at->position.y() * 1e3 == Approx(-1.4966).margin(5e-5));
}

TEST_CASE("platform joints stay in their legs' planes (5), also for geometries where the printed yaw fails") {
  REQUIRE(rc::check("constraint (5)", [] {
    const auto share = [] { return *rc::gen::inRange(0, 1001) / 1000.0; };
    Rrs3Geometry geometry = geometry_of(rrs3_spec());
    geometry.b_m = 0.008 + 0.006 * share();
    geometry.bh_m = 0.003 + 0.004 * share();
    geometry.bd_m = 0.012 + 0.010 * share();
    const auto at = Rrs3Kinematics(geometry).configuration(some_pose());
    RC_PRE(at.has_value());
    const Eigen::Matrix3d& b = at->platform_joints;
    const double slope = 2 * geometry.bh_m / geometry.bd_m;
    RC_ASSERT(std::abs(b(1, 0)) < 1e-12);
    RC_ASSERT(std::abs(b(0, 1) - slope * b(1, 1)) < 1e-12);
    RC_ASSERT(std::abs(b(0, 2) + slope * b(1, 2)) < 1e-12);
  }));
}

TEST_CASE("the links keep their lengths and the elbows point outward") {
  REQUIRE(rc::check("triangles", [] {
    const Rrs3Kinematics device = default_device();
    const auto at = device.configuration(some_pose());
    RC_PRE(at.has_value());
    const Eigen::Vector3d q = device.joint_angles(*at);
    for (int leg = 0; leg < 3; ++leg) {
      RC_ASSERT(std::abs(at->link.col(leg).norm() - 0.012) < 1e-12);
      RC_ASSERT(std::abs((at->platform_joints.col(leg) - at->elbows.col(leg)).norm() - 0.020) < 1e-12);
      RC_ASSERT(std::abs(0.012 * std::cos(q[leg]) - at->link(0, leg)) < 1e-12);
      RC_ASSERT(std::abs(0.012 * std::sin(q[leg]) - at->link(1, leg)) < 1e-12);
    }
  }));
}

TEST_CASE("J Brate is the derivative of the inverse kinematics") {
  REQUIRE(rc::check("central differences", [] {
    const Rrs3Kinematics device = default_device();
    const Rrs3Coordinates xi = some_pose();
    const auto at = device.configuration(xi);
    RC_PRE(at.has_value());
    const Eigen::Matrix3d exact = device.differential(*at)->j * Rrs3Kinematics::rate_map(*at, xi.pitch_rad);
    for (int coordinate = 0; coordinate < 3; ++coordinate) {
      const double step = coordinate == 0 ? 1e-7 : 1e-6;
      const auto above = device.configuration(moved(xi, coordinate, step));
      const auto below = device.configuration(moved(xi, coordinate, -step));
      const Eigen::Vector3d measured = (device.joint_angles(*above) - device.joint_angles(*below)) / (2 * step);
      RC_ASSERT((measured - exact.col(coordinate)).norm() < 1e-6 * exact.col(coordinate).norm());
    }
  }));
}

TEST_CASE("torques and wrench do the same work in every motion") {
  REQUIRE(rc::check("virtual work", [] {
    const Rrs3Kinematics device = default_device();
    const auto at = device.configuration(some_pose());
    RC_PRE(at.has_value());
    const auto rates = device.differential(*at);
    Wrench wrench;
    Eigen::Vector3d chi;
    for (double& value : wrench) value = *rc::gen::inRange(-1000, 1001) / 1000.0;
    for (double& value : chi) value = *rc::gen::inRange(-1000, 1001) / 1000.0;
    const Eigen::Vector3d torques = joint_torques(*rates, wrench);
    const double outside = wrench.dot(rates->h * chi), inside = torques.dot(rates->j * chi);
    RC_ASSERT(std::abs(outside - inside) <= 1e-8 * (1 + std::abs(outside)));
    RC_ASSERT((rates->j.transpose() * torques - rates->h.transpose() * wrench).norm() < 1e-10);
  }));
}

TEST_CASE("a force along a direction comes back from its torques") {
  REQUIRE(rc::check("force_along", [] {
    const Rrs3Kinematics device = default_device();
    const auto at = device.configuration(some_pose());
    RC_PRE(at.has_value());
    const auto rates = device.differential(*at);
    const Eigen::Vector3d normal = Eigen::Vector3d(0.2, -0.3, 1).normalized();
    Wrench wrench = Wrench::Zero();
    wrench.head<3>() = 3.5 * normal;
    RC_ASSERT(std::abs(force_along(*rates, joint_torques(*rates, wrench), normal) - 3.5) < 1e-9);
  }));
}

TEST_CASE("joint stiffness (35) is the derivative of the torques where the wrench is zero") {
  const Rrs3Kinematics device = default_device();
  const Rrs3Coordinates xi{.pz_m = -0.0185, .roll_rad = 0.21, .pitch_rad = -0.13};
  const auto at = device.configuration(xi);
  const auto rates = device.differential(*at);
  const Eigen::Matrix3d stiffness = joint_stiffness(*rates, 700, 0.7);
  Wrench kd;
  kd << 700, 700, 700, 0.7, 0.7, 0.7;
  // The torque that a displaced platform asks for: tau = J^-T H^T Kd [pd - p; rotvec(Rd R^T)].
  const auto torque_at = [&](const Rrs3Coordinates& to) {
    const auto there = device.configuration(to);
    const Eigen::AngleAxisd turn(there->rotation * at->rotation.transpose());
    Wrench displacement;
    displacement << there->position - at->position, turn.angle() * turn.axis();
    return joint_torques(*device.differential(*there), Wrench(kd.asDiagonal() * displacement));
  };
  Eigen::Matrix3d joint_steps, torque_steps;
  for (int coordinate = 0; coordinate < 3; ++coordinate) {
    const double step = coordinate == 0 ? 1e-7 : 1e-5;
    const Rrs3Coordinates up = moved(xi, coordinate, step), down = moved(xi, coordinate, -step);
    joint_steps.col(coordinate) =
        device.joint_angles(*device.configuration(up)) - device.joint_angles(*device.configuration(down));
    torque_steps.col(coordinate) = torque_at(up) - torque_at(down);
  }
  check_near(torque_steps * joint_steps.inverse(), stiffness, 1e-6);
}

TEST_CASE("the default geometry reaches the published limits") {
  const Rrs3Kinematics device = default_device();
  const DeviceSpec spec = rrs3_spec();
  const auto conditioned = [&](const Rrs3Coordinates& xi) {
    const auto at = device.configuration(xi);
    if (!at) return 1e9;
    const auto rates = device.differential(*at);
    return rates ? device.condition_number(rates->j) : 1e9;
  };
  for (int i = -50; i <= 50; ++i) {
    const double share = i / 50.0;
    CHECK(conditioned({.pz_m = spec.rest_z_m + share * spec.stroke_m / 2}) <= 2.5);
    CHECK(conditioned({.pz_m = spec.rest_z_m, .roll_rad = share * spec.max_roll_rad}) <= 2.5);
    CHECK(conditioned({.pz_m = spec.rest_z_m, .pitch_rad = share * spec.max_pitch_rad}) <= 2.5);
  }
  int reachable = 0;
  for (int z = 0; z < 31; ++z)
    for (int r = 0; r < 25; ++r)
      for (int p = 0; p < 25; ++p)
        reachable += device
                         .configuration({.pz_m = spec.rest_z_m + (z / 30.0 - 0.5) * spec.stroke_m,
                                         .roll_rad = (r / 12.0 - 1) * spec.max_roll_rad,
                                         .pitch_rad = (p / 12.0 - 1) * spec.max_pitch_rad})
                         .has_value();
  CHECK(100.0 * reachable / (31 * 25 * 25) == Approx(96.3).margin(0.5));
}

TEST_CASE("the angle of a folded leg does not turn round by rounding") {
  const Rrs3Kinematics device = default_device();
  int folded = 0;
  for (int r = -30; r <= 30; ++r) {
    for (int p = -30; p <= 30; ++p) {
      const double roll = 0.02 * r, pitch = 0.017 * p;
      // The highest pose that the legs reach, to the last bit: one of them is folded there.
      double within = -0.020, beyond = 0;
      if (!device.configuration({within, roll, pitch})) continue;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = (within + beyond) / 2;
        (device.configuration({middle, roll, pitch}) ? within : beyond) = middle;
      }
      const auto at = device.configuration({within, roll, pitch});
      REQUIRE(at);
      ++folded;
      REQUIRE(device.joint_angles(*at).minCoeff() > -std::numbers::pi);  // alpha, above -pi, and delta, 0 to pi
    }
  }
  CHECK(folded > 3000);
}

TEST_CASE("singularities lie where the independent model finds them") {
  const Rrs3Kinematics device = default_device();
  // Serial: a leg stretched or folded. Reachable just inside, not just outside.
  CHECK(device.configuration({.pz_m = -0.031748}));
  CHECK_FALSE(device.configuration({.pz_m = -0.031750}));
  CHECK(device.configuration({.pz_m = -0.006929}));
  CHECK_FALSE(device.configuration({.pz_m = -0.006927}));
  // Parallel, at the rest height: det J changes sign, the platform moves while the joints stand.
  const auto det = [&](double pz, double roll, double pitch) {
    const auto at = device.configuration({.pz_m = pz, .roll_rad = roll * kDegree, .pitch_rad = pitch * kDegree});
    const auto rates = at ? device.differential(*at) : std::nullopt;
    return rates ? rates->j.determinant() : std::nan("");
  };
  CHECK(det(-0.02, 58.9, 0) * det(-0.02, 59.1, 0) < 0);
  CHECK(det(-0.02, 0, -49.5) * det(-0.02, 0, -49.75) < 0);  // the independent model scanned quarter degrees
  // None in the box of limits.
  const double sign = det(-0.02, 0, 0);
  int reachable = 0;
  for (double pz = -0.0275; pz < -0.0124; pz += 0.0015) {
    for (int roll = -36; roll <= 36; roll += 4) {
      for (int pitch = -30; pitch <= 30; pitch += 3) {
        if (!device.configuration({.pz_m = pz, .roll_rad = roll * kDegree, .pitch_rad = pitch * kDegree})) continue;
        ++reachable;
        CHECK(det(pz, roll, pitch) * sign > 0);
      }
    }
  }
  CHECK(reachable > 4000);
}
