// The 3RRS model: forward kinematics, workspace, and geometries from JSON.
#include "devices/rrs3/rrs3_model.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include <Eigen/LU>
#include <nlohmann/json.hpp>
#include <rapidcheck.h>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_workspace.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/rrs3/rrs3_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;
using nlohmann::json;

namespace {

// The whole answer of the 3RRS model against an independent numpy model, and geometries from JSON.

void check_near(const Eigen::MatrixXd& ours, const json& theirs) {
  Eigen::MatrixXd m(ours.rows(), ours.cols());
  REQUIRE(theirs.size() == static_cast<std::size_t>(ours.rows()));
  for (Eigen::Index r = 0; r < ours.rows(); ++r)
    for (Eigen::Index c = 0; c < ours.cols(); ++c) {
      const json& row = theirs[static_cast<std::size_t>(r)];
      m(r, c) = row.is_array() ? row[static_cast<std::size_t>(c)].get<double>() : row.get<double>();
    }
  CHECK((ours - m).cwiseAbs().maxCoeff() <= 1e-9 * m.cwiseAbs().maxCoeff() + 1e-15);
}

Rrs3Geometry geometry_from(const std::string& text) {
  return rrs3_geometry_from_json(parse_json(text, "g.json"), "g.json");
}

std::string complaint(const std::string& text) {
  try {
    (void)geometry_from(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("every field of the model's answer agrees with the independent model to 1e-9") {
  std::ifstream file(source_path("tests/devices/rrs3_reference.json"));
  const json vectors = json::parse(file).at("vectors");
  REQUIRE(vectors.size() == 8);
  for (const json& entry : vectors) {
    INFO("vector " << entry.at("id"));
    const json& xi = entry.at("xi");
    const json& out = entry.at("out");
    Rrs3ModelQuery query{.geometry = geometry_from(entry.at("geometry").dump()),
                         .coordinates = {.pz_m = xi.at("pz"), .roll_rad = xi.at("roll"), .pitch_rad = xi.at("pitch")},
                         .translational_n_per_m = entry.at("kS"),
                         .rotational_n_m_per_rad = entry.at("Kphi")};
    for (int i = 0; i < 6; ++i) query.wrench[i] = entry.at("w")[static_cast<std::size_t>(i)];
    const auto answer = ask_rrs3_model(query);
    REQUIRE(answer);
    CHECK(answer->yaw == Approx(out.at("yaw").get<double>()).epsilon(1e-9).margin(1e-15));
    check_near(answer->p, out.at("p"));
    check_near(answer->b, out.at("B"));
    check_near(answer->d, out.at("D"));
    check_near(answer->q, out.at("q"));
    check_near(answer->j_chi, out.at("J_chi"));
    check_near(answer->j_xi, out.at("J_xi"));
    check_near(answer->h, out.at("H"));
    check_near(answer->tau, out.at("tau"));
    check_near(answer->kq, out.at("Kq"));
    CHECK(answer->cond == Approx(out.at("cond_scaled_b").get<double>()).epsilon(1e-9));
    CHECK(answer->det_ux == Approx(out.at("detUx").get<double>()).epsilon(1e-9));
    CHECK(answer->singularities.serial > 0);
    CHECK(answer->singularities.pz.serial.up > 0);
  }
}

TEST_CASE("the model has no answer out of reach") {
  const Rrs3Geometry geometry = geometry_of(rrs3_spec());
  CHECK_FALSE(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.034}}));
  CHECK_FALSE(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.02, .roll_rad = 2}}));
  CHECK(ask_rrs3_model({.geometry = geometry, .coordinates = {.pz_m = -0.02}}));
  CHECK_THROWS_AS(ask_rrs3_model({.geometry = {}, .coordinates = {.pz_m = -0.02}}), InputError);
}

TEST_CASE("a geometry is read in its short and long forms and from a device specification") {
  const Rrs3Geometry expected = geometry_of(rrs3_spec());
  const auto same = [&](const Rrs3Geometry& g) {
    return g.a_m == expected.a_m && g.b_m == expected.b_m && g.bh_m == expected.bh_m && g.bd_m == expected.bd_m &&
           g.l1_m == expected.l1_m && g.l2_m == expected.l2_m;
  };
  const std::string lengths = R"("a":0.006,"b":0.01,"bh":0.005,"bd":0.017320508075688773,"l1":0.012,"l2":0.02)";
  const Rrs3Geometry brief = geometry_from("{" + lengths + R"(,"pz0":-0.02})");
  CHECK(same(brief));
  CHECK(brief.rest_z_m == -0.02);
  CHECK(same(geometry_from("{" + lengths + "}")));
  const Rrs3Geometry shipped = load_rrs3_geometry(source_path("devices/specs/rrs3.json"));
  CHECK(same(shipped));
  CHECK(shipped.rest_z_m == expected.rest_z_m);
  std::ifstream file(source_path("devices/specs/rrs3.json"));
  CHECK(same(geometry_from(json::parse(file).at("geometry").dump())));
}

TEST_CASE("mistakes in a geometry are named with their path") {
  CHECK(complaint(R"({"a":6,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012,"l2":0.02})").find("$.a") != std::string::npos);
  CHECK(complaint(R"({"a":0.006,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012})").find("l2") != std::string::npos);
  const std::string two = complaint(R"({"a":-1,"b":0.01,"bh":0.005,"bd":0.0173,"l1":0.012,"l2":"x","l3":1})");
  CHECK(two.find("$.a") != std::string::npos);
  CHECK(two.find("$.l2") != std::string::npos);
  CHECK(two.find("l3") != std::string::npos);
  CHECK(complaint(R"({"format":1,"geometry":{"a_m":0.006}})").find("$.geometry") != std::string::npos);
  CHECK(complaint(R"({"geometry":5})").find("$.geometry") != std::string::npos);
  CHECK_FALSE(complaint("[]").empty());
  CHECK_THROWS_AS(load_rrs3_geometry("no/such/file.json"), InputError);
}

// Forward kinematics gives back the pose that the joint angles came from, and nothing where there is none.

double share() {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001)) / 1000.0;
}

// Largest difference of two poses, rad or radii b.
double apart(const Rrs3Coordinates& a, const Rrs3Coordinates& b, double radius) {
  return std::max(
      {std::abs(a.pz_m - b.pz_m) / radius, std::abs(a.roll_rad - b.roll_rad), std::abs(a.pitch_rad - b.pitch_rad)});
}

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

// The workspace of the default geometry and its singularities, as an independent numpy model finds them.

TEST_CASE("96.3 per cent of the box of limits is reachable") {
  const Rrs3Workspace workspace = workspace_of(default_device(), box_of(rrs3_spec()));
  CHECK(workspace.poses == 31 * 25 * 25);
  CHECK(100 * workspace.reachable_share() == Approx(96.3).margin(0.5));
  CHECK(condition_at(default_device(), workspace.worst) == workspace.worst_condition);
  CHECK(workspace.worst_condition > 2.5);
  const Rrs3Workspace middle = workspace_of(default_device(), box_of(rrs3_spec()), {1, 1, 1});
  CHECK(middle.reachable == 1);
  CHECK(middle.worst_condition == Approx(std::sqrt(2.0)).epsilon(1e-9));  // at rest
  CHECK_THROWS_AS(workspace_of(default_device(), box_of(rrs3_spec()), {0, 5, 5}), InputError);
}

TEST_CASE("each published range alone is reachable and well conditioned") {
  const Rrs3Box box = box_of(rrs3_spec());
  const Rrs3Kinematics device = default_device();
  const double rest = device.geometry().rest_z_m;
  const Rrs3Box lines[] = {
      {box.lowest_m, box.highest_m, 0, 0}, {rest, rest, box.max_roll_rad, 0}, {rest, rest, 0, box.max_pitch_rad}};
  const Rrs3Grid grids[] = {{201, 1, 1}, {1, 201, 1}, {1, 1, 201}};
  for (int axis = 0; axis < 3; ++axis) {
    const Rrs3Workspace line = workspace_of(device, lines[axis], grids[axis]);
    CHECK(line.poses == 201);
    CHECK(line.reachable == 201);
    CHECK(line.worst_condition <= 2.5);
    CHECK(line.worst_condition >= 1);
  }
}

TEST_CASE("singularities at zero tilt") {
  const auto distances = singularity_distances(default_device(), {.pz_m = -0.02});
  REQUIRE(distances);
  CHECK(-20 - 1e3 * distances->pz.serial.down == Approx(-31.749).margin(0.001));
  CHECK(-20 + 1e3 * distances->pz.serial.up == Approx(-6.928).margin(0.001));
  CHECK(distances->roll.parallel.up / kDegree == Approx(59.0).margin(0.1));
  CHECK(distances->roll.parallel.down / kDegree == Approx(59.0).margin(0.1));
  CHECK(distances->pitch.parallel.down / kDegree == Approx(49.7).margin(0.1));
  CHECK(std::isinf(distances->pz.parallel.up));
  CHECK(std::isinf(distances->pz.constraint.up));
  CHECK(distances->serial > 0.9);
  CHECK(distances->serial <= 1);
}

TEST_CASE("the distances lead to where the determinants vanish") {
  const Rrs3Kinematics device = default_device();
  const auto there = singularity_distances(device, {.pz_m = -0.02, .roll_rad = 58.95 * kDegree});
  REQUIRE(there);
  CHECK(there->parallel < 1e-3);
  CHECK(there->roll.parallel.up < 0.01 * kDegree);
  CHECK(there->constraint > 0.1);
  const auto stretched = singularity_distances(device, {.pz_m = -0.031748});
  REQUIRE(stretched);
  CHECK(stretched->serial < 0.02);
  CHECK(stretched->pz.serial.down < 2e-6);
  CHECK_FALSE(singularity_distances(device, {.pz_m = -0.034}));
  CHECK_FALSE(singularity_distances(device, {.pz_m = std::nan("")}));
}

TEST_CASE("serial distances end exactly where poses end, and moving shortens them by the way gone") {
  const Rrs3Kinematics device = default_device();
  REQUIRE(rc::check("edges", [&device] {
    const auto share = [] { return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001)) / 1000.0; };
    const Rrs3Coordinates xi{.pz_m = -0.02 + 0.005 * share(), .roll_rad = 0.4 * share(), .pitch_rad = 0.4 * share()};
    const auto here = singularity_distances(device, xi);
    RC_PRE(here.has_value());
    for (const double value : {here->serial, here->parallel, here->constraint})
      RC_ASSERT(value > 0 && value <= 1 + 1e-12);
    const double up = here->pz.serial.up, down = here->pz.serial.down;
    const auto reached = [&](double dz) {
      return device.configuration({.pz_m = xi.pz_m + dz, .roll_rad = xi.roll_rad, .pitch_rad = xi.pitch_rad})
          .has_value();
    };
    RC_ASSERT(reached(up - 1e-8) && !reached(up + 1e-8));
    RC_ASSERT(reached(-down + 1e-8) && !reached(-down - 1e-8));
    const double gone = 0.3 * up;
    const auto moved =
        singularity_distances(device, {.pz_m = xi.pz_m + gone, .roll_rad = xi.roll_rad, .pitch_rad = xi.pitch_rad});
    RC_ASSERT(moved && std::abs(moved->pz.serial.up - (up - gone)) < 1e-8);
    // Beyond a parallel singularity det J has the other sign.
    const double tip = here->pitch.parallel.down;
    if (!std::isinf(tip)) {
      const auto det = [&](double pitch) {
        return device
            .differential(*device.configuration({.pz_m = xi.pz_m, .roll_rad = xi.roll_rad, .pitch_rad = pitch}))
            ->j.determinant();
      };
      RC_ASSERT(det(xi.pitch_rad - tip + 1e-6) * det(xi.pitch_rad - tip - 1e-6) < 0);
    }
  }));
}

TEST_CASE("a map of one height, as lines and as a picture") {
  const Rrs3ConditionMap map = condition_map(default_device(), box_of(rrs3_spec()), -0.0275, 25, 21);
  CHECK(map.rolls_rad.size() == 25);
  CHECK(map.pitches_rad.size() == 21);
  CHECK(map.rolls_rad.front() == -rrs3_spec().max_roll_rad);
  CHECK(map.at(12, 10) == Approx(*condition_at(default_device(), {.pz_m = -0.0275})));
  const auto unreachable =
      std::count_if(map.conditions.begin(), map.conditions.end(), [](double c) { return std::isinf(c); });
  CHECK(unreachable > 50);  // the corners of the lowest height
  CHECK(unreachable < 25 * 21 / 2);

  const std::string csv = condition_csv(map);
  CHECK(csv.rfind("pz_m,roll_rad,pitch_rad,reachable,condition\n-0.0275,-0.62", 0) == 0);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 25 * 21);
  std::size_t empty = 0;
  for (std::size_t at = csv.find(",0,\n"); at != std::string::npos; at = csv.find(",0,\n", at + 1)) ++empty;
  CHECK(empty == static_cast<std::size_t>(unreachable));

  // Roll mirrors the platform in its symmetric leg: the map reads the same upside down.
  for (std::size_t r = 0; r < 25; ++r)
    for (std::size_t p = 0; p < 21; ++p)
      if (!std::isinf(map.at(r, p))) CHECK(map.at(r, p) == Approx(map.at(24 - r, p)).epsilon(1e-9));
}

}  // namespace
