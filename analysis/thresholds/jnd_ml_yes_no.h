// Joint maximum likelihood of the yes-no model: P("different") = Phi(l + m x).
//
// For a given m each criterion l has one best value (the likelihood is concave, a probit regression), and what remains,
// the profile in m, is concave too: one maximum, and an interval without holes.
#pragma once

#include <span>
#include <vector>

#include "analysis/thresholds/jnd_ml.h"

namespace jnd {

class YesNoProfile {
 public:
  // groups: must outlive the profile.
  explicit YesNoProfile(std::span<const MlGroup> groups);

  struct Point {
    double value = 0;      // log-likelihood at m with the best criteria
    double slope = 0;      // its derivative with respect to m
    double curvature = 0;  // its second derivative, <= 0
  };
  Point at(double m);  // m finite

  // Best criterion of each group at the m asked for last; 0 where the group is all_alike (it is infinite then).
  const std::vector<double>& criteria() const noexcept { return criteria_; }

  // The maximum, where ml_maximum says that it is finite.
  double maximum();
  // Where the profile crosses target, beyond `inside` (value >= target) in the direction of +1 or -1. The profile falls
  // below target there.
  double crossing(double inside, double direction, double target);
  double scale() const noexcept { return scale_; }  // 1 / the largest difference

 private:
  std::span<const MlGroup> groups_;
  std::vector<double> criteria_;
  double scale_ = 1;
};

}  // namespace jnd
