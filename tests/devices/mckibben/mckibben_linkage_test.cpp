// The McKibben finger's linkage against an independent numpy model, virtual work, finite differences and its equations.
#include <cmath>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "protocols/input/input_error.h"
#include "tests/catch.h"
#include "tests/devices/mckibben/mckibben_fixtures.h"

using namespace jnd;
using namespace jnd::testing;

namespace {

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

}  // namespace

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
