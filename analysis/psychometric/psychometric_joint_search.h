// Where the search for the largest likelihood of several groups begins.
#pragma once

#include <span>
#include <vector>

#include "analysis/psychometric/psychometric_joint.h"
#include "analysis/psychometric/psychometric_solution.h"

namespace jnd {

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
