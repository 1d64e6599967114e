// The McKibben muscle's force and volume (Ferraresi's model, with the tube's wall and elasticity), and what pulls the
// tendon together with the parallel spring.
//
//   (13)  l = l0 - CAtt, r = sqrt(h^2 - l^2) / (2 pi nt)
//   (14)  Fmu is affine in the pressure. Its pressure term reduces to p (3 l^2 - h^2) / (4 pi nt^2), the ideal
//   muscle's. (15)  Fx = Fmu - km CAtt - Fm0. At p = 0 the spring wins, so Fx < 0: the printed equation lets the tendon
//   push.
//         Both readings are offered, as Tendon of protocols/rigs/device_description.h: bilateral as printed, unilateral with
//         Fx >= 0.
//
// Pure functions; nothing allocates or throws.
#pragma once

#include "protocols/rigs/device_description.h"

namespace jnd {

double muscle_length_m(const MckibbenParameters& parameters, double stroke_m) noexcept;
// NaN where the length is not within 0..h, the fibre's.
double muscle_radius_m(const MckibbenParameters& parameters, double length_m) noexcept;
double muscle_volume_m3(const MckibbenParameters& parameters, double length_m) noexcept;

double muscle_force_per_pa(const MckibbenParameters& parameters, double length_m) noexcept;  // dFmu/dp, N/Pa
double muscle_force_at_zero_n(const MckibbenParameters& parameters, double length_m) noexcept;
// (14), p gauge. Positive pulls.
double muscle_force_n(const MckibbenParameters& parameters, double gauge_pa, double length_m) noexcept;

double spring_force_n(const MckibbenParameters& parameters, double stroke_m) noexcept;

}  // namespace jnd
