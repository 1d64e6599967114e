// Joint maximum likelihood of the differencing model: "different" where two noisy percepts lie further apart than tau,
//   P("different") = Phi((d - tau)/sqrt 2) + Phi((-d - tau)/sqrt 2),   d = m x >= 0, tau >= 0
// (Macmillan and Creelman 2005, chapter 9; sensR samediff).
//
// For a given m each tau has one best value: P("same") and P("different") are log-concave in tau. In m the likelihood
// is even, so that m = 0 is always stationary, and it may have several maxima: it is looked at on a grid first.
#pragma once

#include <span>
#include <vector>

#include "analysis/thresholds/jnd_ml.h"

namespace jnd {

class DifferencingProfile {
 public:
  // groups: must outlive the profile.
  explicit DifferencingProfile(std::span<const MlGroup> groups);

  struct Point {
    double m = 0;
    double value = 0;  // log-likelihood at m with the best criteria
    double slope = 0;  // its derivative with respect to m, divided by m: its sign tells a maximum at 0 from a minimum
  };
  Point at(double m);                                                         // m >= 0, finite
  const std::vector<double>& criteria() const noexcept { return criteria_; }  // as in YesNoProfile

  // The highest maximum, m >= 0, where ml_maximum says that it is not at plus infinity. Exactly 0 where no m > 0 is
  // better.
  Point maximum();

  struct Interval {
    double low = 0, high = 0;
  };
  // The smallest interval that holds every m with value >= target; low is 0 where m = 0 is among them.
  // at_infinity: the likelihood's maximum is there, and high is infinite. Some m has value >= target.
  Interval interval(double target, bool at_infinity);

 private:
  void lay_grid();
  double zero_between(double a, double b, double target);  // of value - target
  Point peak_between(const Point& a, const Point& b);

  std::span<const MlGroup> groups_;
  std::vector<double> criteria_;
  double highest_beyond_ = 0;  // no m above the one asked for last has a higher likelihood than this; inf: unknown
  std::vector<Point> points_;  // the grid, m ascending from 0, and the local maxima between its points
};

// The differencing model of one cell, for tau > 0 and d >= 0; exact in both tails.
struct DifferencingTerms {
  double log_different = 0, log_same = 0;
  double d_tau_different = 0, d_tau_same = 0;  // derivatives of the two logarithms with respect to tau
  double d_tau2_different = 0, d_tau2_same = 0;
  double d_d_different = 0, d_d_same = 0;  // derivatives with respect to d, divided by d
};
DifferencingTerms differencing_terms(double d, double tau) noexcept;

}  // namespace jnd
