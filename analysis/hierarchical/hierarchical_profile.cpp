#include "analysis/hierarchical/hierarchical_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/numerics/profile_interval.h"

namespace jnd {

namespace {

constexpr double kCloseEnough = 1e-5;  // of 1 + the value of an end
constexpr double kConfirmed = 3e-5;    // of ln L: so much more than at an end is none
constexpr int kMostLeftBehind = 6;     // ends that other starts find more at

}  // namespace

std::vector<HierarchicalMaximum> with_other_spreads(const HierarchicalForm& form, const HierarchicalMaximum& from,
                                                    double criterion_unit) {
  std::vector<HierarchicalMaximum> others;
  for (const auto& [tu, tv, tw] : {std::array{0.05, 0.05, 0.05}, {0.6, 0.4, 0.6}}) {
    HierarchicalMaximum one = from;
    one.curvature.clear();
    if (form.tu) one.place.tu = tu;
    if (form.tv) one.place.tv = tv;
    if (form.tv) std::fill(one.place.own_tv.begin(), one.place.own_tv.end(), tv);
    if (form.tw) one.place.tw = tw * criterion_unit;
    if (form.rho) one.place.rho = 0;
    others.push_back(std::move(one));
  }
  return others;
}

Profile::Profile(HierarchicalSearch& search, const HierarchicalMaximum& best, const HeldNumber& number)
    : search_(search), best_(best), number_(number) {
  points_.push_back({number.estimate, 0, best, true});
}

HierarchicalMaximum Profile::searched(double value, const HierarchicalMaximum& from) const {
  const auto [form, start] = number_.hold(value, from);
  return search_.climbed(form, start, most_work_);
}

const Profile::Point& Profile::keep(double value, HierarchicalMaximum maximum) {
  if (maximum.log_likelihood > best_.log_likelihood + kTold) throw BetterMaximum{std::move(maximum)};
  const double drop = std::max(0.0, best_.log_likelihood - maximum.log_likelihood);
  const auto at = std::lower_bound(points_.begin(), points_.end(), value,
                                   [](const Point& one, double wanted) { return one.value < wanted; });
  if (at != points_.end() && at->value == value) {
    if (drop < at->drop) *at = {value, drop, std::move(maximum), at->confirmed};
    return *at;
  }
  return *points_.insert(at, {value, drop, std::move(maximum), false});
}

const Profile::Point& Profile::nearest(double value) const {
  return *std::min_element(points_.begin(), points_.end(), [value](const Point& a, const Point& b) {
    return std::abs(a.value - value) < std::abs(b.value - value);
  });
}

const Profile::Point& Profile::look(double value) {
  return keep(value, searched(value, nearest(value).maximum));
}

const Profile::Point& Profile::confirm(double value) {
  HierarchicalMaximum found = look(value).maximum;
  const auto [form, start] = number_.hold(value, best_);
  search_.improve(form, with_other_spreads(form, start, search_.unit()), found, most_work_);
  keep(value, found);
  Point& point =
      *std::find_if(points_.begin(), points_.end(), [value](const Point& one) { return one.value == value; });
  point.confirmed = true;
  return point;
}

double Profile::drop(double value, double most_work) {
  most_work_ = most_work;
  const double found = confirm(value).drop;
  return worked() ? kNaN : found;
}

// Between a value with less drop than an interval ends at and one with more.
double Profile::crossing(double inside, double outside, double first) {
  const auto profile = [this](double value) {
    const Point& point = look(value);
    return ProfilePoint{worked() ? kProfileDrop : point.drop, -number_.slope(search_.likelihood(), point.maximum)};
  };
  return profile_bound(profile, inside, outside, first, kCloseEnough);
}

double Profile::end(double side, EndsStatus& status) {
  const double limit = side < 0 ? number_.lowest : number_.highest,
               open = side < 0 ? number_.open_low : number_.open_high;
  if (side * (limit - number_.estimate) <= 0) return open;
  const double root = std::sqrt(2 * kProfileDrop);
  // What is known already: from there on.
  const auto known_inside = [&] {
    double inside = number_.estimate;
    for (bool farther = true; farther;) {
      farther = false;
      const Point* next = nullptr;
      for (const Point& point : points_)
        if (side * (point.value - inside) > 0 && (next == nullptr || side * (next->value - point.value) > 0))
          next = &point;
      if (next != nullptr && next->drop < kProfileDrop) {
        inside = next->value;
        farther = true;
      }
    }
    return inside;
  };
  const auto known_outside = [&](double inside) {
    double outside = kNaN;
    for (const Point& point : points_)
      if (side * (point.value - inside) > 0 && point.drop > kProfileDrop &&
          (std::isnan(outside) || side * (outside - point.value) > 0))
        outside = point.value;
    return outside;
  };
  const auto drop_at = [&](double value) {
    for (const Point& point : points_)
      if (point.value == value) return point.drop;
    return kNaN;
  };
  constexpr double kBeside = 1e-3;
  const auto [form, beside] = number_.hold(number_.estimate + kBeside * number_.unit, best_);
  const double error = standard_error(form, best_, beside, kBeside * number_.unit, search_.unit());
  double reach = number_.unit / 3;
  if (root * error < reach) reach = root * error;
  for (int left_behind = 0; left_behind <= kMostLeftBehind; ++left_behind) {
    double inside = known_inside(), outside = known_outside(inside);
    // Outwards, as far as a parabola promises.
    while (std::isnan(outside) && side * (limit - inside) > 0) {
      if (worked()) break;
      const double from = side * (inside - number_.estimate), known = drop_at(inside);
      if (from > 0 && known > 0)
        reach = std::clamp(from * (root / std::sqrt(2 * known) * 1.03 - 1), from / 8, 3 * from);
      double next = inside + side * std::max(reach, number_.unit / 50);
      if (side * (limit - next) < number_.unit / 20) next = limit;
      (look(next).drop > kProfileDrop ? outside : inside) = next;
    }
    if (worked()) break;
    if (std::isnan(outside)) return open;
    const double low_root = std::sqrt(2 * drop_at(inside)), high_root = std::sqrt(2 * drop_at(outside));
    const double first = inside + (outside - inside) * (root - low_root) / (high_root - low_root);
    const double found = crossing(inside, outside, first);
    const Point point = confirm(found);
    if (worked()) break;
    if (point.drop > kProfileDrop - kConfirmed) return found;
    // The points beyond were searched from less good ones.
    std::erase_if(points_, [&](const Point& one) { return !one.confirmed && side * (one.value - found) > 0; });
  }
  status = worked() ? EndsStatus::out_of_work : EndsStatus::not_converged;
  return kNaN;
}

ProfileEnds Profile::ends(double most_work) {
  most_work_ = most_work;
  ProfileEnds found;
  found.status = EndsStatus::ok;
  found.low = end(-1, found.status);
  if (found.status == EndsStatus::ok) found.high = end(1, found.status);
  if (found.status != EndsStatus::ok) found.low = found.high = kNaN;
  return found;
}

}  // namespace jnd
