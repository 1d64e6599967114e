// Contact of a flexing joint with a virtual object: it is met at one angle, and how far the joint goes on is the depth.
#pragma once

#include "devices/contact/contact.h"

namespace jnd {

struct JointObject {
  double contact_flexion_rad = 0;  // from straight
  // What a radian beyond is called: 1 where the study's stiffness is in N/rad, the lever arm in m where it is in N/m.
  double penetration_per_rad = 1;
};

// Thread rule: the control loop's thread. Nothing allocates.
class JointContact {
 public:
  void begin(const JointObject& object) noexcept {
    object_ = object;
    contact_ = Contact{};
    contact_.normal = Eigen::Vector3d::UnitZ();
  }
  // Contact::penetration_m is then in rad or m, as the object says; the normal is the device's own z.
  const Contact& update(double flexion_rad) noexcept {
    const bool touched = contact_.touching;
    const double beyond_rad = flexion_rad - object_.contact_flexion_rad;
    contact_.touching = beyond_rad > kSurface_rad;
    contact_.penetration_m = contact_.touching ? beyond_rad * object_.penetration_per_rad : 0;
    contact_.event = contact_.touching == touched ? ContactEvent::none
                     : contact_.touching          ? ContactEvent::made
                                                  : ContactEvent::broken;
    return contact_;
  }
  const Contact& contact() const noexcept { return contact_; }

 private:
  static constexpr double kSurface_rad = 1e-12;  // less is rounding
  JointObject object_;
  Contact contact_;
};

}  // namespace jnd
