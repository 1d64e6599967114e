#include "analysis/psychometric/psychometric_joint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/numerics/special_values.h"
#include "analysis/psychometric/psychometric_likelihood.h"
#include "analysis/psychometric/psychometric_search.h"

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

// ---- where the search begins

namespace {

constexpr std::size_t kMostStarts = 12;

struct Start {
  std::vector<double> place;
  double value;
};

std::vector<double> rates_of(const NewtonBox& box, std::size_t i, std::initializer_list<double> parts) {
  if (box.lower[i] == box.upper[i]) return {box.lower[i]};
  std::vector<double> rates;
  for (const double part : parts) rates.push_back(box.lower[i] + part * (box.upper[i] - box.lower[i]));
  return rates;
}

// What the groups share beside the rates, and the functions that are best with it.
class SharedSearch {
 public:
  SharedSearch(const JointLikelihood& likelihood, PsychometricSharing sharing, double middle)
      : likelihood_(likelihood), sharing_(sharing), middle_(middle) {
    double from = kInf, to = -kInf;
    for (const PsychometricLikelihood& group : likelihood.groups()) {
      surveys_.emplace_back(group, group.box());
      from = std::min(from, group.data().t.front());
      to = std::max(to, group.data().t.back());
    }
    constexpr int kPlaces = 48;
    constexpr double kFlattest = 0.2, kSteeper = 1.5, kSteepest = 1e4;
    const double range = to - from;
    if (sharing == PsychometricSharing::own_slope) {
      for (int i = 0; i <= kPlaces; ++i) shared_.push_back(from + range * (2.0 * i / kPlaces - 0.5));
      return;
    }
    double c1 = kFlattest;
    while (c1 <= kSteepest) {
      shared_.push_back(c1 / range);
      c1 *= kSteeper;
    }
  }

  void add_starts(double lapse, double guess, std::vector<Start>& starts) {
    for (PsychometricSurvey& survey : surveys_) {
      survey.hold(Place::lapse, lapse);
      survey.hold(Place::guess, guess);
    }
    for (const double shared : shared_) {
      std::vector<std::vector<double>> functions;
      double value = 0;
      for (PsychometricSurvey& survey : surveys_) {
        const auto h = [&](double c1) { return middle_ - c1 * shared; };
        const auto found =
            sharing_ == PsychometricSharing::own_slope ? survey.peaks_along(h, 1) : survey.peaks_at(shared, 1, -kInf);
        if (found.empty()) {
          value = -kInf;
          break;
        }
        value += found.front().value;
        functions.push_back(found.front().place());
      }
      if (std::isfinite(value))
        starts.push_back({joint_place(likelihood_, sharing_, lapse, guess, functions, middle_), value});
    }
  }

 private:
  const JointLikelihood& likelihood_;
  PsychometricSharing sharing_;
  double middle_;
  std::vector<PsychometricSurvey> surveys_;
  std::vector<double> shared_;  // steepnesses, or places of the PSE
};

}  // namespace

std::vector<double> joint_place(const JointLikelihood& likelihood, PsychometricSharing sharing, double lapse,
                                double guess, const std::vector<std::vector<double>>& functions, double middle) {
  std::vector<double> place(likelihood.variables());
  place[0] = lapse;
  place[1] = guess;
  const auto count = static_cast<double>(functions.size());
  double log_slope = 0, pse = 0;
  for (const std::vector<double>& function : functions) {
    const double c1 = std::max(function[Place::c1], 1e-6);
    log_slope += std::log(c1) / count;
    pse += (middle - function[Place::c0]) / c1 / count;
  }
  for (std::size_t g = 0; g < functions.size(); ++g) {
    const double c0 = functions[g][Place::c0], c1 = functions[g][Place::c1], shared = std::exp(log_slope);
    place[likelihood.slope_index(g)] = sharing == PsychometricSharing::own_location ? shared : c1;
    if (sharing == PsychometricSharing::own_function) place[likelihood.location_index(g)] = c0;
    if (sharing == PsychometricSharing::own_location)
      place[likelihood.location_index(g)] = middle - shared * (middle - c0) / std::max(c1, 1e-6);
  }
  if (sharing == PsychometricSharing::own_slope) place[likelihood.location_index(0)] = pse;
  return place;
}

std::vector<double> on_axis_of(const PsychometricData& data, const PsychometricSolution& solution) {
  const PsychometricData& from = solution.likelihood.data();
  std::vector<double> place = solution.place;
  place[Place::c0] += place[Place::c1] * (data.shift - from.shift) / from.scale;
  place[Place::c1] *= data.scale / from.scale;
  return place;
}

std::vector<std::vector<double>> joint_starts(const JointLikelihood& likelihood, const PsychometricModel& model,
                                              PsychometricSharing sharing,
                                              std::span<const std::vector<PsychometricLevel>> groups) {
  const NewtonBox& box = likelihood.box();
  const double middle = psychometric_shape_quantile(model.function, 0.5);
  std::vector<Start> starts;
  SharedSearch shared(likelihood, sharing, middle);
  for (const double lapse : rates_of(box, 0, {0, 0.3, 1}))
    for (const double guess : rates_of(box, 1, {0, 0.1, 0.5, 1})) {
      if (sharing != PsychometricSharing::own_function) {
        shared.add_starts(lapse, guess, starts);
        continue;
      }
      PsychometricModel known = model;
      known.lapse = lapse;
      known.guess = guess;
      std::vector<std::vector<double>> functions;
      double value = 0;
      for (std::size_t g = 0; g < groups.size(); ++g) {
        const PsychometricSolution own = solve_psychometric(groups[g], known);
        if (own.place.empty()) break;
        functions.push_back(on_axis_of(likelihood.groups()[g].data(), own));
        value += own.value;
      }
      if (functions.size() == groups.size())
        starts.push_back({joint_place(likelihood, sharing, lapse, guess, functions, middle), value});
    }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.value > b.value; });
  if (starts.size() > kMostStarts) starts.resize(kMostStarts);
  std::vector<std::vector<double>> places;
  for (Start& start : starts) places.push_back(std::move(start.place));
  return places;
}

}  // namespace jnd
