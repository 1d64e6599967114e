#include "devices/rrs3/rrs3_workspace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr double kDegree = std::numbers::pi / 180;

void check_points(int points, const char* side) {
  if (points < 1) throw InputError(fmt::format("a grid of {} {}: give at least 1", points, side));
}

// Point `index` of `points` from low to high.
double point(double low, double high, int index, int points) noexcept {
  return points < 2 ? (low + high) / 2 : low + (high - low) * index / (points - 1);
}

}  // namespace

Rrs3Box box_of(const DeviceSpec& spec) noexcept {
  return {.lowest_m = spec.rest_z_m - spec.stroke_m / 2,
          .highest_m = spec.rest_z_m + spec.stroke_m / 2,
          .max_roll_rad = spec.max_roll_rad,
          .max_pitch_rad = spec.max_pitch_rad};
}

std::optional<double> condition_at(const Rrs3Kinematics& kinematics, const Rrs3Coordinates& xi) noexcept {
  const std::optional<Rrs3Configuration> at = kinematics.configuration(xi);
  if (!at) return std::nullopt;
  const std::optional<Rrs3Differential> rates = kinematics.differential(*at);
  if (!rates) return std::nullopt;
  return kinematics.condition_number(rates->j);
}

Rrs3Workspace workspace_of(const Rrs3Kinematics& kinematics, const Rrs3Box& box, const Rrs3Grid& grid) {
  check_points(grid.heights, "heights");
  check_points(grid.rolls, "rolls");
  check_points(grid.pitches, "pitches");
  Rrs3Workspace result;
  for (int z = 0; z < grid.heights; ++z) {
    for (int r = 0; r < grid.rolls; ++r) {
      for (int p = 0; p < grid.pitches; ++p) {
        const Rrs3Coordinates xi{.pz_m = point(box.lowest_m, box.highest_m, z, grid.heights),
                                 .roll_rad = point(-box.max_roll_rad, box.max_roll_rad, r, grid.rolls),
                                 .pitch_rad = point(-box.max_pitch_rad, box.max_pitch_rad, p, grid.pitches)};
        ++result.poses;
        const std::optional<double> condition = condition_at(kinematics, xi);
        if (!condition) continue;
        ++result.reachable;
        if (*condition > result.worst_condition) {
          result.worst_condition = *condition;
          result.worst = xi;
        }
      }
    }
  }
  return result;
}

Rrs3ConditionMap condition_map(const Rrs3Kinematics& kinematics, const Rrs3Box& box, double pz_m, int rolls,
                               int pitches) {
  check_points(rolls, "rolls");
  check_points(pitches, "pitches");
  Rrs3ConditionMap map;
  map.pz_m = pz_m;
  for (int r = 0; r < rolls; ++r) map.rolls_rad.push_back(point(-box.max_roll_rad, box.max_roll_rad, r, rolls));
  for (int p = 0; p < pitches; ++p) map.pitches_rad.push_back(point(-box.max_pitch_rad, box.max_pitch_rad, p, pitches));
  for (const double roll : map.rolls_rad)
    for (const double pitch : map.pitches_rad)
      map.conditions.push_back(condition_at(kinematics, {.pz_m = pz_m, .roll_rad = roll, .pitch_rad = pitch})
                                   .value_or(std::numeric_limits<double>::infinity()));
  return map;
}

std::string condition_csv(const Rrs3ConditionMap& map) {
  std::string text = "pz_m,roll_rad,pitch_rad,reachable,condition\n";
  for (std::size_t r = 0; r < map.rolls_rad.size(); ++r) {
    for (std::size_t p = 0; p < map.pitches_rad.size(); ++p) {
      const double condition = map.at(r, p);
      const bool reachable = std::isfinite(condition);
      text += fmt::format("{},{},{},{},{}\n", map.pz_m, map.rolls_rad[r], map.pitches_rad[p], reachable ? 1 : 0,
                          reachable ? fmt::format("{}", condition) : "");
    }
  }
  return text;
}

std::string condition_plot(const Rrs3ConditionMap& map) {
  std::string text;
  for (std::size_t r = map.rolls_rad.size(); r-- > 0;) {
    text += fmt::format("{:6.1f} ", map.rolls_rad[r] / kDegree);
    for (std::size_t p = 0; p < map.pitches_rad.size(); ++p) {
      const double condition = map.at(r, p);
      text += std::isfinite(condition) ? static_cast<char>('0' + static_cast<int>(std::min(condition, 9.0))) : '.';
    }
    text += '\n';
  }
  if (!map.pitches_rad.empty()) {
    const std::string first = fmt::format("{:.1f}", map.pitches_rad.front() / kDegree);
    const std::string last = fmt::format("{:.1f}", map.pitches_rad.back() / kDegree);
    const std::size_t width = std::max(map.pitches_rad.size(), first.size() + 1 + last.size());
    text += fmt::format("{:7}{}{:>{}}\n", "", first, last, width - first.size());
  }
  return text;
}

}  // namespace jnd
