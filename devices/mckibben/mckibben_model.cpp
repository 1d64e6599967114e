#include "devices/mckibben/mckibben_model.h"

#include <algorithm>
#include <cmath>

#include "protocols/input/input_error.h"

namespace jnd {
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
  const double length = muscle_length_m(m, at->stroke_m);
  if (!(length > 0 && length < m.h_fibre_m)) return std::nullopt;
  return MckibbenPose{.alpha1_rad = alpha1_rad,
                      .kx = at->kx,
                      .weight_n = at->kw * m.mc_kg * m.g_m_per_s2,
                      .tendon_n = muscle_force_at_zero_n(m, length) - spring_force_n(m, at->stroke_m),
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
