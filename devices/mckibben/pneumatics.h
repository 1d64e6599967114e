// Mass flow of air through a fluidic resistance, ISO 6358: equation (11) of the McKibben finger's paper, both ways.
//
// With P absolute: G = rho0 P1 C where P2 / P1 <= b (sonic), else G = rho0 P1 C sqrt(1 - ((P2 / P1 - b) / (1 - b))^2).
// The paper has only flow into the muscle, so that a force once risen could not fall; here the roles are swapped, with
// a negative sign, where the muscle's pressure is the higher one.
//
// Header only: it is evaluated four times in each integration step.
#pragma once

#include <cmath>

namespace jnd {

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

}  // namespace jnd
