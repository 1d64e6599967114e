// The likelihood of several groups that share some of their parameters, and where the search for its largest value
// begins.
#pragma once

#include <span>
#include <vector>

#include "analysis/psychometric/psychometric_compare.h"
#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

// Variables: lapse, guess, then
//   own_location  c1, c0 of each group            own_function  c0, c1 of each group
//   own_slope     t of the common PSE, c1 of each group
// all on the t axis of the pooled data. same_function is a single fit of the pooled data, and not for this class.
class JointLikelihood {
 public:
  JointLikelihood(std::span<const std::vector<PsychometricLevel>> groups, const PsychometricModel& model,
                  PsychometricSharing sharing, const PsychometricData& pooled);

  std::size_t variables() const noexcept { return box_.lower.size(); }
  const NewtonBox& box() const noexcept { return box_; }
  const std::vector<PsychometricLikelihood>& groups() const noexcept { return groups_; }

  double value(const std::vector<double>& place) const;
  void derivatives(const std::vector<double>& place, NewtonDerivatives& out) const;
  // c0, c1, lapse, guess of one group, and where a group's c0 (or the PSE) and c1 stand among the variables.
  std::vector<double> group_place(const std::vector<double>& place, std::size_t group) const;
  std::size_t location_index(std::size_t group) const noexcept;
  std::size_t slope_index(std::size_t group) const noexcept;

 private:
  std::vector<PsychometricLikelihood> groups_;
  PsychometricSharing sharing_;
  NewtonBox box_;
  double middle_ = 0;  // u at F = 0.5
};

// For pairs of rates over their box, with everything that is not shared the best of its group: of own_function each
// group's own maximum, of own_location the best locations at each of many steepnesses, of own_slope the best slopes at
// each of many places. Best first.
std::vector<std::vector<double>> joint_starts(const JointLikelihood& likelihood, const PsychometricModel& model,
                                              PsychometricSharing sharing,
                                              std::span<const std::vector<PsychometricLevel>> groups);

// A place of the joint likelihood near these functions, one a group (c0, c1): one slope or PSE in the middle of theirs
// where it is shared, and they themselves where it is not, or where they are alike.
std::vector<double> joint_place(const JointLikelihood& likelihood, PsychometricSharing sharing, double lapse,
                                double guess, const std::vector<std::vector<double>>& functions, double middle);

// The place of a fit on the t axis of other data: u = c0 + c1 (x - shift) / scale.
std::vector<double> on_axis_of(const PsychometricData& data, const PsychometricSolution& solution);

}  // namespace jnd
