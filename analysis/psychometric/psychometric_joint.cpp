#include "analysis/psychometric/psychometric_joint.h"

#include <array>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_shape.h"

namespace jnd {

namespace {
using Place = PsychometricLikelihood::Place;
}  // namespace

JointLikelihood::JointLikelihood(std::span<const std::vector<PsychometricLevel>> groups, const PsychometricModel& model,
                                 PsychometricSharing sharing, const PsychometricData& pooled)
    : sharing_(sharing), middle_(psychometric_shape_quantile(model.function, 0.5)) {
  for (const std::vector<PsychometricLevel>& levels : groups) {
    PsychometricData data = psychometric_data(levels, model);
    move_axis(data, pooled.shift, pooled.scale);
    groups_.emplace_back(std::move(data), model);
  }
  const NewtonBox& one = groups_.front().box();
  box_.lower = {one.lower[Place::lapse], one.lower[Place::guess]};
  box_.upper = {one.upper[Place::lapse], one.upper[Place::guess]};
  const std::size_t own = sharing == PsychometricSharing::own_function ? 2 * groups.size() : groups.size() + 1;
  box_.lower.resize(2 + own, -kInf);
  box_.upper.resize(2 + own, kInf);
  for (std::size_t g = 0; g < groups.size(); ++g) box_.lower[slope_index(g)] = 0;
}

std::size_t JointLikelihood::location_index(std::size_t group) const noexcept {
  if (sharing_ == PsychometricSharing::own_location) return 3 + group;
  return sharing_ == PsychometricSharing::own_slope ? 2 : 2 + 2 * group;
}

std::size_t JointLikelihood::slope_index(std::size_t group) const noexcept {
  if (sharing_ == PsychometricSharing::own_location) return 2;
  return sharing_ == PsychometricSharing::own_slope ? 3 + group : 3 + 2 * group;
}

std::vector<double> JointLikelihood::group_place(const std::vector<double>& place, std::size_t group) const {
  const double location = place[location_index(group)], c1 = place[slope_index(group)];
  const double c0 = sharing_ == PsychometricSharing::own_slope ? middle_ - c1 * location : location;
  return {c0, c1, place[0], place[1]};
}

double JointLikelihood::value(const std::vector<double>& place) const {
  double sum = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) sum += groups_[g].log_likelihood(group_place(place, g));
  return sum;
}

void JointLikelihood::derivatives(const std::vector<double>& place, NewtonDerivatives& out) const {
  constexpr std::size_t kOwn = PsychometricLikelihood::variables;
  const std::size_t n = variables();
  out.value = 0;
  out.gradient.assign(n, 0);
  out.curvature.assign(n * n, 0);
  out.expected.assign(n * n, 0);
  NewtonDerivatives one;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].derivatives(group_place(place, g), one);
    out.value += one.value;
    const std::array<std::size_t, kOwn> index = {location_index(g), slope_index(g), 0, 1};
    // c0 = middle - c1 t under a common PSE t: the first row of the Jacobian of (c0, c1, lapse, guess); elsewhere the
    // variables are these themselves.
    std::array<std::array<double, kOwn>, kOwn> jacobian{};
    for (std::size_t i = 0; i < kOwn; ++i) jacobian[i][i] = 1;
    const bool curved = sharing_ == PsychometricSharing::own_slope;
    if (curved) {
      jacobian[Place::c0][0] = -place[index[1]];
      jacobian[Place::c0][1] = -place[index[0]];
    }
    for (std::size_t a = 0; a < kOwn; ++a)
      for (std::size_t i = 0; i < kOwn; ++i) {
        out.gradient[index[i]] += one.gradient[a] * jacobian[a][i];
        for (std::size_t b = 0; b < kOwn; ++b)
          for (std::size_t j = 0; j < kOwn; ++j) {
            const double product = jacobian[a][i] * jacobian[b][j];
            if (product == 0) continue;
            out.curvature[index[i] * n + index[j]] += one.curvature[a * kOwn + b] * product;
            out.expected[index[i] * n + index[j]] += one.expected[a * kOwn + b] * product;
          }
      }
    if (!curved) continue;
    out.curvature[index[0] * n + index[1]] += one.gradient[Place::c0];
    out.curvature[index[1] * n + index[0]] += one.gradient[Place::c0];
  }
}

}  // namespace jnd
