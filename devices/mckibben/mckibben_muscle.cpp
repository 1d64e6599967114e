#include "devices/mckibben/mckibben_muscle.h"

#include <cmath>
#include <numbers>

namespace jnd {

using std::numbers::pi;

double muscle_length_m(const MckibbenParameters& parameters, double stroke_m) noexcept {
  return parameters.l0_m - stroke_m;
}

double muscle_radius_m(const MckibbenParameters& parameters, double length_m) noexcept {
  const double h = parameters.h_fibre_m;
  return std::sqrt(h * h - length_m * length_m) / (2 * pi * parameters.nt);
}

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

double spring_force_n(const MckibbenParameters& parameters, double stroke_m) noexcept {
  return parameters.km_n_per_m * stroke_m + parameters.fm0_n;
}

}  // namespace jnd
