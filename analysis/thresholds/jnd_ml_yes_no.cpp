#include "analysis/thresholds/jnd_ml_yes_no.h"

#include <algorithm>
#include <cmath>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr int kMostYesNoSteps = 200;

// Value and derivatives of a cell's log-likelihood with respect to z = l + m x.
struct CellTerms {
  double value = 0, first = 0, second = 0;
};

CellTerms cell_terms(const MlCell& cell, double z) noexcept {
  CellTerms terms;
  if (cell.said > 0) {
    const LogNormalCdf yes = log_normal_cdf(z);
    terms.value += cell.said * yes.log_cdf;
    terms.first += cell.said * yes.inverse_mills;
    terms.second -= cell.said * yes.inverse_mills * (z + yes.inverse_mills);
  }
  if (cell.unsaid() > 0) {
    const LogNormalCdf no = log_normal_cdf(-z);
    terms.value += cell.unsaid() * no.log_cdf;
    terms.first -= cell.unsaid() * no.inverse_mills;
    terms.second -= cell.unsaid() * no.inverse_mills * (no.inverse_mills - z);
  }
  return terms;
}

struct YesNoTerms {
  double value = 0, d_l = 0, d_m = 0, d_ll = 0, d_lm = 0, d_mm = 0;
};

YesNoTerms yes_no_terms(const MlGroup& group, double l, double m) noexcept {
  YesNoTerms sum;
  for (const MlCell& cell : group.cells) {
    const CellTerms terms = cell_terms(cell, l + m * cell.x);
    sum.value += terms.value;
    sum.d_l += terms.first;
    sum.d_m += cell.x * terms.first;
    sum.d_ll += terms.second;
    sum.d_lm += cell.x * terms.second;
    sum.d_mm += cell.x * cell.x * terms.second;
  }
  return sum;
}

// Newton's search for the zero of a falling function, kept inside what is known of the zero's place.
class FallingZero {
 public:
  FallingZero(double start, double longest, double least) : at_(start), longest_(longest), least_(least) {}
  double at() const noexcept { return at_; }

  // One step from the function and its derivative at at(). False when the step was too small to matter.
  bool step(double function, double derivative) noexcept {
    if (function == 0) return false;
    (function > 0 ? low_ : high_) = at_;
    double step = derivative < 0 ? -function / derivative : std::copysign(longest_, function);
    step = std::clamp(step, -longest_, longest_);
    longest_ *= 2;
    double next = at_ + step;
    const bool matters = std::abs(step) > 1e-14 * std::abs(at_) + least_;
    if (matters && !(next > low_ && next < high_)) next = 0.5 * (low_ + high_);
    at_ = next;
    return matters;
  }

 private:
  double at_, longest_, least_;
  double low_ = -kInf, high_ = kInf;
};

// The best criterion of a group that has both answers, and the terms there.
YesNoTerms best_yes_no_criterion(const MlGroup& group, double m, double& l) noexcept {
  FallingZero zero(l, 4, 1e-15);
  YesNoTerms terms = yes_no_terms(group, l, m);
  for (int i = 0; i < kMostYesNoSteps; ++i) {
    const bool matters = zero.step(terms.d_l, terms.d_ll);
    l = zero.at();
    if (!matters) break;
    terms = yes_no_terms(group, l, m);
  }
  return terms;
}

}  // namespace

YesNoProfile::YesNoProfile(std::span<const MlGroup> groups) : groups_(groups), criteria_(groups.size(), 0.0) {
  double largest = 0;
  for (const MlGroup& group : groups_) largest = std::max(largest, group.cells.back().x);
  if (largest > 0) scale_ = 1 / largest;
}

YesNoProfile::Point YesNoProfile::at(double m) {
  Point point;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (groups_[i].all_alike) continue;
    const YesNoTerms terms = best_yes_no_criterion(groups_[i], m, criteria_[i]);
    point.value += terms.value;
    point.slope += terms.d_m;
    if (terms.d_ll < 0) point.curvature += terms.d_mm - terms.d_lm * terms.d_lm / terms.d_ll;
  }
  point.curvature = std::min(point.curvature, 0.0);
  return point;
}

double YesNoProfile::maximum() {
  FallingZero zero(0, 4 * scale_, 1e-16 * scale_);
  for (int i = 0; i < kMostYesNoSteps; ++i) {
    const Point point = at(zero.at());
    if (!zero.step(point.slope, point.curvature)) break;
  }
  return zero.at();
}

double YesNoProfile::crossing(double inside, double direction, double target) {
  // As a function of the distance t >= 0 from `inside`: h(t) = value - target, concave, from h >= 0 to below 0.
  const Point start = at(inside);
  double near = 0, far = kInf, longest = 4 * scale_, t = scale_;
  if (start.curvature < 0) t = std::min(std::sqrt(2 * (start.value - target) / -start.curvature), longest);
  for (int i = 0; i < kMostYesNoSteps; ++i) {
    const Point point = at(inside + direction * t);
    const double h = point.value - target, slope = direction * point.slope;
    (h >= 0 ? near : far) = t;
    // A concave function lies below its tangent: from outside, Newton's steps come nearer without ever passing the
    // zero.
    double next = slope < 0 ? std::min(t - h / slope, t + longest) : t + longest;
    const bool matters = std::abs(next - t) > 1e-14 * (std::abs(inside) + t) + 1e-16 * scale_;
    if (matters && !(next > near && next < far)) next = 0.5 * (near + far);
    t = next;
    if (!matters) break;
    longest *= 2;
  }
  return inside + direction * t;
}

}  // namespace jnd
