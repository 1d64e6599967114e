#include "devices/contact/surface_slide.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr double kTouch_m = 1e-10;    // a surface this near is touched, and its tangent plane a constraint
constexpr double kSettled_m = 1e-10;  // a slide shorter than this is over
constexpr double kReached_m = 1e-12;  // a target this near is reached
constexpr double kCore_m = 1e-9;      // nearer to the core than this the direction is rounding
constexpr double kInside_m = 1e-15;   // deeper than this is inside, less is rounding
constexpr double kSlack = 1e-12;      // of a step: less than this of it against a normal is rounding
constexpr double kParallel = 1e-10;   // sine of the angle below which two normals are one
// An arc of at most half a turn is at most pi/2 times its chord: no surface farther away than this many chords is met.
constexpr double kArc = 1.6;
// A step may go this many times as far as the tangent's nearest point. At 2 it ends as far from the target as it began,
// so the way never leaves the ball that look was asked for.
constexpr double kMostReach = 2;

// First root of a t^2 + 2 b t + c = 0, c >= 0, written so that small c keep their digits; 2 where there is none in
// 0..1.
double first_root(double a, double b, double c) noexcept {
  if (b >= 0) return 2;
  if (c <= 0) return 0;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return 2;
  const double t = c / (-b + std::sqrt(discriminant));
  return t <= 1 ? t : 2;
}

double sphere_entry(const Eigen::Vector3d& from_centre_m, double radius_m, const Eigen::Vector3d& step_m) noexcept {
  const double b = from_centre_m.dot(step_m);
  if (b >= 0) return 2;
  const double distance = from_centre_m.norm();
  return first_root(step_m.squaredNorm(), b, (distance - radius_m) * (distance + radius_m));
}

}  // namespace

Eigen::Vector3d Round::core(const Eigen::Vector3d& point_m) const noexcept {
  if (length_m == 0) return a_m;
  return a_m + std::clamp((point_m - a_m).dot(axis), 0.0, length_m) * axis;
}

double Round::distance_m(const Eigen::Vector3d& point_m) const noexcept {
  return (point_m - core(point_m)).norm() - radius_m;
}

Eigen::Vector3d Round::normal(const Eigen::Vector3d& point_m) const noexcept {
  return (point_m - core(point_m)).normalized();
}

double Round::entry(const Eigen::Vector3d& from_m, const Eigen::Vector3d& step_m) const noexcept {
  const Eigen::Vector3d from_a = from_m - a_m;
  double first = sphere_entry(from_a, radius_m, step_m);
  if (length_m == 0) return first;
  first = std::min(first, sphere_entry(from_a - length_m * axis, radius_m, step_m));
  // The barrel. A start within the endless cylinder can only enter through an end.
  const double along = from_a.dot(axis), step_along = step_m.dot(axis);
  const Eigen::Vector3d across = from_a - along * axis, step_across = step_m - step_along * axis;
  const double distance = across.norm();
  if (distance < radius_m) return first;
  const double t =
      first_root(step_across.squaredNorm(), across.dot(step_across), (distance - radius_m) * (distance + radius_m));
  const double at = along + t * step_along;
  return at >= 0 && at <= length_m ? std::min(first, t) : first;
}

void SurfaceSlide::assign(const VirtualObject& object) {
  rounds_.clear();
  for (const Sphere& sphere : object.spheres) rounds_.push_back({.a_m = sphere.centre_m, .radius_m = sphere.radius_m});
  for (const Capsule& capsule : object.capsules) {
    const Eigen::Vector3d whole = capsule.b_m - capsule.a_m;
    rounds_.push_back(
        {.a_m = capsule.a_m, .axis = whole.normalized(), .length_m = whole.norm(), .radius_m = capsule.radius_m});
  }
  near_.reserve(rounds_.size());
  near_.clear();
  touched_count_ = 0;
  bound_m_ = 0;
  least_radius_m_ = kInf;
  for (const Round& round : rounds_) {
    const double ends = std::max(round.a_m.norm(), (round.a_m + round.length_m * round.axis).norm());
    bound_m_ = std::max(bound_m_, ends + round.radius_m);
    least_radius_m_ = std::min(least_radius_m_, round.radius_m);
  }
}

int SurfaceSlide::look(const Eigen::Vector3d& point_m, double reach_m) noexcept {
  near_.clear();
  int nearest = -1;
  double least = kInf;
  for (std::size_t i = 0; i < rounds_.size(); ++i) {
    const double distance = rounds_[i].distance_m(point_m);
    if (distance <= reach_m + kTouch_m) near_.push_back({.primitive = static_cast<int>(i)});
    if (distance < least) {
      least = distance;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

void SurfaceSlide::touch(const Eigen::Vector3d& at_m) noexcept {
  touched_count_ = 0;
  for (Near& near : near_) {
    const Round& round = rounds_[static_cast<std::size_t>(near.primitive)];
    near.distance_m = round.distance_m(at_m);
    if (near.distance_m <= kTouch_m && touched_count_ < kMostTouched)
      touched_[static_cast<std::size_t>(touched_count_++)] = {.primitive = near.primitive,
                                                              .normal = round.normal(at_m)};
  }
}

bool SurfaceSlide::permits(const Eigen::Vector3d& step_m, double slack_m) const noexcept {
  for (int i = 0; i < touched_count_; ++i)
    if (touched_[static_cast<std::size_t>(i)].normal.dot(step_m) < -slack_m) return false;
  return true;
}

double SurfaceSlide::bend_along(const Touched& touched, const Eigen::Vector3d& direction,
                                const Eigen::Vector3d& at_m) const noexcept {
  const Round& round = rounds_[static_cast<std::size_t>(touched.primitive)];
  const double along = (at_m - round.a_m).dot(round.axis);
  const bool barrel = round.length_m > 0 && along > 0 && along < round.length_m;
  const double share = barrel ? direction.dot(round.axis) : 0;
  return (1 - share * share) / round.radius_m;
}

// The wanted step projected onto the cone that the touched tangent planes leave: of all projections onto their faces
// and edges that stay in the cone, the longest.
SurfaceSlide::Allowed SurfaceSlide::allowed(const Eigen::Vector3d& wanted_m,
                                            const Eigen::Vector3d& at_m) const noexcept {
  const double slack_m = kSlack * wanted_m.norm();
  Allowed best{.step_m = wanted_m};
  if (permits(wanted_m, slack_m)) return best;
  best.step_m.setZero();
  best.count = 3;
  double longest = -1;
  for (int i = 0; i < touched_count_; ++i) {
    const Touched& one = touched_[static_cast<std::size_t>(i)];
    const double depth = -wanted_m.dot(one.normal);
    if (depth <= 0) continue;  // would pull
    const Eigen::Vector3d step = wanted_m + depth * one.normal;
    if (step.squaredNorm() <= longest || !permits(step, slack_m)) continue;
    longest = step.squaredNorm();
    const Round& round = rounds_[static_cast<std::size_t>(one.primitive)];
    best = {.step_m = step, .on = {i, 0, 0}, .count = 1, .bend = depth / round.radius_m};
  }
  if (best.count == 1) return best;  // an edge is part of a face: it is never farther along
  for (int i = 0; i < touched_count_; ++i) {
    for (int j = i + 1; j < touched_count_; ++j) {
      const Touched& one = touched_[static_cast<std::size_t>(i)];
      const Touched& other = touched_[static_cast<std::size_t>(j)];
      Eigen::Vector3d edge = one.normal.cross(other.normal);
      const double sine = edge.norm();
      if (sine < kParallel) continue;
      edge /= sine;
      const Eigen::Vector3d step = wanted_m.dot(edge) * edge;
      if (step.squaredNorm() <= longest || !permits(step, slack_m)) continue;
      longest = step.squaredNorm();
      // wanted = step - push_one * one - push_other * other
      const double cosine = one.normal.dot(other.normal), by_one = -wanted_m.dot(one.normal),
                   by_other = -wanted_m.dot(other.normal), scale = 1 / (sine * sine);
      const double push_one = std::max((by_one - cosine * by_other) * scale, 0.0);
      const double push_other = std::max((by_other - cosine * by_one) * scale, 0.0);
      best = {.step_m = step,
              .on = {i, j, 0},
              .count = 2,
              .bend = push_one * bend_along(one, edge, at_m) + push_other * bend_along(other, edge, at_m)};
    }
  }
  return best;
}

// True: the whole step was free. False: it stands at the first surface.
bool SurfaceSlide::advance(Eigen::Vector3d& at_m, const Eigen::Vector3d& step_m) const noexcept {
  const double length = step_m.norm();
  double share = 1;
  int met = -1;
  for (const Near& near : near_) {
    // Touched surfaces do not stand in the way of a step that their tangent planes allow.
    if (near.distance_m > length || near.distance_m <= kTouch_m) continue;
    const double entry = rounds_[static_cast<std::size_t>(near.primitive)].entry(at_m, step_m);
    if (entry <= 1 && (met < 0 || entry < share)) {
      share = entry;
      met = near.primitive;
    }
  }
  if (met < 0) {
    at_m += step_m;
    return true;
  }
  at_m += share * step_m;
  const Round& round = rounds_[static_cast<std::size_t>(met)];
  const double inside = -round.distance_m(at_m);
  if (inside > 0) at_m += inside * round.normal(at_m);  // rounding of the root
  return false;
}

bool SurfaceSlide::go(Eigen::Vector3d& at_m, const Eigen::Vector3d& target_m) noexcept {
  touch(at_m);
  const Eigen::Vector3d step = target_m - at_m;
  if (!permits(step, 0)) return false;
  if (!advance(at_m, step)) return false;
  at_m = target_m;
  return true;
}

// Ends the slide at the nearest point of one primitive's surface, if the way there over that surface is surely free.
bool SurfaceSlide::finish_on(int primitive, const Eigen::Vector3d& target_m, bool settled,
                             Slide& slide) const noexcept {
  const Round& round = rounds_[static_cast<std::size_t>(primitive)];
  const Eigen::Vector3d core = round.core(target_m);
  const Eigen::Vector3d outward = target_m - core;
  const double distance = std::sqrt(outward.squaredNorm());
  if (distance <= kCore_m || distance >= round.radius_m) return false;
  const Eigen::Vector3d normal = outward * (1 / distance);
  const Eigen::Vector3d end = core + round.radius_m * normal;
  const double chord = (end - slide.at_m).norm();
  for (const Near& near : near_) {
    if (near.primitive == primitive || near.distance_m > kArc * chord) continue;
    if (!settled && near.distance_m > kTouch_m) return false;
    if (rounds_[static_cast<std::size_t>(near.primitive)].distance_m(end) < -kInside_m) return false;
  }
  slide.at_m = end;
  slide.exact = slide.rests = true;
  slide.normal = normal;
  slide.penetration_m = round.radius_m - distance;
  slide.bend = slide.penetration_m / round.radius_m;
  return true;
}

Slide SurfaceSlide::slide(const Eigen::Vector3d& start_m, const Eigen::Vector3d& target_m, int most_steps) noexcept {
  Slide slide;
  slide.at_m = slide.first_m = start_m;
  bool rested = false;
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::Vector3d wanted = target_m - slide.at_m;
    if (wanted.squaredNorm() <= kReached_m * kReached_m) {
      slide.free = true;
      return slide;
    }
    touch(slide.at_m);
    const Allowed allowed = this->allowed(wanted, slide.at_m);
    if (allowed.count == 0) {
      if (!advance(slide.at_m, wanted)) continue;
      slide.at_m = target_m;
      slide.free = true;
      return slide;
    }
    const int alone = allowed.count == 1 ? touched_[static_cast<std::size_t>(allowed.on[0])].primitive : -1;
    slide.bend = allowed.bend;
    slide.on = alone;
    if (!rested) {
      rested = true;
      slide.first_m = slide.at_m;
      slide.first_bend = allowed.bend;
      slide.first_on = alone;
    }
    const bool settled = allowed.step_m.squaredNorm() <= kSettled_m * kSettled_m;
    if (alone >= 0 && finish_on(alone, target_m, settled, slide)) return slide;
    if (settled) {
      slide.rests = true;
      return slide;
    }
    // The nearest point of a tangent falls short of the surface's by 1 - bend, to first order.
    double curved = allowed.bend;
    if (alone >= 0)
      curved *= round(alone).radius_m *
                bend_along(touched_[static_cast<std::size_t>(allowed.on[0])], allowed.step_m.normalized(), slide.at_m);
    const double reach = 1 / std::max(1 - curved, 1 / kMostReach);
    (void)advance(slide.at_m, reach * allowed.step_m);
  }
  return slide;
}

}  // namespace jnd
