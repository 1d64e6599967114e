// The dynamic model of the McKibben finger: valve (10), resistance (11), muscle pressure (12), and the force at the
// fingertip that the pressure makes at a rocker angle. The finger itself is imposed: its angle is an input.
//
// Departures from the paper: the muscle also exhausts (see pneumatics.h); the volume is constant within a step, as in
// (12), which costs at most 0.04 N at a flexion of 1 Hz.
//
// Integrated by RK4 in fixed steps of 1e-4 s: nothing here is stiff (valve poles at 42 and 461 rad/s). The force
// controller is evaluated inside the derivative.
//
// Thread rule: const after construction; the state belongs to the caller. Nothing but the constructor allocates or
// throws.
#pragma once

#include <optional>

#include "devices/mckibben/force_controller.h"
#include "devices/mckibben/mckibben_linkage.h"
#include "devices/mckibben/mckibben_muscle.h"
#include "devices/mckibben/pneumatics.h"

namespace jnd {

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
