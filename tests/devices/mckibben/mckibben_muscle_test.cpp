// The muscle's force and volume, the tendon, the air flow, and the two sensors.
#include <cmath>
#include <numbers>

#include <rapidcheck.h>

#include "devices/mckibben/mckibben_device.h"
#include "devices/mckibben/mckibben_model.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using std::numbers::pi;

namespace {

// (14) as printed.
double printed_force(double p, double l) {
  const MckibbenParameters& m = kTable1;
  const double root = std::sqrt(m.h_fibre_m * m.h_fibre_m - l * l);
  return -p * root * root / (4 * pi * m.nt * m.nt) + m.e_pa * (l - m.li_m) / m.li_m * 2 * m.ri_m * pi * m.si_m +
         (p * l * root / (2 * pi * m.nt) - m.e_pa * m.si_m * l / m.ri_m * (root / (2 * pi * m.nt) - m.ri_m)) * l /
             (m.nt * root);
}

FlowResistance resistance() {
  return {.mass_conductance_kg_per_s_pa = kTable1.rho0_kg_per_m3 * kTable1.c_m3_per_s_pa, .critical_ratio = kTable1.b};
}

// Absolute pressures of the valve's range.
double any_pressure() {
  return 101325 + *rc::gen::inRange(0, 1'000'001);
}

}  // namespace

TEST_CASE("the muscle's force is that of an independent model, and of (14) as printed") {
  for (const auto& row : mckibben_reference().at("Fmu"))
    CHECK(muscle_force_n(kTable1, row.at("p"), row.at("l")) == Approx(row.at("F").get<double>()).epsilon(1e-9));
  REQUIRE(rc::check("(14)", [] {
    const double p = *rc::gen::inRange(0, 1'000'001), l = 0.10 + *rc::gen::inRange(0, 450) * 1e-4;
    RC_ASSERT(std::abs(muscle_force_n(kTable1, p, l) - printed_force(p, l)) < 1e-9);
    RC_ASSERT(std::abs(muscle_force_per_pa(kTable1, l) - (printed_force(1e5, l) - printed_force(0, l)) / 1e5) < 1e-15);
  }));
}

TEST_CASE("the ideal part of the force is the work of the volume") {
  // Virtual work of a fluid in a loss-free tube: F = -p dV/dl with the sign of a pull, by finite differences of (13).
  for (const double l : {0.105, 0.12, 0.14}) {
    constexpr double h = 1e-6;
    const double per_pa = -(muscle_volume_m3(kTable1, l + h) - muscle_volume_m3(kTable1, l - h)) / (2 * h);
    CHECK(muscle_force_per_pa(kTable1, l) == Approx(per_pa).epsilon(1e-7));
  }
}

TEST_CASE("kA, off, length, volume and the force without pressure are those of an independent model") {
  const MckibbenModel model = mckibben_model();
  for (const auto& row : mckibben_reference().at("static")) {
    const auto pose = model.pose(row.at("alpha1"));
    REQUIRE(pose);
    const double length = kTable1.l0_m - row.at("CAtt").get<double>();
    CHECK(length == Approx(row.at("l").get<double>()).epsilon(1e-9));
    CHECK(muscle_volume_m3(kTable1, length) == Approx(row.at("V").get<double>()).epsilon(1e-9));
    CHECK(muscle_force_at_zero_n(kTable1, length) == Approx(row.at("F0").get<double>()).epsilon(1e-9));
    CHECK(pose->ka_n_per_pa() == Approx(row.at("kA").get<double>()).epsilon(1e-9));
    CHECK(pose->off_n() == Approx(row.at("off").get<double>()).epsilon(1e-9));
  }
}

TEST_CASE("without pressure the spring wins; a real tendon does not push") {
  const MckibbenModel bilateral = mckibben_model(), unilateral = mckibben_model({.kp = 0.28}, Tendon::unilateral);
  const MckibbenPose straight = *bilateral.pose(straight_rad()), flexed = *bilateral.pose(flexed_rad());
  CHECK(straight.tendon_n == Approx(-35.7).margin(0.05));
  CHECK(flexed.tendon_n == Approx(-14.5).margin(0.05));
  CHECK(bilateral.force_n(straight, kTable1.p_atm_pa) == Approx(-14.162).margin(5e-3));
  CHECK(bilateral.force_n(flexed, kTable1.p_atm_pa) == Approx(-3.30).margin(5e-3));
  CHECK(unilateral.force_n(straight, kTable1.p_atm_pa) == straight.weight_n);
  REQUIRE(rc::check("Fx", [&] {
    const double a1 = straight_rad() + (flexed_rad() - straight_rad()) * *rc::gen::inRange(0, 10'000) / 1e4;
    const MckibbenPose pose = *unilateral.pose(a1);
    const double pressure = any_pressure();
    const double fx = (unilateral.force_n(pose, pressure) - pose.weight_n) / pose.kx;
    RC_ASSERT(fx >= -1e-12);
    RC_ASSERT(unilateral.force_n(pose, pressure) >= bilateral.force_n(pose, pressure));
  }));
}

TEST_CASE("flow is that of an independent model, also out of the muscle") {
  for (const auto& row : mckibben_reference().at("flow"))
    CHECK(resistance().flow_kg_per_s(row.at("P1"), row.at("Pm")) == Approx(row.at("G").get<double>()).epsilon(1e-9));
}

TEST_CASE("flow is antisymmetric, runs downhill, and never is not a number") {
  REQUIRE(rc::check("flow", [] {
    const double first = any_pressure(), second = any_pressure();
    const double flow = resistance().flow_kg_per_s(first, second);
    RC_ASSERT(flow == -resistance().flow_kg_per_s(second, first));
    RC_ASSERT((first > second) == (flow > 0));
    RC_ASSERT((first == second) == (flow == 0));
  }));
  // At equal pressures the subsonic root is zero, whatever the rounding.
  REQUIRE(rc::check("equal", [] {
    const double p = 101325 + *rc::gen::inRange(0, 1'000'000) / 7.0;
    RC_ASSERT(resistance().flow_kg_per_s(p, p) == 0);
    RC_ASSERT(std::isfinite(resistance().flow_kg_per_s(p, std::nextafter(p, 0.0))));
    RC_ASSERT(std::isfinite(resistance().flow_kg_per_s(p, std::nextafter(p, 1e9))));
  }));
}

TEST_CASE("flow is continuous at the critical ratio and constant below it") {
  constexpr double kUpstream = 5e5;
  const double critical = kTable1.b * kUpstream;
  const double sonic = resistance().flow_kg_per_s(kUpstream, critical * 0.5);
  CHECK(sonic == Approx(kTable1.rho0_kg_per_m3 * kTable1.c_m3_per_s_pa * kUpstream).epsilon(1e-14));
  CHECK(resistance().flow_kg_per_s(kUpstream, critical) == sonic);
  CHECK(resistance().flow_kg_per_s(kUpstream, critical * (1 + 1e-6)) == Approx(sonic).epsilon(1e-10));
  CHECK(resistance().flow_kg_per_s(kUpstream, critical * 1.5) < sonic * 0.99);
}

TEST_CASE("the encoder tells 1024 angles a turn") {
  const Encoder encoder;
  const double pulse = 2 * pi / 1024;
  REQUIRE(rc::check("encoder", [&] {
    const double angle = *rc::gen::inRange(-30'000, 30'000) * 1e-4;
    const double read = encoder.read_rad(angle);
    RC_ASSERT(std::abs(read - angle) <= pulse / 2 * (1 + 1e-9));
    RC_ASSERT(std::abs(read / pulse - std::round(read / pulse)) < 1e-9);
  }));
  CHECK(Encoder{.pulses_per_turn = 0}.read_rad(0.123) == 0.123);
  CHECK(Encoder{.zero_rad = 0.35}.read_rad(0.35) == 0.35);
}

TEST_CASE("the force sensor: ideal by default, noise by time and seed alone, limited to its capacity") {
  const BeamForceSensor ideal;
  CHECK(ideal.read_n(3.21, ideal.noise_n(5)) == 3.21);
  CHECK(ideal.read_n(100, 0) == 89);
  CHECK(ideal.read_n(-100, 0) == -89);
  CHECK(BeamForceSensor{.resolution_n = 0.5}.read_n(3.21, 0) == 3.0);

  const BeamForceSensor noisy{.noise_sd_n = 0.1, .seed = 7}, other{.noise_sd_n = 0.1, .seed = 8};
  double sum = 0, squares = 0;
  constexpr int kReads = 20'000;
  for (int i = 0; i < kReads; ++i) {
    const double noise = noisy.noise_n(i * 1'000'000LL);
    sum += noise;
    squares += noise * noise;
  }
  CHECK(std::abs(sum / kReads) < 5 * 0.1 / std::sqrt(kReads));
  CHECK(std::sqrt(squares / kReads) == Approx(0.1).epsilon(0.03));
  CHECK(noisy.noise_n(42) == noisy.noise_n(42));
  CHECK(noisy.noise_n(42) != other.noise_n(42));
}
