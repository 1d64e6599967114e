#include "devices/contact.h"

#include <cmath>

namespace jnd {

namespace {
// Nearer to the centre than this the direction is rounding: the last normal is kept.
constexpr double kCentre_m = 1e-9;
// Less deep than this a finger only lies on the surface: the difference is rounding, and would make false contacts.
constexpr double kSurface_m = 1e-12;
}  // namespace

void SphereContact::begin(const Sphere& sphere, const Eigen::Vector3d& initial_normal) noexcept {
  sphere_ = sphere;
  contact_ = Contact{};
  contact_.normal = initial_normal;
}

const Contact& SphereContact::update(const Eigen::Vector3d& finger_m) noexcept {
  const Eigen::Vector3d from_centre = finger_m - sphere_.centre_m;
  const double distance = std::sqrt(from_centre.squaredNorm());
  const bool touched = contact_.touching;
  if (distance > kCentre_m) contact_.normal = from_centre * (1 / distance);
  contact_.touching = sphere_.radius_m - distance > kSurface_m;
  contact_.penetration_m = contact_.touching ? sphere_.radius_m - distance : 0;
  contact_.proxy_m = sphere_.centre_m + sphere_.radius_m * contact_.normal;
  contact_.event = contact_.touching == touched ? ContactEvent::none
                   : contact_.touching          ? ContactEvent::made
                                                : ContactEvent::broken;
  return contact_;
}

}  // namespace jnd
