#include "devices/mckibben/mckibben_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocols/input/input_error.h"

namespace jnd {
namespace {

using std::numbers::pi;

// NaN where the length is not within 0..h, the fibre's.
double muscle_radius_m(const MckibbenParameters& parameters, double length_m) noexcept {
  const double h = parameters.h_fibre_m;
  return std::sqrt(h * h - length_m * length_m) / (2 * pi * parameters.nt);
}

constexpr double kQuarterTurn = pi / 2;
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

double muscle_volume_m3(const MckibbenParameters& parameters, double length_m) noexcept {
  const double radius = muscle_radius_m(parameters, length_m);
  return pi * radius * radius * length_m;
}

double muscle_force_per_pa(const MckibbenParameters& parameters, double length_m) noexcept {
  const double h = parameters.h_fibre_m;
  return (3 * length_m * length_m - h * h) / (4 * pi * parameters.nt * parameters.nt);
}

double muscle_force_at_zero_n(const MckibbenParameters& parameters, double length_m) noexcept {
  const MckibbenParameters& m = parameters;
  const double radius = muscle_radius_m(m, length_m);
  const double tube = m.e_pa * (length_m - m.li_m) / m.li_m * 2 * m.ri_m * pi * m.si_m;
  // The wall's hoop tension, through the fibres: l / (nt sqrt(h^2 - l^2)) = l / (2 pi nt^2 r).
  const double hoop = m.e_pa * m.si_m * length_m / m.ri_m * (radius - m.ri_m);
  return tube - hoop * length_m / (2 * pi * m.nt * m.nt * radius);
}

double muscle_force_n(const MckibbenParameters& parameters, double gauge_pa, double length_m) noexcept {
  return gauge_pa * muscle_force_per_pa(parameters, length_m) + muscle_force_at_zero_n(parameters, length_m);
}

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
  assembles_.max_rad = pi - assembles_.min_rad;

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

namespace {

MckibbenState moved(const MckibbenState& from, const MckibbenState& rate, double step_s) noexcept {
  return {.valve_pa = from.valve_pa + step_s * rate.valve_pa,
          .valve_rate_pa_per_s = from.valve_rate_pa_per_s + step_s * rate.valve_rate_pa_per_s,
          .muscle_pa = from.muscle_pa + step_s * rate.muscle_pa,
          .controller = {.integral_v = from.controller.integral_v + step_s * rate.controller.integral_v,
                         .filtered_n = from.controller.filtered_n + step_s * rate.controller.filtered_n}};
}

}  // namespace

MckibbenPose between(const MckibbenPose& first, const MckibbenPose& second, double share) noexcept {
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  return {.alpha1_rad = mix(first.alpha1_rad, second.alpha1_rad),
          .kx = mix(first.kx, second.kx),
          .weight_n = mix(first.weight_n, second.weight_n),
          .tendon_n = mix(first.tendon_n, second.tendon_n),
          .tendon_per_pa = mix(first.tendon_per_pa, second.tendon_per_pa),
          .pa_per_kg = mix(first.pa_per_kg, second.pa_per_kg)};
}

MckibbenModel::MckibbenModel(const MckibbenParameters& parameters, Tendon tendon, const ForceGains& gains)
    : parameters_(parameters),
      tendon_(tendon),
      linkage_(parameters),
      controller_(gains, parameters.valve_min_v, parameters.valve_max_v),
      resistance_{.mass_conductance_kg_per_s_pa = parameters.rho0_kg_per_m3 * parameters.c_m3_per_s_pa,
                  .critical_ratio = parameters.b},
      valve_stiffness_(parameters.sigma_n_rad_per_s * parameters.sigma_n_rad_per_s),
      valve_damping_(2 * parameters.zeta * parameters.sigma_n_rad_per_s),
      least_pa_(parameters.p_atm_pa),
      most_pa_(parameters.p_atm_pa + parameters.kv_pa_per_v * parameters.valve_max_v) {
  if (!(gains.kp >= 0 && gains.ki >= 0 && gains.kd >= 0) || !std::isfinite(gains.kp + gains.ki + gains.kd))
    throw InputError("a gain of the McKibben finger's controller is negative or not a number: give kp, ki and kd >= 0");
  constexpr int kPlaces = 32;
  for (int i = 0; i <= kPlaces; ++i) {
    const AngleRange& range = linkage_.usable();
    const std::optional<MckibbenPose> at = pose(range.min_rad + (range.max_rad - range.min_rad) * i / kPlaces);
    if (!at || !(at->ka_n_per_pa() > 0))
      throw InputError(
          "the McKibben finger's muscle cannot pull over the whole range of the finger: check l0_m, catt1_m and "
          "h_fibre_m against l5max_m");
  }
}

std::optional<MckibbenPose> MckibbenModel::pose(double alpha1_rad) const noexcept {
  const std::optional<LinkagePose> at = linkage_.pose(alpha1_rad);
  if (!at) return std::nullopt;
  const MckibbenParameters& m = parameters_;
  const double length = m.l0_m - at->stroke_m;
  if (!(length > 0 && length < m.h_fibre_m)) return std::nullopt;
  return MckibbenPose{.alpha1_rad = alpha1_rad,
                      .kx = at->kx,
                      .weight_n = at->kw * m.mc_kg * m.g_m_per_s2,
                      .tendon_n = muscle_force_at_zero_n(m, length) - (m.km_n_per_m * at->stroke_m + m.fm0_n),
                      .tendon_per_pa = muscle_force_per_pa(m, length),
                      .pa_per_kg = m.r_j_per_kg_k * m.temperature_k / muscle_volume_m3(m, length)};
}

double MckibbenModel::force_n(const MckibbenPose& pose, double muscle_pa) const noexcept {
  double tendon = pose.tendon_n + pose.tendon_per_pa * (muscle_pa - parameters_.p_atm_pa);
  if (tendon_ == Tendon::unilateral && tendon < 0) tendon = 0;
  return pose.kx * tendon + pose.weight_n;
}

double MckibbenModel::volts(const MckibbenState& state, const MckibbenPose& pose, double reference_n) const noexcept {
  return controller_.respond(reference_n - force_n(pose, state.muscle_pa), state.controller).volts;
}

MckibbenState MckibbenModel::vented() const noexcept {
  return {.muscle_pa = least_pa_, .controller = {}};
}

MckibbenState MckibbenModel::steady_state(const MckibbenPose& pose, double reference_n) const noexcept {
  const ForceGains& gains = controller_.gains();
  const double per_volt = pose.ka_n_per_pa() * parameters_.kv_pa_per_v;
  // Without the tendon's sign: e = 0 under an integral gain, else V = Kp (Fref - off - kA KV V).
  double volts = gains.ki > 0 ? (reference_n - pose.off_n()) / per_volt
                              : gains.kp * (reference_n - pose.off_n()) / (1 + gains.kp * per_volt);
  volts = controller_.bounded(volts);
  // A slack tendon leaves the weight alone.
  if (tendon_ == Tendon::unilateral && pose.tendon_n + pose.tendon_per_pa * parameters_.kv_pa_per_v * volts < 0)
    volts = gains.ki > 0 ? controller_.min_v() : controller_.bounded(gains.kp * (reference_n - pose.weight_n));
  MckibbenState state{.valve_pa = parameters_.kv_pa_per_v * volts,
                      .muscle_pa = least_pa_ + parameters_.kv_pa_per_v * volts,
                      .controller = {}};
  state.controller = controller_.at_rest(reference_n - force_n(pose, state.muscle_pa), volts);
  confine(state);
  return state;
}

// Pressures stay between none and the valve's highest; a state that is not a number is let out.
void MckibbenModel::confine(MckibbenState& state) const noexcept {
  const double sum = state.valve_pa + state.valve_rate_pa_per_s + state.muscle_pa + state.controller.integral_v +
                     state.controller.filtered_n;
  if (!std::isfinite(sum)) state = vented();
  state.valve_pa = std::min(std::max(state.valve_pa, 0.0), most_pa_ - least_pa_);
  state.muscle_pa = std::min(std::max(state.muscle_pa, least_pa_), most_pa_);
  if (controller_.gains().ki != 0) state.controller.integral_v = controller_.bounded(state.controller.integral_v);
}

template <typename Command>
void MckibbenModel::integrate(MckibbenState& state, const MckibbenPose& pose, double step_s,
                              const Command& command) const noexcept {
  // The derivative of the state, as a state.
  const auto rate = [&](const MckibbenState& at) {
    const ForceController::Output output = command(at);
    return MckibbenState{
        .valve_pa = at.valve_rate_pa_per_s,
        .valve_rate_pa_per_s = valve_stiffness_ * (parameters_.kv_pa_per_v * output.volts - at.valve_pa) -
                               valve_damping_ * at.valve_rate_pa_per_s,
        .muscle_pa = pose.pa_per_kg * resistance_.flow_kg_per_s(least_pa_ + at.valve_pa, at.muscle_pa),
        .controller = output.rate};
  };
  const MckibbenState a = rate(state);
  const MckibbenState b = rate(moved(state, a, step_s / 2));
  const MckibbenState c = rate(moved(state, b, step_s / 2));
  const MckibbenState d = rate(moved(state, c, step_s));
  state = moved(moved(state, a, step_s / 6), b, step_s / 3);
  state = moved(moved(state, c, step_s / 3), d, step_s / 6);
  confine(state);
}

void MckibbenModel::step(MckibbenState& state, const MckibbenPose& pose, double volts, double step_s) const noexcept {
  const ForceController::Output held{.volts = controller_.bounded(volts), .rate = {}};
  integrate(state, pose, step_s, [&held](const MckibbenState&) { return held; });
}

void MckibbenModel::regulate(MckibbenState& state, const MckibbenPose& pose, double reference_n,
                             double step_s) const noexcept {
  integrate(state, pose, step_s, [&](const MckibbenState& at) {
    return controller_.respond(reference_n - force_n(pose, at.muscle_pa), at.controller);
  });
}

}  // namespace jnd
