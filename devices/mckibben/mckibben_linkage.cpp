#include "devices/mckibben/mckibben_linkage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/input/input_error.h"

namespace jnd {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;
// A force whose lever at the fingertip is shorter than this share of l4 is not determined by (5)..(7).
constexpr double kSingular = 1e-9;

// The place in [low, high] where a function changes its sign, to the last bit.
template <typename Function>
double root(double low, double high, const Function& function) {
  const bool rises = function(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    if (middle <= low || middle >= high) break;
    ((function(middle) < 0) == rises ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

MckibbenLinkage::MckibbenLinkage(const MckibbenParameters& parameters) : parameters_(parameters) {
  const MckibbenParameters& m = parameters_;
  const auto check = [](bool sound, const char* message) {
    if (!sound) throw InputError(std::string("the McKibben finger's linkage ") + message);
  };
  check(m.l1_m > 0 && m.l4_m > 0 && m.h0_m > 0 && m.l2_m > 0 && m.d2_m > 0,
        "has a length that is not positive: check l1_m, l2_m, d2_m, l4_m and h0_m");
  // The rocker's end is at most l1 + |coupler| from O. The distance falls as sin(alpha1) grows.
  const double farthest = m.l1_m + std::hypot(m.l2_m, m.h2_m);
  const double sine = (m.l4_m * m.l4_m + m.h0_m * m.h0_m - farthest * farthest) / (2 * m.l4_m * m.h0_m);
  check(sine < 1, "does not assemble at any angle: l1_m and the coupler are too short for l4_m and h0_m");
  assembles_.min_rad = sine > -1 ? std::asin(sine) : -kQuarterTurn;
  assembles_.max_rad = std::numbers::pi - assembles_.min_rad;

  const auto theta2 = [this](double alpha1) { return pose(alpha1).value_or(LinkagePose{}).theta2_rad; };
  const auto slack = [this](double alpha1) { return pose(alpha1).value_or(LinkagePose{}).l5_m - parameters_.l5max_m; };
  // From the least angle on, the first place where the coupler is straight, and from there the first where l5 = l5max.
  constexpr double kStride = 0.002;
  double low = assembles_.min_rad + 1e-6;
  check(pose(low) && theta2(low) < 0, "is not extended at its least angle: check l2_m, h2_m and h0_m");
  while (low + kStride < kQuarterTurn && pose(low + kStride) && theta2(low + kStride) < 0) low += kStride;
  check(low + kStride < kQuarterTurn && pose(low + kStride).has_value(),
        "never lies straight (theta2 = 0): check l1_m, l4_m, h0_m and h2_m");
  usable_.min_rad = root(low, low + kStride, theta2);
  low = usable_.min_rad;
  check(slack(low) < 0, "has l5max_m below the tendon's length with a straight finger: give a longer l5max_m");
  while (low + kStride < kQuarterTurn && pose(low + kStride) && slack(low + kStride) < 0) low += kStride;
  check(low + kStride < kQuarterTurn && pose(low + kStride).has_value(),
        "never stretches the tendon to l5max_m: give a shorter l5max_m");
  usable_.max_rad = root(low, low + kStride, slack);
}

std::optional<LinkagePose> MckibbenLinkage::pose(double alpha1_rad) const noexcept {
  const MckibbenParameters& m = parameters_;
  const double ca = std::cos(alpha1_rad), sa = std::sin(alpha1_rad);
  const double au = m.l4_m * ca, aw = m.l4_m * sa;  // A, the rocker's end

  // (1), (2): A = B + l2 e + h2 n with B at l1 from O. In the triangle O, A, B the angle at A gives theta2; the
  // physical branch is acos with +.
  const double du = au, dw = aw - m.h0_m;
  const double coupler2 = m.l2_m * m.l2_m + m.h2_m * m.h2_m;
  const double d2 = du * du + dw * dw;
  const double x = (d2 + coupler2 - m.l1_m * m.l1_m) / (2 * std::sqrt(d2 * coupler2));
  if (!(std::abs(x) <= 1)) return std::nullopt;
  LinkagePose at;
  at.theta2_rad = std::remainder(std::atan2(dw, du) + std::acos(x) - std::atan2(m.h2_m, m.l2_m), 4 * kQuarterTurn);
  const double c2 = std::cos(at.theta2_rad), s2 = std::sin(at.theta2_rad);
  const double bu = au - m.l2_m * c2 + m.h2_m * s2, bw = aw - m.l2_m * s2 - m.h2_m * c2;  // B, where links 1 and 2 meet
  at.theta1_rad = std::atan2(bw - m.h0_m, bu);
  const double c1 = bu / m.l1_m, s1 = (bw - m.h0_m) / m.l1_m;
  at.p_m = {bu + (m.l2_m + m.d2_m) * c2, bw + (m.l2_m + m.d2_m) * s2};

  // (3), (4): the tendon from X to X1 on the coupler.
  const double tu = bu + m.l2_m * c2 + m.hx1_m * s2, tw = bw + m.l2_m * s2 - m.hx1_m * c2 + m.hx_m;
  at.l5_m = std::hypot(tu, tw);
  at.beta_rad = std::atan2(tw, tu);
  at.stroke_m = m.l5max_m - at.l5_m + m.catt1_m;

  // (5)..(7) with F_B eliminated by the direction across link 1, and F_A by the moment about B.
  const double cb = tu / at.l5_m, sb = tw / at.l5_m;
  const double rocker_across = sa * c1 - ca * s1;  // sin(alpha1 - theta1)
  const double tendon_across = sb * c1 - cb * s1;  // sin(beta - theta1)
  const double finger_across = c2 * c1 + s2 * s1;  // cos(theta2 - theta1)
  const double rocker_moment = ca * (m.l2_m * s2 + m.h2_m * c2) - sa * (m.l2_m * c2 - m.h2_m * s2);
  const double tendon_moment = cb * (m.hx1_m * c2 - m.l2_m * s2) + sb * (m.hx1_m * s2 + m.l2_m * c2);
  const double denominator = (m.l2_m + m.d2_m) * rocker_across + rocker_moment * finger_across;
  if (!(std::abs(denominator) > kSingular * m.l4_m)) return std::nullopt;
  at.kx = (tendon_moment * rocker_across + rocker_moment * tendon_across) / denominator;
  at.kw = -((m.l2_m + m.g2_m) * c2 * rocker_across + rocker_moment * c1) / denominator;

  // Speeds for a rocker speed of 1. A' = l4 (-sin alpha1, cos alpha1), B' = A' - theta2' (l2 n - h2 e), and B stays on
  // its circle: (B - O) . B' = 0 gives theta2'.
  const double coupler_along = m.l2_m * (s1 * c2 - c1 * s2) - m.h2_m * finger_across;
  if (!(std::abs(coupler_along) > kSingular * m.l4_m)) return std::nullopt;
  const double theta2_rate = -m.l4_m * rocker_across / coupler_along;
  at.tip_lever_m = m.l4_m * (s2 * sa + c2 * ca) + m.d2_m * theta2_rate;
  return at;
}

}  // namespace jnd
