#include "analysis/thresholds/jnd_ml_differencing.h"

#include <algorithm>
#include <cmath>

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>

#include "analysis/numerics/normal.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

namespace {

constexpr int kMostSteps = 200;
// The grid in m: from d = 0.1 at the largest difference to d = 40 at the smallest, where every answer is certain for
// any number of trials that fits an int. A single series' likelihood has its inflection below 0.6 of its maximum, so
// that two maxima lie further apart than a step of 30 %.
constexpr double kLeastD = 0.1, kLargestD = 40, kStep = 1.3;

struct DifferencingGroupTerms {
  double value = 0, d_tau = 0, d_tau2 = 0, d_m = 0;  // d_m divided by m
};

DifferencingGroupTerms differencing_group_terms(const MlGroup& group, double tau, double m) noexcept {
  DifferencingGroupTerms sum;
  for (const MlCell& cell : group.cells) {
    const DifferencingTerms terms = differencing_terms(m * cell.x, tau);
    const double x2 = cell.x * cell.x;
    if (cell.said > 0) {
      sum.value += cell.said * terms.log_different;
      sum.d_tau += cell.said * terms.d_tau_different;
      sum.d_tau2 += cell.said * terms.d_tau2_different;
      sum.d_m += cell.said * x2 * terms.d_d_different;
    }
    if (cell.unsaid() > 0) {
      sum.value += cell.unsaid() * terms.log_same;
      sum.d_tau += cell.unsaid() * terms.d_tau_same;
      sum.d_tau2 += cell.unsaid() * terms.d_tau2_same;
      sum.d_m += cell.unsaid() * x2 * terms.d_d_same;
    }
  }
  return sum;
}

// The best tau of a group that has both answers: the zero of a falling function on (0, inf).
DifferencingGroupTerms best_tau(const MlGroup& group, double m, double& tau) noexcept {
  double low = 0, high = kInf;
  DifferencingGroupTerms terms = differencing_group_terms(group, tau, m);
  for (int i = 0; i < kMostSteps && terms.d_tau != 0; ++i) {
    (terms.d_tau > 0 ? low : high) = tau;
    const double step = terms.d_tau2 < 0 ? -terms.d_tau / terms.d_tau2 : std::copysign(kInf, terms.d_tau);
    double next = tau + step;
    // Steps are the square of the one before: after one so small the next would be rounding.
    const bool last = std::abs(step) <= 1e-7 * tau;
    if (!last && !(next > low && next < high)) next = std::isinf(high) ? 2 * tau : 0.5 * (low + high);
    if (next == tau) break;
    tau = next;
    terms = differencing_group_terms(group, tau, m);
    if (last) break;
  }
  return terms;
}

}  // namespace

DifferencingProfile::DifferencingProfile(std::span<const MlGroup> groups)
    : groups_(groups), criteria_(groups.size(), 1.0) {}

DifferencingProfile::Point DifferencingProfile::at(double m) {
  Point point;
  point.m = m;
  highest_beyond_ = 0;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (groups_[i].all_alike) continue;
    const DifferencingGroupTerms terms = best_tau(groups_[i], m, criteria_[i]);
    point.value += terms.value;
    point.slope += terms.d_m;
    // A group of one difference has one maximum: past it, it falls. Of larger groups nothing is known.
    if (groups_[i].rises)
      highest_beyond_ += groups_[i].saturated;
    else if (groups_[i].cells.size() == 2 && terms.d_m < 0)
      highest_beyond_ += terms.value;
    else
      highest_beyond_ = kInf;
  }
  return point;
}

void DifferencingProfile::lay_grid() {
  if (!points_.empty()) return;
  double smallest = kInf, largest = 0;
  for (const MlGroup& group : groups_) {
    for (const MlCell& cell : group.cells) {
      if (cell.x == 0) continue;
      smallest = std::min(smallest, cell.x);
      largest = std::max(largest, cell.x);
    }
  }
  points_.push_back(at(0));
  const double last = kLargestD / smallest;
  double best = points_.back().value;
  double m = kLeastD / largest;
  while (best - highest_beyond_ <= kProfileDrop && points_.back().m < last) {
    points_.push_back(at(std::min(m, last)));
    best = std::max(best, points_.back().value);
    m *= kStep;
  }
  std::vector<Point> peaks;
  for (std::size_t i = 1; i < points_.size(); ++i)
    if (points_[i - 1].slope > 0 && points_[i].slope < 0) peaks.push_back(peak_between(points_[i - 1], points_[i]));
  points_.insert(points_.end(), peaks.begin(), peaks.end());
  std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) { return a.m < b.m; });
}

DifferencingProfile::Point DifferencingProfile::peak_between(const Point& a, const Point& b) {
  boost::uintmax_t steps = kMostSteps;
  const auto slope = [this](double m) { return at(m).slope; };
  const auto [low, high] = boost::math::tools::toms748_solve(slope, a.m, b.m, a.slope, b.slope,
                                                             boost::math::tools::eps_tolerance<double>(50), steps);
  return at(0.5 * (low + high));
}

DifferencingProfile::Point DifferencingProfile::maximum() {
  lay_grid();
  // The first of equals: 0 where nothing is better.
  Point best = *std::max_element(points_.begin(), points_.end(),
                                 [](const Point& a, const Point& b) { return a.value < b.value; });
  return at(best.m);  // once more, for the criteria
}

double DifferencingProfile::zero_between(double a, double b, double target) {
  boost::uintmax_t steps = kMostSteps;
  const auto above = [this, target](double m) { return at(m).value - target; };
  const double at_a = above(a), at_b = above(b);
  if (at_a == 0) return a;
  if (at_b == 0) return b;
  const auto [low, high] =
      boost::math::tools::toms748_solve(above, a, b, at_a, at_b, boost::math::tools::eps_tolerance<double>(50), steps);
  return 0.5 * (low + high);
}

DifferencingProfile::Interval DifferencingProfile::interval(double target, bool at_infinity) {
  lay_grid();
  const auto inside = [target](const Point& point) { return point.value >= target; };
  Interval found;
  const auto first = std::find_if(points_.begin(), points_.end(), inside);
  if (first == points_.end()) {
    // The maximum is at infinity and the target so near to it that the grid does not reach it.
    double m = points_.back().m;
    while (at(2 * m).value < target && m < 1e300) m *= 2;
    found.low = zero_between(m, 2 * m, target);
  } else if (first != points_.begin()) {
    found.low = zero_between((first - 1)->m, first->m, target);
  }
  if (at_infinity) {
    found.high = kInf;
    return found;
  }
  const auto last = std::find_if(points_.rbegin(), points_.rend(), inside);
  double near = last->m, far = last == points_.rbegin() ? 2 * near : (last - 1)->m;
  while (at(far).value >= target) {
    near = far;
    far *= 2;
  }
  found.high = zero_between(near, far, target);
  return found;
}

// The differencing model of one cell and its derivatives.

namespace {

constexpr double kRootHalf = boost::math::constants::half_root_two<double>();

// log P("same") for a small tau, where the difference of two distribution functions would lose its digits: its integral
// instead, exp(-d^2/4) / sqrt pi times that of exp(-t^2/4) cosh(t d/2) over 0..tau, which is flat there.
double log_narrow_same(double d, double tau) noexcept {
  const auto density = [d](double t) { return std::exp(-0.25 * t * t) * std::cosh(0.5 * t * d); };
  const double integral = boost::math::quadrature::gauss<double, 7>::integrate(density, 0.0, tau);
  return std::log(integral * boost::math::constants::one_div_root_pi<double>()) - 0.25 * d * d;
}
bool is_narrow(double d, double tau) noexcept {
  return tau * std::fmax(1.0, d) < 0.2;
}

// What a cell is made of: the two probabilities and, relative to each, the density of the absolute percept at tau,
// (phi(a) + phi(b)) / sqrt 2, and the change of P("different") with d, divided by d.
struct Parts {
  double log_different, log_same;
  double density_by_different, density_by_same;
  double change_by_different, change_by_same;
};

// far = exp(-d tau) = phi(b) / phi(a); relative = (1 - far) / d, which tends to tau.
Parts plain_parts(double d, double tau, double a, double b, double far, double relative) noexcept {
  const double beyond = normal_cdf(-a), across = normal_cdf(-b);
  const double different = beyond + across;
  const double same = is_narrow(d, tau) ? std::exp(log_narrow_same(d, tau))
                      : a > 0           ? 1 - different
                                        : normal_cdf(a) - across;
  const double phi = normal_density(a) * kRootHalf;
  return {different > 0.5 ? std::log1p(-same) : std::log(different),
          same > 0.5 ? std::log1p(-different) : std::log(same),
          phi * (1 + far) / different,
          phi * (1 + far) / same,
          phi * relative / different,
          phi * relative / same};
}

// The same by logarithms, where the probabilities underflow.
Parts far_parts(double d, double tau, double a, double b, double far, double relative) noexcept {
  const double log_across = log_normal_cdf(-b).log_cdf, log_beyond = log_normal_cdf(-a).log_cdf;
  const double log_different = log_beyond + std::log1p(std::exp(log_across - log_beyond));
  double log_same = 0;
  if (is_narrow(d, tau)) {
    log_same = log_narrow_same(d, tau);
  } else if (a > 0) {
    log_same = std::log1p(-std::exp(log_different));
  } else {
    const double log_within = log_normal_cdf(a).log_cdf;
    log_same = log_within + std::log1p(-std::exp(log_across - log_within));
  }
  const double log_phi = log_normal_density(a) + std::log(kRootHalf);
  const double log_density = log_phi + std::log1p(far), log_change = log_phi + std::log(relative);
  return {log_different,
          log_same,
          std::exp(log_density - log_different),
          std::exp(log_density - log_same),
          std::exp(log_change - log_different),
          std::exp(log_change - log_same)};
}

}  // namespace

DifferencingTerms differencing_terms(double d, double tau) noexcept {
  constexpr double kPlain = 25;  // Phi(-25) is about 1e-138
  const double a = (tau - d) * kRootHalf, b = (tau + d) * kRootHalf;
  const double far = std::exp(-d * tau);
  const double relative = d * tau > 1e-300 ? -std::expm1(-d * tau) / d : tau;
  const Parts parts = std::abs(a) < kPlain && b < kPlain ? plain_parts(d, tau, a, b, far, relative)
                                                         : far_parts(d, tau, a, b, far, relative);
  const double log_density_slope = -(a + b * far) / (1 + far) * kRootHalf;
  DifferencingTerms terms;
  terms.log_different = parts.log_different;
  terms.log_same = parts.log_same;
  terms.d_tau_different = -parts.density_by_different;
  terms.d_tau_same = parts.density_by_same;
  terms.d_tau2_different = -parts.density_by_different * (log_density_slope + parts.density_by_different);
  terms.d_tau2_same = parts.density_by_same * (log_density_slope - parts.density_by_same);
  terms.d_d_different = parts.change_by_different;
  terms.d_d_same = -parts.change_by_same;
  return terms;
}

}  // namespace jnd
