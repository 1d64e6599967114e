// Contact of a finger with a virtual object: where the proxy stays on the surface, which way the surface pushes, how
// deep the finger is. god_object.h finds it for shapes, joint_contact.h for a joint.
#pragma once

#include <Eigen/Core>

#include "devices/contact/virtual_object.h"

namespace jnd {

enum class ContactEvent { none, made, broken };

struct Contact {
  bool touching = false;
  double penetration_m = 0;                           // along the normal, >= 0
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, outward
  Eigen::Vector3d proxy_m = Eigen::Vector3d::Zero();  // nearest point of the surface
  ContactEvent event = ContactEvent::none;            // at this update
};

}  // namespace jnd
