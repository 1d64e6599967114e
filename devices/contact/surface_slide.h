// How a proxy moves outside a union of spheres and capsules: straight ahead to the first surface it meets, then along
// the surface to the point that is nearest to a target (Zilles and Salisbury 1995, with the facets replaced by the
// tangent planes of round primitives). Used by god_object.cpp only.
//
// Every primitive is convex, so all of it lies behind its tangent plane at any of its points. A straight step that no
// tangent plane at the proxy forbids therefore enters none of the primitives that the proxy touches, and a ray cast
// stops it at the others. The proxy is outside the union after every step, not only at the end.
//
// Nothing here allocates after assign, throws, or loops without a bound.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "devices/contact/virtual_object.h"

namespace jnd {

// A sphere (length 0) or a capsule: all points within radius of the core, the segment that starts at a_m.
struct Round {
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit
  double length_m = 0;
  double radius_m = 0;

  Eigen::Vector3d core(const Eigen::Vector3d& point_m) const noexcept;    // nearest point of the core
  double distance_m(const Eigen::Vector3d& point_m) const noexcept;       // to the surface, negative inside
  Eigen::Vector3d normal(const Eigen::Vector3d& point_m) const noexcept;  // unit, outward; point_m not on the core
  // Share of the way along a step, 0..1, at which a point that starts outside enters; 2 where it does not.
  double entry(const Eigen::Vector3d& from_m, const Eigen::Vector3d& step_m) const noexcept;
};

// Where a slide went.
struct Slide {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  bool free = false;   // the target was reached: nothing stands between
  bool rests = false;  // sliding is over: no more steps would lead on from here
  // Resting on one primitive at the nearest point of all its surface: then in closed form, without iteration.
  bool exact = false;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // where exact
  double penetration_m = 0;                           // where exact

  // Depth of the target over the depth at which the surface stops holding the proxy (the centre of curvature), where
  // the proxy first rested and at the end. From 1 on the point is no local minimum: the proxy would slide off.
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();
  double first_bend = 0, bend = 0;
  int first_on = -1, on = -1;  // the primitive, where it rested on one alone
};

class SurfaceSlide {
 public:
  void assign(const VirtualObject& object);  // allocates
  bool empty() const noexcept { return rounds_.empty(); }
  double bound_m() const noexcept { return bound_m_; }  // every surface point is nearer to the origin
  double least_radius_m() const noexcept { return least_radius_m_; }
  const Round& round(int primitive) const noexcept { return rounds_[static_cast<std::size_t>(primitive)]; }

  // Keeps in mind the primitives that reach within a distance of a point; a slide looks at no others, so the distance must
  // be at least as long as the slide's way can be. Returns the primitive whose surface is nearest, -1 if there is none.
  int look(const Eigen::Vector3d& point_m, double reach_m) noexcept;
  // Straight from a point outside toward the target, to the first surface. True: it stands at the target.
  bool go(Eigen::Vector3d& at_m, const Eigen::Vector3d& target_m) noexcept;
  // From a point outside or on the surface to the target, or to the nearest point that sliding reaches. After
  // most_steps straight steps it ends on the way.
  Slide slide(const Eigen::Vector3d& start_m, const Eigen::Vector3d& target_m, int most_steps) noexcept;

 private:
  static constexpr int kMostTouched = 8;
  struct Near {
    int primitive = 0;
    double distance_m = 0;  // from the proxy
  };
  struct Touched {
    int primitive = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  };
  // A wanted step, and what the touched surfaces leave of it.
  struct Allowed {
    Eigen::Vector3d step_m = Eigen::Vector3d::Zero();
    std::array<int, 3> on{};  // indices of touched_
    int count = 0;            // of surfaces that hold it back
    double bend = 0;
  };

  void touch(const Eigen::Vector3d& at_m) noexcept;
  Allowed allowed(const Eigen::Vector3d& wanted_m, const Eigen::Vector3d& at_m) const noexcept;
  bool permits(const Eigen::Vector3d& step_m, double slack_m) const noexcept;
  double bend_along(const Touched& touched, const Eigen::Vector3d& direction,
                    const Eigen::Vector3d& at_m) const noexcept;
  bool advance(Eigen::Vector3d& at_m, const Eigen::Vector3d& step_m) const noexcept;
  bool finish_on(int primitive, const Eigen::Vector3d& target_m, bool settled, Slide& slide) const noexcept;

  std::vector<Round> rounds_;
  double bound_m_ = 0, least_radius_m_ = 0;
  std::vector<Near> near_;
  std::array<Touched, kMostTouched> touched_;
  int touched_count_ = 0;
};

}  // namespace jnd
