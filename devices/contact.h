// God-object contact of a fingertip with a virtual sphere (Zilles and Salisbury 1995, used by Chinello et al. 2017):
// where the proxy stays on the surface, which way the surface pushes, how deep the finger is.
#pragma once

#include <Eigen/Core>

namespace jnd {

struct Sphere {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
};

enum class ContactEvent { none, made, broken };

struct Contact {
  bool touching = false;
  double penetration_m = 0;                           // along the normal, >= 0
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, outward
  Eigen::Vector3d proxy_m = Eigen::Vector3d::Zero();  // nearest point of the surface
  ContactEvent event = ContactEvent::none;            // at this update
};

// One finger on one sphere. For a convex body the god object is the nearest surface point, so the only memory is the
// last normal, for a finger at the very centre, and whether it touched.
class SphereContact {
 public:
  // initial_normal: which way the finger comes from; used only if its first position is the centre.
  void begin(const Sphere& sphere, const Eigen::Vector3d& initial_normal) noexcept;
  const Contact& update(const Eigen::Vector3d& finger_m) noexcept;
  const Contact& contact() const noexcept { return contact_; }

 private:
  Sphere sphere_;
  Contact contact_;
};

}  // namespace jnd
