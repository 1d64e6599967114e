// The plant alone: what goes in as work is in the pulp, in motion or lost in the damper; and it settles where it
// should.
#include <cmath>
#include <vector>

#include <rapidcheck.h>

#include "devices/rrs3/rrs3_platform.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/hid/virtual/plant_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

// m u'' + 2 sqrt(m k) u' + k u = F over a step, by Runge and Kutta's fourth order, and what the damper takes.
struct Motion {
  double u = 0, v = 0, lost_j = 0;
};
Motion integrated(Motion at, double force_n, double stiffness_n_per_m, double time_s) {
  const double damping = 2 * std::sqrt(kPlatformMass_kg * stiffness_n_per_m);
  const auto rate = [&](const Motion& x) {
    return Motion{x.v, (force_n - damping * x.v - stiffness_n_per_m * x.u) / kPlatformMass_kg, damping * x.v * x.v};
  };
  const auto plus = [](const Motion& x, double h, const Motion& d) {
    return Motion{x.u + h * d.u, x.v + h * d.v, x.lost_j + h * d.lost_j};
  };
  constexpr int kParts = 50;
  const double h = time_s / kParts;
  for (int part = 0; part < kParts; ++part) {
    const Motion a = rate(at), b = rate(plus(at, h / 2, a)), c = rate(plus(at, h / 2, b)), d = rate(plus(at, h, c));
    at = {at.u + h / 6 * (a.u + 2 * b.u + 2 * c.u + d.u), at.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v),
          at.lost_j + h / 6 * (a.lost_j + 2 * b.lost_j + 2 * c.lost_j + d.lost_j)};
  }
  return at;
}

// The joint torques that put a force on the platform along its normal, and no moment.
Eigen::Vector3d torques_for(const Rrs3Platform& platform, double force_n) {
  Wrench wrench = Wrench::Zero();
  wrench.head<3>() = force_n * platform.normal();
  return joint_torques(platform.differential(), wrench);
}

void turn_to(Rrs3Platform& platform, double roll_rad, double pitch_rad) {
  for (int i = 0; i < 300; ++i) platform.step({.roll_rad = roll_rad, .pitch_rad = pitch_rad});
  REQUIRE(platform.coordinates().roll_rad == Approx(roll_rad));
  REQUIRE(platform.coordinates().pitch_rad == Approx(pitch_rad));
}

struct Tilted {
  double roll_rad, pitch_rad;
};
constexpr Tilted kTilts[] = {{0, 0}, {0.3, 0}, {-0.2, 0.35}, {0.1, -0.5}};

}  // namespace

TEST_CASE("the work of the joint torques is in the pulp, in motion or lost in the damper") {
  for (const Tilted& tilt : kTilts)
    for (const double pulp : {700.0, 1000.0, 3000.0}) {
      Rrs3Platform platform(plant_rrs3(), pulp);
      turn_to(platform, tilt.roll_rad, tilt.pitch_rad);
      double work_j = 0, lost_j = 0, most_j = 0;  // most_j: held at once
      double worst_u = 0, worst_v = 0, worst_j = 0;
      for (int ms = 0; ms < 600; ++ms) {
        // A press that swells, holds and lets go: at most 2.25 N.
        const double force = ms < 400 ? 1.5 + 0.75 * std::sin(0.01 * ms) : 0;
        const Eigen::Vector3d q = platform.joint_angles();
        const Eigen::Vector3d before = torques_for(platform, force);
        const Motion moved = integrated({platform.compression_m(), platform.velocity_m_per_s(), 0}, force, pulp, 0.001);
        platform.step({.force_n = platform.force_of(before), .roll_rad = tilt.roll_rad, .pitch_rad = tilt.pitch_rad});
        // The exact step is the differential equation's.
        worst_u = std::max(worst_u, std::abs(platform.compression_m() - moved.u));
        worst_v = std::max(worst_v, std::abs(platform.velocity_m_per_s() - moved.v));
        // Within the step the force stays the same while the lever arms change: the mean of both ends.
        work_j += (before + torques_for(platform, force)).dot(platform.joint_angles() - q) / 2;
        lost_j += moved.lost_j;
        const double u = platform.compression_m(), v = platform.velocity_m_per_s();
        const double held_j = pulp * u * u / 2 + kPlatformMass_kg * v * v / 2;
        most_j = std::max(most_j, held_j);
        worst_j = std::max(worst_j, std::abs(work_j - held_j - lost_j));
      }
      CHECK(worst_u < 1e-11);
      CHECK(worst_v < 1e-8);
      CHECK(worst_j < 2e-4 * most_j);
      CHECK(most_j > 1e-4);
      CHECK(platform.force_n() < 1e-9);
      CHECK(work_j == Approx(lost_j).margin(1e-3 * most_j));  // all is over
    }
}

TEST_CASE("a constant force settles at F / k, without overshoot") {
  CHECK(rc::check("whatever force, pulp and tilt", [] {
    const double pulp = *rc::gen::inRange(700, 5000);
    const double force = 1e-3 * *rc::gen::inRange(1, 4700);
    const double roll = 1e-3 * *rc::gen::inRange(-300, 300), pitch = 1e-3 * *rc::gen::inRange(-250, 250);
    Rrs3Platform platform(plant_rrs3(), pulp);
    const PlatformDrive drive{.force_n = force, .roll_rad = roll, .pitch_rad = pitch};
    for (int ms = 0; ms < 300; ++ms) {
      const double before = platform.force_n();
      platform.step(drive);
      RC_ASSERT(platform.force_n() >= before - 1e-12);
      RC_ASSERT(platform.force_n() <= force * (1 + 1e-12));
    }
    RC_ASSERT(std::abs(platform.force_n() / force - 1) < 1e-9);
    RC_ASSERT(std::abs(platform.coordinates().pz_m -
                       (plant_rrs3().rest_z_m + force / pulp / (std::cos(roll) * std::cos(pitch)))) < 1e-12);
  }));
}

TEST_CASE("a held position renders gain and pulp in series") {
  for (const double gain : {100.0, 500.0, 900.0, 2000.0})
    for (const double pulp : {700.0, 1000.0, 3000.0}) {
      Rrs3Platform platform(plant_rrs3(), pulp);
      constexpr double kDepth_m = 0.003;
      double worst_u = 0;
      for (int ms = 0; ms < 300; ++ms) {
        // Within the step the force falls by the gain, from what it was told.
        const double force = gain * (kDepth_m - platform.compression_m()), u = platform.compression_m();
        const Motion moved = integrated({u, platform.velocity_m_per_s(), 0}, force + gain * u, pulp + gain, 0.001);
        platform.step({.force_n = force, .hold_n_per_m = gain});
        worst_u = std::max(worst_u, std::abs(platform.compression_m() - moved.u));
      }
      CHECK(worst_u < 1e-11);
      CHECK(platform.force_n() == Approx(kDepth_m * gain * pulp / (gain + pulp)).epsilon(1e-9));
    }
}

TEST_CASE("whatever drives it, the platform neither pulls nor leaves its reach, and turns within its joints' speed") {
  CHECK(rc::check("hostile drives", [] {
    const DeviceSpec spec = plant_rrs3();
    Rrs3Platform platform(spec, 1000);
    const double joint_step = spec.max_joint_speed_rad_per_s * 1e-3;
    const int steps = *rc::gen::inRange(1, 200);
    double most_n = 0;
    for (int i = 0; i < steps; ++i) {
      PlatformDrive drive;
      drive.force_n = 1e-3 * *rc::gen::inRange(-20000, 20000);
      drive.hold_n_per_m = *rc::gen::element(0, 0, 500, 2000);
      drive.roll_rad = 1e-3 * *rc::gen::inRange(-1500, 1500);
      drive.pitch_rad = 1e-3 * *rc::gen::inRange(-1500, 1500);
      if (*rc::gen::inRange(0, 4) == 0) drive.force_n = 0;
      most_n = std::max(most_n, drive.force_n);
      const Eigen::Vector3d q = platform.joint_angles();
      const double u = platform.compression_m();
      platform.step(drive);
      RC_ASSERT(std::isfinite(platform.force_n()));
      RC_ASSERT(platform.force_n() >= 0);
      RC_ASSERT(platform.joint_angles().allFinite());
      // Turning alone, because a stroke moves the joints beside it; and within the tilts that a device allows. Towards
      // their corners the rates change by several per cent within a step.
      const Rrs3Coordinates& at = platform.coordinates();
      const bool allowed = std::abs(at.roll_rad) < spec.max_roll_rad && std::abs(at.pitch_rad) < spec.max_pitch_rad;
      if (u == 0 && platform.compression_m() == 0 && allowed)
        RC_ASSERT((platform.joint_angles() - q).cwiseAbs().maxCoeff() < 1.1 * joint_step);
      RC_ASSERT(platform.force_n() <= 1.5 * most_n);  // with the swing of a critically damped platform
    }
  }));
}

TEST_CASE("a platform at rest stays there to the last bit, and rest() brings it back") {
  Rrs3Platform platform(plant_rrs3(), 1000);
  const Eigen::Vector3d q = platform.joint_angles();
  for (int i = 0; i < 50; ++i) platform.step({});
  CHECK(platform.joint_angles() == q);
  CHECK(platform.force_n() == 0);
  for (int i = 0; i < 50; ++i) platform.step({.force_n = 2, .roll_rad = 0.2, .pitch_rad = -0.1});
  CHECK(platform.force_n() > 1.9);
  CHECK(platform.joint_angles() != q);
  platform.rest();
  CHECK(platform.joint_angles() == q);
  CHECK(platform.force_n() == 0);
  CHECK(platform.velocity_m_per_s() == 0);
}

TEST_CASE("a pulp too soft for the stroke is refused with the least stiffness that would do") {
  CHECK_THROWS_AS(Rrs3Platform(plant_rrs3(), 600), InputError);
  CHECK_THROWS_AS(Rrs3Platform(plant_rrs3(), -1), InputError);
  CHECK_THROWS_WITH(Rrs3Platform(plant_rrs3(), 600), Catch::Contains("at least 627"));
  DeviceSpec impossible = plant_rrs3();
  impossible.l2_m = 0.001;
  CHECK_THROWS_WITH(Rrs3Platform(impossible, 1000), Catch::Contains("rest pose"));
}
