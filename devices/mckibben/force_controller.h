// The finger's force control (8), (9): valve voltage from the force error, as P, PI or PID in continuous time.
//
//   V = Kp e + I + Kd (e - f) / T    clamped to the valve's range, 0..10 V
//   I' = Ki e                        but 0 while V is clamped and e would drive it further (conditional integration),
//                                    and I never leaves the valve's range
//   f' = (e - f) / T                 a first-order filter of the error, so that the derivative is finite
//
// The paper uses P alone (Kp = 0.28 V/N) and names an integral gain as future work. The law is evaluated inside the
// model's integration step: sampled once a step, it would lag by half of it.
//
// Header only, for the same reason as pneumatics.h.
#pragma once

#include "protocols/rigs/device_description.h"

namespace jnd {

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

}  // namespace jnd
