#include "analysis/hierarchical/shared_parameters.h"

#include <map>
#include <set>
#include <tuple>

#include "analysis/hierarchical/hierarchical_likelihood.h"

namespace jnd {

namespace {

constexpr double kLargestSharedLapse = 0.5, kMostAlike = 0.9, kFurthestDrift = 3;
constexpr double kNearestSure = 0.02, kFurthestSure = 8;

bool of_sureness(SharedParameter which) noexcept {
  return which == SharedParameter::sure_below || which == SharedParameter::sure_above;
}

}  // namespace

double& value_of(SharedParameters& shared, SharedParameter which) noexcept {
  constexpr std::array kMembers = {&SharedParameters::lapse,      &SharedParameters::overdispersion,
                                   &SharedParameters::drift_ln_s, &SharedParameters::drift_criterion,
                                   &SharedParameters::sure_below, &SharedParameters::sure_above};
  return shared.*kMembers[static_cast<std::size_t>(which)];
}

double value_of(const SharedParameters& shared, SharedParameter which) noexcept {
  SharedParameters copy = shared;
  return value_of(copy, which);
}

bool at_least_zero(SharedParameter which) noexcept {
  return which == SharedParameter::lapse || which == SharedParameter::overdispersion;
}

bool of_criterion(SharedParameter which) noexcept {
  return which == SharedParameter::drift_criterion || of_sureness(which);
}

SharedForm SharedForm::with(SharedParameter which, bool estimated) const noexcept {
  SharedForm form = *this;
  form.free[static_cast<std::size_t>(which)] = estimated;
  return form;
}

SharedForm SharedForm::identified(std::span<const HierarchicalCell> cells) const {
  constexpr std::size_t kLeastLevels = 3;
  const auto some = [](double sure, double of) { return sure > 0 && sure < of; };
  AnswerTally all;
  std::set<double> levels;
  std::map<std::tuple<int, int, double, bool>, double> alike;
  std::set<std::tuple<int, int, bool>> halves;
  for (const HierarchicalCell& cell : cells) {
    const double trials = cell.counts().trials();
    if (trials == 0) continue;
    levels.insert(cell.level);
    all += cell.counts();
    alike[{cell.participant, cell.condition, cell.level, cell.second_half}] += trials;
    halves.emplace(cell.participant, cell.condition, cell.second_half);
  }
  const bool several = std::any_of(alike.begin(), alike.end(), [](const auto& one) { return one.second > 1; });
  const bool both = std::any_of(halves.begin(), halves.end(), [&](const auto& one) {
    const auto& [participant, condition, second_half] = one;
    return second_half && halves.contains({participant, condition, false});
  });
  SharedForm form = *this;
  if (levels.size() < kLeastLevels) form = form.with(SharedParameter::lapse, false);
  if (!several) form = form.with(SharedParameter::overdispersion, false);
  if (!some(all.sure_negative, all.negative)) form = form.with(SharedParameter::sure_below, false);
  if (!some(all.sure_positive, all.positive)) form = form.with(SharedParameter::sure_above, false);
  if (!both) form = form.with(SharedParameter::drift_ln_s, false).with(SharedParameter::drift_criterion, false);
  return form;
}

SharedLimits limits_of(SharedParameter which, double criterion_unit) noexcept {
  switch (which) {
    case SharedParameter::lapse:
      return {0, kLargestSharedLapse};
    case SharedParameter::overdispersion:
      return {0, kMostAlike};
    case SharedParameter::drift_ln_s:
      return {-kFurthestDrift, kFurthestDrift};
    case SharedParameter::sure_below:
    case SharedParameter::sure_above:
      return {kNearestSure * criterion_unit, kFurthestSure * criterion_unit};
    case SharedParameter::drift_criterion:
      break;
  }
  return {-kFurthestDrift * criterion_unit, kFurthestDrift * criterion_unit};
}

SharedParameters first_shared(const SharedForm& form, const SharedParameters& held) noexcept {
  constexpr double kFirstShared = 0.02, kFirstSure = 0.8;
  SharedParameters shared = held;
  for (const SharedParameter which : kSharedParameters)
    if (form.has(which))
      value_of(shared, which) = of_sureness(which) ? kFirstSure : at_least_zero(which) ? kFirstShared : 0;
  return shared;
}

double step_of(SharedParameter which, double value, double criterion_unit) noexcept {
  constexpr double kShare = 1e-5, kLeast = 0.01;
  if (at_least_zero(which)) return kShare * (value + kLeast);  // rates near 0 change ln L as their logarithm does
  return of_sureness(which) ? kShare * value : kShare * (of_criterion(which) ? criterion_unit : 1);
}

}  // namespace jnd
