// The workspace of the default geometry and its singularities, as an independent numpy model finds them.
#include "devices/rrs3/rrs3_workspace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <rapidcheck.h>

#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/device_fixtures.h"
#include "tests/devices/rrs3/rrs3_fixtures.h"
#include "tests/units.h"

using namespace jnd;
using namespace jnd::testing;

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
