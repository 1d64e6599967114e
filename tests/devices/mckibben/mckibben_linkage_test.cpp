// The McKibben finger's linkage, muscle and shipped file.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "devices/mckibben/mckibben_device.h"
#include "devices/mckibben/mckibben_model.h"
#include "protocols/input/input_error.h"
#include "protocols/input/json_reader.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;
using std::numbers::pi;

namespace {

// The McKibben finger's linkage against an independent numpy model, virtual work, finite differences and its equations.

const MckibbenLinkage& linkage() {
  static const MckibbenLinkage linkage(kTable1);
  return linkage;
}

LinkagePose at(double alpha1) {
  const auto pose = linkage().pose(alpha1);
  REQUIRE(pose);
  return *pose;
}

// Central difference of a quantity of the pose.
template <typename Quantity>
double slope(double alpha1, const Quantity& quantity) {
  constexpr double h = 1e-5;
  return (quantity(at(alpha1 + h)) - quantity(at(alpha1 - h))) / (2 * h);
}

// Height w of the linkage's mass, downwards, from the finger link's end B.
double mass_w(const LinkagePose& pose) {
  return kTable1.h0_m + kTable1.l1_m * std::sin(pose.theta1_rad) +
         (kTable1.l2_m + kTable1.g2_m) * std::sin(pose.theta2_rad);
}

// dF/dFx of (5)..(7), with a sign for the h2 sin(theta2) that is misprinted in (7).
double kx_of_equations(double a1, const LinkagePose& p, double sign) {
  const MckibbenParameters& m = kTable1;
  const double c2 = std::cos(p.theta2_rad), s2 = std::sin(p.theta2_rad);
  // Unknowns FA, FB, F for Fx = 1 and mc g = 0, by Cramer's rule over (5), (6), (7):
  //   FA ca - FB c1 - F s2 = cb;  -FA sa + FB s1 - F c2 = -sb;  FA bracket - F (l2 + d2) = -tendon
  const double ca = std::cos(a1), sa = std::sin(a1), c1 = std::cos(p.theta1_rad), s1 = std::sin(p.theta1_rad);
  const double cb = std::cos(p.beta_rad), sb = std::sin(p.beta_rad);
  const double bracket = ca * (m.l2_m * s2 + m.h2_m * c2) - sa * (m.l2_m * c2 + sign * m.h2_m * s2);
  const double tendon = cb * (m.hx1_m * c2 - m.l2_m * s2) + sb * (m.hx1_m * s2 + m.l2_m * c2);
  const auto det = [](double a, double b, double c, double d, double e, double f, double g, double h, double i) {
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  };
  const double l = m.l2_m + m.d2_m;
  return det(ca, -c1, cb, -sa, s1, -sb, bracket, 0, -tendon) / det(ca, -c1, -s2, -sa, s1, -c2, bracket, 0, -l);
}

TEST_CASE("the linkage is that of an independent model") {
  for (const auto& row : mckibben_reference().at("static")) {
    const LinkagePose pose = at(row.at("alpha1"));
    CHECK(pose.theta1_rad == Approx(row.at("theta1").get<double>()).epsilon(1e-9));
    CHECK(pose.theta2_rad == Approx(row.at("theta2").get<double>()).epsilon(1e-9));
    CHECK(pose.beta_rad == Approx(row.at("beta").get<double>()).epsilon(1e-9));
    CHECK(pose.l5_m == Approx(row.at("l5").get<double>()).epsilon(1e-9));
    CHECK(pose.stroke_m == Approx(row.at("CAtt").get<double>()).epsilon(1e-9));
    CHECK(pose.p_m[0] == Approx(row.at("P")[0].get<double>()).epsilon(1e-9));
    CHECK(pose.p_m[1] == Approx(row.at("P")[1].get<double>()).epsilon(1e-9));
    CHECK(pose.kx == Approx(row.at("kx").get<double>()).epsilon(1e-9));
    CHECK(pose.kw == Approx(row.at("kw").get<double>()).epsilon(1e-9));
  }
}

TEST_CASE("the ranges of the rocker come out of the lengths") {
  const auto& special = mckibben_reference().at("special");
  CHECK(linkage().assembles().min_rad == Approx(special.at("alpha_assemble_min").get<double>()).epsilon(1e-9));
  CHECK(linkage().usable().min_rad == Approx(special.at("alpha_straight_theta2_0").get<double>()).epsilon(1e-9));
  CHECK(linkage().usable().max_rad == Approx(special.at("alpha_l5max").get<double>()).epsilon(1e-9));
  CHECK(linkage().assembles().min_rad / kDegree == Approx(7.884).margin(5e-4));
  CHECK(linkage().assembles().max_rad / kDegree == Approx(172.116).margin(5e-4));
  CHECK(std::abs(at(straight_rad()).theta2_rad) < 1e-12);
  CHECK(at(flexed_rad()).l5_m == Approx(kTable1.l5max_m).epsilon(1e-12));
  CHECK(at(special.at("alpha_theta2_90").get<double>()).theta2_rad == Approx(90 * kDegree).epsilon(1e-9));
}

TEST_CASE("an angle that the linkage cannot take is empty") {
  CHECK_FALSE(linkage().pose(linkage().assembles().min_rad - 1e-6));
  CHECK_FALSE(linkage().pose(linkage().assembles().max_rad + 1e-6));
  CHECK(linkage().pose(linkage().assembles().min_rad + 1e-6));
  CHECK(linkage().pose(linkage().assembles().max_rad - 1e-6));
  CHECK_FALSE(linkage().pose(kNaN));
  CHECK_FALSE(linkage().pose(kInf));
}

TEST_CASE("every angle of the range fulfils (1) to (4), and power in is power out") {
  REQUIRE(rc::check("linkage", [] {
    const double a1 = straight_rad() + (flexed_rad() - straight_rad()) * *rc::gen::inRange(1, 9999) / 1e4;
    const MckibbenParameters& m = kTable1;
    const LinkagePose p = at(a1);
    const double c2 = std::cos(p.theta2_rad), s2 = std::sin(p.theta2_rad);
    RC_ASSERT(std::abs(m.l4_m * std::cos(a1) + m.h2_m * s2 - m.l2_m * c2 - m.l1_m * std::cos(p.theta1_rad)) < 1e-14);
    RC_ASSERT(std::abs(m.l4_m * std::sin(a1) - m.h2_m * c2 - m.l2_m * s2 - m.h0_m - m.l1_m * std::sin(p.theta1_rad)) <
              1e-14);
    RC_ASSERT(std::abs(p.l5_m * std::cos(p.beta_rad) - (m.l4_m * std::cos(a1) + (m.h2_m + m.hx1_m) * s2)) < 1e-14);
    RC_ASSERT(std::abs(p.stroke_m - (m.l5max_m - p.l5_m + m.catt1_m)) < 1e-15);

    // The lever: the fingertip's velocity along the coupler's normal.
    const double along = -s2 * slope(a1, [](const LinkagePose& q) { return q.p_m[0]; }) +
                         c2 * slope(a1, [](const LinkagePose& q) { return q.p_m[1]; });
    RC_ASSERT(std::abs(p.tip_lever_m / along - 1) < 1e-8);
    // Virtual work: F times its speed is the tendon's work against Fx (its length grows) less what the weight gives.
    const double tendon_speed = slope(a1, [](const LinkagePose& q) { return q.l5_m; });
    const double fall_speed = slope(a1, mass_w);
    RC_ASSERT(std::abs(p.kx * p.tip_lever_m / tendon_speed - 1) < 1e-8);
    RC_ASSERT(std::abs(p.kw * p.tip_lever_m + fall_speed) < 1e-8 * m.l4_m);
  }));
}

TEST_CASE("the printed sign of (7) is wrong by 27 % in dF/dFx, 28 % in a force of 42 N, at full flexion") {
  const LinkagePose flexed = at(flexed_rad());
  CHECK(kx_of_equations(flexed_rad(), flexed, -1) == Approx(flexed.kx).epsilon(1e-12));
  const double printed_kx = kx_of_equations(flexed_rad(), flexed, +1);
  CHECK(printed_kx / flexed.kx - 1 == Approx(0.270).margin(0.001));
  // With the weight, whose share the misprint turns around: kw -0.490 becomes +0.263.
  const double weight = kTable1.mc_kg * kTable1.g_m_per_s2, tendon = 200;
  const double right = flexed.kx * tendon + flexed.kw * weight, printed = printed_kx * tendon + 0.263 * weight;
  CHECK(right == Approx(41.75).margin(0.01));
  CHECK(printed / right - 1 == Approx(0.28).margin(0.005));
  // Straight, theta2 is 0 and both signs agree.
  CHECK(kx_of_equations(straight_rad(), at(straight_rad()), +1) == Approx(at(straight_rad()).kx).epsilon(1e-9));
}

TEST_CASE("lengths that make no finger are refused with what to do") {
  const auto refused = [](auto change) {
    MckibbenParameters parameters;
    change(parameters);
    CHECK_THROWS_AS(MckibbenLinkage(parameters), InputError);
  };
  refused([](MckibbenParameters& m) { m.l1_m = 0; });
  refused([](MckibbenParameters& m) { m.l1_m = 0.01; });
  refused([](MckibbenParameters& m) { m.l5max_m = 0.05; });
  refused([](MckibbenParameters& m) { m.l5max_m = 0.3; });
  refused([](MckibbenParameters& m) { m.l4_m = kNaN; });
}

// The muscle's force and volume, the tendon, the air flow, and the two sensors.

// (14) as printed.
double printed_force(double p, double l) {
  const MckibbenParameters& m = kTable1;
  const double root = std::sqrt(m.h_fibre_m * m.h_fibre_m - l * l);
  return -p * root * root / (4 * pi * m.nt * m.nt) + m.e_pa * (l - m.li_m) / m.li_m * 2 * m.ri_m * pi * m.si_m +
         (p * l * root / (2 * pi * m.nt) - m.e_pa * m.si_m * l / m.ri_m * (root / (2 * pi * m.nt) - m.ri_m)) * l /
             (m.nt * root);
}

double muscle_force(double p, double l) {
  return p * muscle_force_per_pa(kTable1, l) + muscle_force_at_zero_n(kTable1, l);
}

FlowResistance resistance() {
  return {.mass_conductance_kg_per_s_pa = kTable1.rho0_kg_per_m3 * kTable1.c_m3_per_s_pa, .critical_ratio = kTable1.b};
}

// Absolute pressures of the valve's range.
double any_pressure() {
  return 101325 + *rc::gen::inRange(0, 1'000'001);
}

TEST_CASE("the muscle's force is that of an independent model, and of (14) as printed") {
  for (const auto& row : mckibben_reference().at("Fmu"))
    CHECK(muscle_force(row.at("p"), row.at("l")) == Approx(row.at("F").get<double>()).epsilon(1e-9));
  REQUIRE(rc::check("(14)", [] {
    const double p = *rc::gen::inRange(0, 1'000'001), l = 0.10 + *rc::gen::inRange(0, 450) * 1e-4;
    RC_ASSERT(std::abs(muscle_force(p, l) - printed_force(p, l)) < 1e-9);
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

// The shipped file of the McKibben finger, and what a geometry file must have.

TEST_CASE("the shipped geometry file has Table 1, and every key is required") {
  const std::filesystem::path path = std::filesystem::path(JND_SOURCE_DIR) / "devices/specs/mckibben.json";
  const DeviceSpec spec = load_device_spec(path);
  CHECK(spec.model == DeviceModel::mckibben);
  CHECK(spec.tendon == Tendon::unilateral);
  CHECK(spec.gains.kp == MckibbenOptions{}.gains.kp);
  CHECK(spec.gains.ki == MckibbenOptions{}.gains.ki);
  CHECK(spec.lowest_travel == Approx(straight_rad()).epsilon(1e-9));
  CHECK(spec.highest_travel == Approx(flexed_rad()).epsilon(1e-9));
  const MckibbenModel shipped(spec.finger, spec.tendon, spec.gains);
  const MckibbenModel table1 = mckibben_model(spec.gains, spec.tendon);
  CHECK(shipped.pose(0.6)->off_n() == table1.pose(0.6)->off_n());
  CHECK(shipped.pose(0.6)->pa_per_kg == table1.pose(0.6)->pa_per_kg);
  double lever = 0;
  for (int i = 0; i < 1000; ++i)
    lever +=
        table1.linkage().pose(straight_rad() + (flexed_rad() - straight_rad()) * (i + 0.5) / 1000)->tip_lever_m / 1000;
  CHECK(spec.lever_arm_m == Approx(lever).margin(1e-4));

  std::ifstream file(path);
  const nlohmann::json finger = nlohmann::json::parse(file).at("finger");
  CHECK(finger.size() == 33);
  for (const auto& [key, value] : finger.items()) {
    nlohmann::json less = finger;
    less.erase(key);
    std::vector<Diagnostic> diagnostics;
    const JsonNode node = parse_json(less.dump(), "finger.json");
    (void)read_mckibben_parameters(node, diagnostics, "finger.json");
    REQUIRE_FALSE(diagnostics.empty());
    CHECK(to_text(diagnostics.front()).find(key) != std::string::npos);
  }
  nlohmann::json unknown = finger;
  unknown["l6_m"] = 1;
  std::vector<Diagnostic> diagnostics;
  (void)read_mckibben_parameters(parse_json(unknown.dump(), "finger.json"), diagnostics, "finger.json");
  CHECK(diagnostics.size() == 1);
}

}  // namespace
