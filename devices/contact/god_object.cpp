#include "devices/contact/god_object.h"

#include <algorithm>
#include <cmath>

namespace jnd {

namespace {

// Those of contact.cpp.
constexpr double kCentre_m = 1e-9;
constexpr double kSurface_m = 1e-12;

// Less deep than this the direction from finger to proxy is rounding: the surface's own normal is taken.
constexpr double kShallow_m = 1e-9;
// The part of a radius about the axis in which a proxy is held.
constexpr double kCore = 0.125;
// In contact a long way of the finger is followed in parts, so that its speed does not decide where the proxy goes.
constexpr double kMostParts = 8;
// Steps of sliding, of all parts but the last and of the last. On one primitive it takes one, in a groove about ten,
// and more where the groove is nearly as deep as it is round.
constexpr int kStepsOnTheWay = 8, kMostSteps = 128;
// Farther away is no position of a finger, m.
constexpr double kFar_m = 1e6;

}  // namespace

void GodObject::begin(const VirtualObject& object, const Eigen::Vector3d& initial_normal) {
  contact_ = Contact{};
  contact_.normal = initial_normal;
  initial_normal_ = initial_normal;
  placed_ = false;
  if (object.plane) {
    kind_ = Kind::plane;
    plane_ = *object.plane;
  } else if (object.spheres.size() == 1 && object.capsules.empty()) {
    kind_ = Kind::sphere;
    sphere_ = object.spheres.front();
  } else {
    kind_ = Kind::many;
    surface_.assign(object);
  }
}

const Contact& GodObject::update(const Eigen::Vector3d& finger_m) noexcept {
  const bool touched = contact_.touching;
  if (kind_ == Kind::sphere) {
    const Eigen::Vector3d from_centre = finger_m - sphere_.centre_m;
    const double distance = std::sqrt(from_centre.squaredNorm());
    if (distance > kCentre_m) contact_.normal = from_centre * (1 / distance);
    contact_.touching = sphere_.radius_m - distance > kSurface_m;
    contact_.penetration_m = contact_.touching ? sphere_.radius_m - distance : 0;
    contact_.proxy_m = sphere_.centre_m + sphere_.radius_m * contact_.normal;
  } else if (kind_ == Kind::plane) {
    touch_plane(finger_m);
  } else {
    touch_many(finger_m);
  }
  contact_.event = contact_.touching == touched ? ContactEvent::none
                   : contact_.touching          ? ContactEvent::made
                                                : ContactEvent::broken;
  return contact_;
}

void GodObject::touch_plane(const Eigen::Vector3d& finger_m) noexcept {
  const double above = plane_.normal.dot(finger_m - plane_.point_m);
  contact_.touching = -above > kSurface_m;
  contact_.penetration_m = contact_.touching ? -above : 0;
  contact_.normal = plane_.normal;
  if (std::isfinite(above)) contact_.proxy_m = finger_m - above * plane_.normal;
}

// Slides to the target, unless that would be a fall through a round part: then the proxy is held.
Slide GodObject::follow(const Eigen::Vector3d& target_m, int most_steps) noexcept {
  surface_.look(target_m, (proxy_m_ - target_m).norm());
  Slide slide = surface_.slide(proxy_m_, target_m, most_steps);
  constexpr double kHeld = 1 - kCore;
  if (slide.first_bend <= kHeld) return slide;
  const bool same_side = (slide.at_m - target_m).dot(slide.first_m - target_m) > 0;
  const bool round_the_part = slide.on >= 0 && slide.on == slide.first_on;
  if (slide.rests && slide.bend <= kHeld && same_side && !round_the_part) return slide;
  Slide held;
  held.at_m = slide.first_m;
  if (slide.first_on >= 0) {
    // Along the axis it follows: to the nearest point from above the axis, where a local minimum still exists.
    const Round& round = surface_.round(slide.first_on);
    const Eigen::Vector3d above_m = round.core(target_m) + kCore * round.radius_m * round.normal(slide.first_m);
    surface_.look(above_m, (slide.first_m - above_m).norm());
    const Slide along = surface_.slide(slide.first_m, above_m, most_steps);
    // Never farther from the finger: a finger at rest would be sent to and fro between two places.
    const bool nearer = (along.at_m - target_m).squaredNorm() <= (slide.first_m - target_m).squaredNorm();
    if (!along.free && nearer) held.at_m = along.at_m;
  }
  return held;
}

void GodObject::touch_many(const Eigen::Vector3d& finger_m) noexcept {
  contact_.touching = false;
  contact_.penetration_m = 0;
  // Not a position, or not a number.
  if (surface_.empty() || !(finger_m.cwiseAbs().sum() < kFar_m)) return;

  if (!placed_) {
    const int nearest = surface_.look(finger_m, 0);
    const bool outside = surface_.round(nearest).distance_m(finger_m) >= 0;
    const double clear_m = 2 * (surface_.bound_m() + finger_m.norm());
    proxy_m_ = finger_m_ = outside ? finger_m : Eigen::Vector3d(finger_m + clear_m * initial_normal_);
    placed_ = true;
  }
  Slide slide;
  int nearest = -1;
  double parts = 1;  // a finger that was free goes on from the surface it meets, and is caught there
  const Eigen::Vector3d way = finger_m - finger_m_;
  if (proxy_m_ == finger_m_) {
    nearest = surface_.look(finger_m, way.norm());
    slide.free = surface_.go(proxy_m_, finger_m);
  } else {
    parts = std::clamp(std::ceil(way.norm() / (kCore * surface_.least_radius_m())), 1.0, kMostParts);
  }
  if (!slide.free) {
    const int steps = static_cast<int>(parts);
    for (int part = 1; part <= steps; ++part) {
      const bool last = part == steps;
      slide = follow(last ? finger_m : Eigen::Vector3d(finger_m_ + way * (part / parts)),
                     last ? kMostSteps : kStepsOnTheWay);
      proxy_m_ = slide.at_m;
    }
    if (slide.free) nearest = surface_.look(finger_m, 0);
  }
  finger_m_ = finger_m;

  const Eigen::Vector3d to_proxy = proxy_m_ - finger_m;
  const double depth = slide.exact ? slide.penetration_m : to_proxy.norm();
  if (slide.free || !(depth > kSurface_m)) {
    if (nearest < 0) nearest = surface_.look(finger_m, 0);
    const Round& round = surface_.round(nearest);
    contact_.normal = round.normal(finger_m);
    contact_.proxy_m = finger_m - round.distance_m(finger_m) * contact_.normal;
    return;
  }
  contact_.touching = true;
  contact_.penetration_m = depth;
  contact_.proxy_m = proxy_m_;
  if (slide.exact)
    contact_.normal = slide.normal;
  else if (depth > kShallow_m)
    contact_.normal = to_proxy / depth;
  else
    contact_.normal = surface_.round(surface_.look(proxy_m_, 0)).normal(proxy_m_);
}

}  // namespace jnd
