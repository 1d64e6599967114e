// Where the 3RRS platform can go, how well it is conditioned there, and how far it is from its singularities.
//
//   serial      a leg stretched or folded: its lever in F of (20) vanishes, and the pose beyond is out of reach
//   parallel    J loses rank: the platform can move while the joints stand
//   constraint  (14) no longer fixes [vx, vy, wz]: det U changes sign
//
// Pure functions; they allocate where they return grids.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/numerics/special_values.h"
#include "devices/rrs3/rrs3_kinematics.h"

namespace jnd {

// The box of a device's limits: rest height -+ half the stroke, -+ roll, -+ pitch.
struct Rrs3Box {
  double lowest_m = 0, highest_m = 0;
  double max_roll_rad = 0, max_pitch_rad = 0;
};
Rrs3Box box_of(const DeviceSpec& spec) noexcept;

// Condition number of J (columns scaled by b) at a pose; empty where it is unreachable or singular.
std::optional<double> condition_at(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& xi) noexcept;

// Points along each side of the box, ends included; at least 1 each (1: the middle).
struct Rrs3Grid {
  int heights = 31, rolls = 25, pitches = 25;
};

struct Rrs3Workspace {
  int poses = 0, reachable = 0;
  double worst_condition = 0;  // of the reachable ones
  Rrs3Coordinates worst;       // where
  double reachable_share() const noexcept { return poses > 0 ? static_cast<double>(reachable) / poses : 0; }
};
// Throws InputError where a side of the grid has no points.
Rrs3Workspace workspace_of(const Rrs3Kinematics& kinematics, const Rrs3Box& box, const Rrs3Grid& grid = {});

// A slice of the workspace at one height.
struct Rrs3ConditionMap {
  double pz_m = 0;
  std::vector<double> rolls_rad, pitches_rad;  // ascending
  std::vector<double> conditions;              // a row of pitches for each roll; infinite where unreachable
  double at(std::size_t roll, std::size_t pitch) const { return conditions.at(roll * pitches_rad.size() + pitch); }
};
// Throws InputError where a side of the grid has no points.
Rrs3ConditionMap condition_map(const Rrs3Kinematics& kinematics, const Rrs3Box& box, double pz_m, int rolls = 25,
                               int pitches = 25);

// Columns pz_m, roll_rad, pitch_rad, reachable, condition (empty where unreachable); a line per pose.
std::string condition_csv(const Rrs3ConditionMap& map);

// How far a pose is from a singularity when one coordinate changes alone: metres or radians, >= 0; infinite where there
// is none within a quarter turn, or before the legs end.
struct Rrs3Margin {
  double down = kInf, up = kInf;
};

struct Rrs3SingularityDistances {
  struct Along {
    Rrs3Margin serial, parallel, constraint;
  };
  Along pz, roll, pitch;
  // Here, from 0 (singular) to 1. serial: the smallest |sine| between the two links of a leg. parallel and constraint:
  // |determinant| over the product of its rows' lengths, lengths in units of b.
  double serial = 0, parallel = 0, constraint = 0;
};
// Found by steps of 0.1 mm or 0.25 degrees and bisection to 1e-9: two changes of sign within one step are missed.
// Empty where the pose itself is out of reach or singular.
std::optional<Rrs3SingularityDistances> singularity_distances(const Rrs3Kinematics& kinematics,
                                                              const Rrs3Coordinates& xi) noexcept;

}  // namespace jnd
