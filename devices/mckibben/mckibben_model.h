// The dynamic model of the McKibben finger: valve (10), resistance (11), muscle pressure (12), and the force at the
// fingertip that the pressure makes at a rocker angle. The finger itself is imposed: its angle is an input.
//
// Departures from the paper: the muscle also exhausts (see FlowResistance); the volume is constant within a step, as in
// (12), which costs at most 0.04 N at a flexion of 1 Hz.
//
// Integrated by RK4 in fixed steps of 1e-4 s: nothing here is stiff (valve poles at 42 and 461 rad/s). The force
// controller is evaluated inside the derivative.
//
// Thread rule: const after construction; the state belongs to the caller. Nothing but the constructor allocates or
// throws.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "protocols/rigs/device_description.h"

namespace jnd {

// Mass flow of air through a fluidic resistance, ISO 6358: equation (11) of the McKibben finger's paper, both ways.
//
// With P absolute: G = rho0 P1 C where P2 / P1 <= b (sonic), else G = rho0 P1 C sqrt(1 - ((P2 / P1 - b) / (1 - b))^2).
// The paper has only flow into the muscle, so that a force once risen could not fall; here the roles are swapped, with
// a negative sign, where the muscle's pressure is the higher one.
struct FlowResistance {
  double mass_conductance_kg_per_s_pa = 0;  // rho0 C
  double critical_ratio = 0;                // b, below 1

  // kg/s from the first to the second place, both absolute and positive; negative the other way.
  double flow_kg_per_s(double first_pa, double second_pa) const noexcept {
    const bool forward = first_pa >= second_pa;
    const double upstream = forward ? first_pa : second_pa;
    const double downstream = forward ? second_pa : first_pa;
    // The subsonic law times P1, so that one division is enough: sqrt(P1^2 - s^2) with s = (P2 - b P1) / (1 - b). The
    // difference P1 - s is written as (P1 - P2) / (1 - b): rounding never makes it negative.
    const double excess = downstream - critical_ratio * upstream;
    double driving = upstream;
    if (excess > 0) {
      const double scale = 1 / (1 - critical_ratio);
      driving = std::sqrt(scale * (upstream - downstream) * (upstream + scale * excess));
    }
    const double flow = mass_conductance_kg_per_s_pa * driving;
    return forward ? flow : -flow;
  }
};

// Kinematics and statics of the McKibben finger's four-bar linkage: where everything is at a rocker angle alpha1, and
// what the tendon's force and the linkage's weight do at the fingertip.
//
// Frame: the finger's sagittal plane, u forward, w down, origin at the rocker's pivot; the finger's joint (MCP) O lies
// at (0, h0), the tendon guide X at (0, -hx). The coupler has the axes e = (cos theta2, sin theta2) and n = (-sin
// theta2, cos theta2). The finger pushes the coupler at P with F along +n; the device pushes the finger with F along
// -n, against flexion.
//
// The paper's misprint, and what stands here instead (checked by virtual work in tests/devices):
//   (7)   the bracket after sin(alpha1) is (l2 cos theta2 - h2 sin theta2); the printed + is wrong at full flexion by
//         27 % in dF/dFx, 28 % in a force of 42 N with the weight.
//
// Thread rule: const after construction. Nothing here allocates or throws but the constructor: an angle that the
// linkage cannot take is an empty optional.
struct LinkagePose {
  double theta1_rad = 0, theta2_rad = 0, beta_rad = 0;  // (1)..(3): finger link, coupler, tendon
  double l5_m = 0;                                      // (4): tendon between guide and coupler
  double stroke_m = 0;                                  // (4): CAtt of muscle and spring
  std::array<double, 2> p_m{};                          // fingertip P: u, w
  double kx = 0;                                        // dF/dFx, of (5)..(7)
  double kw = 0;                                        // dF/d(mc g), of (5)..(7)
  // Speed of the coupler at P along n per speed of the rocker, m/rad: F times it is the torque about the rocker's
  // pivot.
  double tip_lever_m = 0;
};

struct AngleRange {
  double min_rad = 0, max_rad = 0;
};

class MckibbenLinkage {
 public:
  // Throws InputError where the lengths do not make a linkage that goes from straight to flexed.
  explicit MckibbenLinkage(const MckibbenParameters& parameters);

  // Empty where the linkage does not assemble at alpha1, where its force is undetermined, or where alpha1 is not a
  // number.
  std::optional<LinkagePose> pose(double alpha1_rad) const noexcept;

  // Where the linkage assembles at all; 7.884 to 172.116 deg with Table 1.
  const AngleRange& assembles() const noexcept { return assembles_; }
  // What a finger uses: from straight (theta2 = 0) to flexed (l5 = l5max); 20.121 to 53.106 deg with Table 1.
  const AngleRange& usable() const noexcept { return usable_; }

 private:
  MckibbenParameters parameters_;
  AngleRange assembles_, usable_;
};

// The McKibben muscle's force and volume (Ferraresi's model, with the tube's wall and elasticity), and what pulls the
// tendon together with the parallel spring.
//
//   (13)  l = l0 - CAtt, r = sqrt(h^2 - l^2) / (2 pi nt)
//   (14)  Fmu is affine in the pressure p, gauge, and pulls where it is positive. Its pressure term reduces to
//         p (3 l^2 - h^2) / (4 pi nt^2), the ideal muscle's.
//   (15)  Fx = Fmu - km CAtt - Fm0. At p = 0 the spring wins, so Fx < 0: the printed equation lets the tendon push.
//         Both readings are offered, as Tendon: bilateral as printed, unilateral with Fx >= 0.
double muscle_volume_m3(const MckibbenParameters& parameters, double length_m) noexcept;
double muscle_force_per_pa(const MckibbenParameters& parameters, double length_m) noexcept;  // dFmu/dp, N/Pa
double muscle_force_at_zero_n(const MckibbenParameters& parameters, double length_m) noexcept;
// (14), p gauge. Positive pulls.
double muscle_force_n(const MckibbenParameters& parameters, double gauge_pa, double length_m) noexcept;

// The finger's force control (8), (9): valve voltage from the force error, as P, PI or PID in continuous time.
//
//   V = Kp e + I + Kd (e - f) / T    clamped to the valve's range, 0..10 V
//   I' = Ki e                        but 0 while V is clamped and e would drive it further (conditional integration),
//                                    and I never leaves the valve's range
//   f' = (e - f) / T                 a first-order filter of the error, so that the derivative is finite
//
// The paper uses P alone (Kp = 0.28 V/N) and names an integral gain as future work. The law is evaluated inside the
// model's integration step: sampled once a step, it would lag by half of it.

// Time constant of the derivative's filter, s: it lags by 0.1 rad where the force loop oscillates, about 190 rad/s.
inline constexpr double kDerivativeFilter_s = 0.0005;

struct ControllerState {
  double integral_v = 0;
  double filtered_n = 0;
};

class ForceController {
 public:
  // min_v <= max_v.
  ForceController(const ForceGains& gains, double min_v, double max_v) noexcept
      : gains_(gains), min_v_(min_v), max_v_(max_v) {}

  struct Output {
    double volts = 0;
    ControllerState rate;  // of the state, per s
  };

  Output respond(double error_n, const ControllerState& state) const noexcept {
    const double slope = (error_n - state.filtered_n) * (1 / kDerivativeFilter_s);
    const double wanted = gains_.kp * error_n + state.integral_v + gains_.kd * slope;
    Output output;
    output.volts = bounded(wanted);
    const bool winds_up = (wanted > max_v_ && error_n > 0) || (wanted < min_v_ && error_n < 0);
    output.rate.integral_v = winds_up ? 0 : gains_.ki * error_n;
    output.rate.filtered_n = slope;
    return output;
  }

  // Where the state comes to rest at a constant error and voltage.
  ControllerState at_rest(double error_n, double volts) const noexcept {
    ControllerState state;
    if (gains_.ki != 0) state.integral_v = bounded(volts - gains_.kp * error_n);
    state.filtered_n = error_n;
    return state;
  }

  // Within the valve's range; what is not a number closes the valve.
  double bounded(double volts) const noexcept { return volts > min_v_ ? (volts < max_v_ ? volts : max_v_) : min_v_; }
  const ForceGains& gains() const noexcept { return gains_; }
  double min_v() const noexcept { return min_v_; }

 private:
  ForceGains gains_;
  double min_v_, max_v_;
};

inline constexpr double kMckibbenStep_s = 1e-4;

struct MckibbenState {
  double valve_pa = 0;  // p1, gauge
  double valve_rate_pa_per_s = 0;
  double muscle_pa = 0;  // Pmu, absolute
  ControllerState controller;
};

// What the force and the pressure need of a rocker angle: F = kx Fx + weight, Fx = tendon + tendon_per_pa p.
struct MckibbenPose {
  double alpha1_rad = 0;
  double kx = 0;             // dF/dFx
  double weight_n = 0;       // F of the linkage's weight alone
  double tendon_n = 0;       // Fx at p = 0
  double tendon_per_pa = 0;  // dFx/dp
  double pa_per_kg = 0;      // R T / V
  // kA: dF/dp, N/Pa. off: F at p = 0 with a bilateral tendon, N.
  double ka_n_per_pa() const noexcept { return kx * tendon_per_pa; }
  double off_n() const noexcept { return kx * tendon_n + weight_n; }
};

// Straight line between two poses, share 0..1.
MckibbenPose between(const MckibbenPose& first, const MckibbenPose& second, double share) noexcept;

class MckibbenModel {
 public:
  // Throws InputError where the parameters do not make a finger that works over its usable range.
  MckibbenModel(const MckibbenParameters& parameters, Tendon tendon, const ForceGains& gains);

  const MckibbenParameters& parameters() const noexcept { return parameters_; }
  const MckibbenLinkage& linkage() const noexcept { return linkage_; }

  // Empty where the linkage does not assemble or the muscle cannot be so long.
  std::optional<MckibbenPose> pose(double alpha1_rad) const noexcept;

  double force_n(const MckibbenPose& pose, double muscle_pa) const noexcept;  // F, muscle_pa absolute
  double gauge_pa(const MckibbenState& state) const noexcept { return state.muscle_pa - parameters_.p_atm_pa; }
  double volts(const MckibbenState& state, const MckibbenPose& pose, double reference_n) const noexcept;

  // Without pressure, and the settled state at a constant Fref and pose (of an unstable loop too).
  MckibbenState vented() const noexcept;
  MckibbenState steady_state(const MckibbenPose& pose, double reference_n) const noexcept;

  // One step of RK4 with the pose held; of a moving finger, give the pose at the middle of the step. A state or input
  // that is not a number ends in the vented state and a closed valve.
  void step(MckibbenState& state, const MckibbenPose& pose, double volts,
            double step_s = kMckibbenStep_s) const noexcept;
  void regulate(MckibbenState& state, const MckibbenPose& pose, double reference_n,
                double step_s = kMckibbenStep_s) const noexcept;

 private:
  template <typename Command>
  void integrate(MckibbenState& state, const MckibbenPose& pose, double step_s, const Command& command) const noexcept;
  void confine(MckibbenState& state) const noexcept;

  MckibbenParameters parameters_;
  Tendon tendon_;
  MckibbenLinkage linkage_;
  ForceController controller_;
  FlowResistance resistance_;
  double valve_stiffness_, valve_damping_;  // sigma_n^2, 2 zeta sigma_n
  double least_pa_, most_pa_;               // of the muscle, absolute: between no pressure and the valve's highest
};

}  // namespace jnd
