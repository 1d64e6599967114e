// God-object contact (Zilles and Salisbury 1995) of one finger with a virtual object: the proxy follows the finger, but
// stays outside. Where the finger has gone in, the proxy rests at the nearest surface point that it reached by sliding,
// and the surface pushes from the finger to the proxy.
//
// Without friction a proxy slides off a round part as soon as the finger is past its axis, and the force would turn
// round within a tick or two: one falls through an ear. There the paper's facets would hold, and so does this proxy:
// once the finger has come nearer to the axis than an eighth of the radius, or past it, the proxy stays (along a
// capsule it still follows, where that brings it nearer). It goes on when the finger comes back up, leaves by the way
// it came, or sliding leads to a lasting rest on another part that pushes to the same side, as from a ridge down to its
// foot. A finger that misses the axis by more slips off and out, as a fingertip does. A lone sphere keeps the law of
// convex bodies, the nearest point.
#pragma once

#include <Eigen/Core>

#include "devices/contact/surface_slide.h"
#include "devices/contact/virtual_object.h"

namespace jnd {

// Contact of a finger with a virtual object: where the proxy stays on the surface, which way the surface pushes, how
// deep the finger is. GodObject finds it for shapes, JointContact for a joint.
enum class ContactEvent { none, made, broken };

struct Contact {
  bool touching = false;
  double penetration_m = 0;                           // along the normal, >= 0
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, outward
  Eigen::Vector3d proxy_m = Eigen::Vector3d::Zero();  // nearest point of the surface
  ContactEvent event = ContactEvent::none;            // at this update
};

// Contact of a flexing joint with a virtual object: it is met at one angle, and how far the joint goes on is the depth.
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

// Thread rule: one thread at a time. begin may allocate; update never does.
class GodObject {
 public:
  // object: one that passes check(). initial_normal: unit, which way the finger comes from; used only if its first
  // position is inside (for a lone sphere: at the centre).
  void begin(const VirtualObject& object, const Eigen::Vector3d& initial_normal);

  // finger_m: where the finger is now. In a tick it may have gone any way: the proxy goes straight, and stops at the
  // first surface. A position that is not finite is no contact (event broken if there was one) and no crash; but a
  // contact does not say so, therefore the caller must look at the position itself. The next finite position goes on
  // from the last one. Not touching, proxy_m and normal are those of the nearest surface point.
  const Contact& update(const Eigen::Vector3d& finger_m) noexcept;
  const Contact& contact() const noexcept { return contact_; }

 private:
  enum class Kind { sphere, plane, many };

  void touch_plane(const Eigen::Vector3d& finger_m) noexcept;
  void touch_many(const Eigen::Vector3d& finger_m) noexcept;
  Slide follow(const Eigen::Vector3d& target_m, int most_steps) noexcept;

  Kind kind_ = Kind::sphere;
  Sphere sphere_;
  Plane plane_;
  Contact contact_;
  // Of unions.
  SurfaceSlide surface_;
  Eigen::Vector3d initial_normal_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d proxy_m_ = Eigen::Vector3d::Zero();   // outside or on the surface; the finger itself where it is free
  Eigen::Vector3d finger_m_ = Eigen::Vector3d::Zero();  // the last one
  bool placed_ = false;                                 // both of them mean something
};

}  // namespace jnd
