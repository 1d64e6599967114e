#include "analysis/hierarchical/shared_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "analysis/hierarchical/corrected_curvature.h"
#include "analysis/numerics/box_newton.h"

namespace jnd {

namespace {

constexpr double kLargestSharedLapse = 0.5, kMostAlike = 0.9, kFurthestDrift = 3;
constexpr double kNearestSure = 0.02, kFurthestSure = 8;

bool at_least_zero(SharedParameter which) noexcept {
  return which == SharedParameter::lapse || which == SharedParameter::overdispersion;
}

bool of_sureness(SharedParameter which) noexcept {
  return which == SharedParameter::sure_below || which == SharedParameter::sure_above;
}

// In the unit of the criterion.
bool of_criterion(SharedParameter which) noexcept {
  return which == SharedParameter::drift_criterion || of_sureness(which);
}

// Apart so far values are taken for a slope. Rates near 0 change ln L as their logarithm does.
double step_of(SharedParameter which, double value, double criterion_unit) noexcept {
  constexpr double kShare = 0.02, kLeast = 0.01, kOfDrift = 2e-3, kOfSureness = 1e-3;
  if (at_least_zero(which)) return kShare * (value + kLeast);
  if (of_sureness(which)) return std::min(kOfSureness * criterion_unit, kShare * value);
  return of_criterion(which) ? kOfDrift * criterion_unit : kOfDrift;
}

constexpr double kLeastCurvature = 1e-3;
double longest_step(SharedParameter which) noexcept {
  return at_least_zero(which) ? 0.1 : 1;
}

// The likelihood maximised over everything else, of those shared parameters that are estimated, in units of their own.
class SharedProfile {
 public:
  SharedProfile(HierarchicalLikelihood& likelihood, const HierarchicalForm& form, const SharedForm& shared_form,
                const HierarchicalMaximum& from, double criterion_unit, double negligible)
      : likelihood_(likelihood), form_(form), unit_(criterion_unit), negligible_(negligible), from_(from), last_(from) {
    for (const SharedParameter which : kSharedParameters)
      if (shared_form.has(which)) free_.push_back(which);
  }

  std::vector<double> start() const {
    std::vector<double> x;
    for (const SharedParameter which : free_) x.push_back(value_of(from_.shared, which) / unit_of(which));
    return x;
  }
  NewtonBox box() const {
    NewtonBox box;
    for (const SharedParameter which : free_) {
      const SharedLimits limits = limits_of(which, unit_);
      box.lower.push_back(limits.low / unit_of(which));
      box.upper.push_back(limits.high / unit_of(which));
    }
    return box;
  }

  double value(const std::vector<double>& x) const { return maximum(x).log_likelihood; }

  void derivatives(const std::vector<double>& x, NewtonDerivatives& at) const {
    const HierarchicalMaximum& there = maximum(x);
    const std::size_t n = x.size();
    at.value = there.log_likelihood;
    at.gradient.assign(n, 0);
    std::vector<double> first(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const double unit = unit_of(free_[i]);
      const SharedSlope slope = slope_of(likelihood_, there, free_[i], unit_);
      at.gradient[i] = slope.slope * unit;
      // No less than what keeps a step within reach.
      first[i * n + i] =
          std::max({slope.curvature * unit * unit, std::abs(at.gradient[i]) / longest_step(free_[i]), kLeastCurvature});
    }
    if (curvature_.empty())
      curvature_.begin(from_.shared_curvature.size() == n * n ? from_.shared_curvature : first, x, at.gradient);
    else
      curvature_.correct(x, at.gradient);
    at.curvature = at.expected = curvature_.matrix();
  }

  const HierarchicalMaximum& maximum(const std::vector<double>& x) const {
    SharedParameters shared = from_.shared;
    for (std::size_t i = 0; i < free_.size(); ++i) value_of(shared, free_[i]) = x[i] * unit_of(free_[i]);
    if (known_ && shared == last_.shared) return last_;
    likelihood_.set_shared(shared);
    last_ = maximise(likelihood_, form_, last_.place, unit_, negligible_, last_.information);
    last_.shared = shared;
    known_ = true;
    return last_;
  }

  const std::vector<double>& curvature() const noexcept { return curvature_.matrix(); }

 private:
  double unit_of(SharedParameter which) const noexcept { return of_criterion(which) ? unit_ : 1; }

  HierarchicalLikelihood& likelihood_;
  const HierarchicalForm& form_;
  double unit_, negligible_;
  const HierarchicalMaximum& from_;
  std::vector<SharedParameter> free_;
  mutable HierarchicalMaximum last_;
  mutable bool known_ = false;
  mutable CorrectedCurvature curvature_;
};

}  // namespace

double& value_of(SharedParameters& shared, SharedParameter which) noexcept {
  switch (which) {
    case SharedParameter::lapse:
      return shared.lapse;
    case SharedParameter::overdispersion:
      return shared.overdispersion;
    case SharedParameter::drift_ln_s:
      return shared.drift_ln_s;
    case SharedParameter::sure_below:
      return shared.sure_below;
    case SharedParameter::sure_above:
      return shared.sure_above;
    case SharedParameter::drift_criterion:
      break;
  }
  return shared.drift_criterion;
}

double value_of(const SharedParameters& shared, SharedParameter which) noexcept {
  SharedParameters copy = shared;
  return value_of(copy, which);
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

SharedSlope slope_of(HierarchicalLikelihood& likelihood, const HierarchicalMaximum& maximum, SharedParameter which,
                     double criterion_unit) {
  const double at = value_of(maximum.shared, which), step = step_of(which, at, criterion_unit);
  const auto beside = [&](double by) {
    SharedParameters shared = maximum.shared;
    value_of(shared, which) = at + by;
    likelihood.set_shared(shared);
    return likelihood.at(maximum.place).log_likelihood;
  };
  const double here = maximum.log_likelihood;
  if (at_least_zero(which) && at < step) {  // there is nothing below 0
    const double one = beside(step), two = beside(2 * step);
    return {(-3 * here + 4 * one - two) / (2 * step), -(here - 2 * one + two) / (step * step)};
  }
  const double below = beside(-step), above = beside(step);
  return {(above - below) / (2 * step), -(below - 2 * here + above) / (step * step)};
}

HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const SharedForm& shared_form, const HierarchicalMaximum& from, double criterion_unit,
                             double negligible, double shared_negligible) {
  const SharedProfile profile(likelihood, form, shared_form, from, criterion_unit, negligible);
  if (!shared_form.any()) return profile.maximum({});
  const NewtonResult found = maximise_in_box(profile, profile.start(), profile.box(), -kInf, shared_negligible);
  HierarchicalMaximum maximum = profile.maximum(found.place);
  maximum.converged = maximum.converged && found.converged;
  maximum.shared_curvature = profile.curvature();
  likelihood.set_shared(maximum.shared);
  return maximum;
}

}  // namespace jnd
