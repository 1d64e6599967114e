#include "analysis/hierarchical/hierarchical_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "analysis/hierarchical/hierarchical_information.h"
#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/profile_interval.h"
#include "analysis/numerics/tail_probabilities.h"

namespace jnd {

namespace {

// Of ln L at a point of a profile, and at the first, from where the end is only seen; and of the end, 1 + its value.
constexpr double kNegligibleInProfile = 2e-6, kNegligibleAtFirst = 1e-4, kCloseEnough = 1e-4;
constexpr double kNegligibleShared = 1e-9;  // of ln L, which is flat along lapses and means together
constexpr double kFirstSpread = 0.3, kFirstSpreadWithin = 0.15;  // where a search begins

double trials_of(std::span<const HierarchicalCell> cells) {
  return std::accumulate(cells.begin(), cells.end(), 0.0,
                         [](double sum, const HierarchicalCell& cell) { return sum + cell.counts().trials(); });
}

std::vector<HierarchicalCell> of_condition(std::span<const HierarchicalCell> cells, std::size_t condition) {
  std::vector<HierarchicalCell> chosen;
  for (const HierarchicalCell& cell : cells)
    if (cell.condition == static_cast<int>(condition)) chosen.push_back(cell);
  return chosen;
}

}  // namespace

HierarchicalAnalysis::HierarchicalAnalysis(std::vector<HierarchicalCell> cells, const HierarchicalModel& model)
    : cells_(std::move(cells)),
      model_(model),
      range_(search_range(cells_, model.response)),
      likelihood_(cells_, model.response, model.shared) {
  const std::size_t conditions = likelihood_.conditions();
  fit_.participants = likelihood_.participants();
  fit_.trials = trials_of(cells_);
  find_spreads();
  form_ = model.one_mean ? HierarchicalForm::common(conditions) : HierarchicalForm::separate(conditions);
  const auto estimated = [](SpreadStatus status) { return status == SpreadStatus::ok; };
  form_.tu = estimated(fit_.tu);
  form_.tv = estimated(fit_.tv);
  form_.tw = estimated(fit_.tw);
  form_.rho = model.rho && form_.tu && form_.tw;
  form_.lowest = range_.lowest();
  form_.highest = range_.highest();

  HierarchicalPlace place;
  for (std::size_t c = 0; c < conditions; ++c) {
    const PooledMaximum pooled = pooled_maximum(of_condition(cells_, c), model.response, model.shared, range_.start);
    place.mu.push_back(std::clamp(pooled.ln_s, form_.lowest, form_.highest));
    place.kappa.push_back(pooled.criterion);
  }
  place.tu = form_.tu ? kFirstSpread : 0;
  place.tv = form_.tv ? kFirstSpreadWithin : 0;
  place.tw = form_.tw ? kFirstSpread * range_.criterion_unit : 0;
  HierarchicalLikelihood rough(cells_, model.response, model.shared, kRoughFineness);
  form_.shared = fit_.shared = model.estimated.identified(cells_);
  HierarchicalMaximum start;
  start.place = place;
  start.shared = first_shared(fit_.shared, model.shared);
  fit_.maximum = maximise_by_way_of(rough, likelihood_, form_, start, range_.criterion_unit,
                                    fit_.shared.any() ? kNegligibleShared : kNegligible);

  const HierarchicalPlace& found = fit_.maximum.place;
  const auto settle = [](SpreadStatus& status, double spread) {
    if (status == SpreadStatus::ok && spread == 0) status = SpreadStatus::zero;
  };
  settle(fit_.tu, found.tu);
  settle(fit_.tv, found.tv);
  settle(fit_.tw, found.tw);
  for (std::size_t c = 0; c < conditions; ++c) {
    const auto at_end = [&](double ln_s) {
      return model.one_mean ? -kInf : from_here(form_.with_mean(c, ln_s), fit_.maximum).log_likelihood;
    };
    const SlopeStatus status = status_of(found.mu[c], fit_.maximum.log_likelihood, at_end);
    fit_.conditions.push_back({status == SlopeStatus::ok ? found.mu[c] : kNaN, found.kappa[c], status, {}, {}});
  }
  if (conditions < 2 || model.one_mean) return;
  HierarchicalForm common = form_;
  std::fill(common.of.begin(), common.of.end(), 0);
  fit_.common = maximise_by_way_of(rough, likelihood_, common, start_of(common, fit_.maximum), range_.criterion_unit);
  fit_.lr = std::max(0.0, 2 * (fit_.maximum.log_likelihood - fit_.common.log_likelihood));
  fit_.df = static_cast<int>(conditions) - 1;
  fit_.p = chi2_upper(fit_.lr, fit_.df);
}

void HierarchicalAnalysis::find_spreads() {
  std::set<std::pair<int, int>> seen;
  for (const HierarchicalCell& cell : cells_)
    if (cell.counts().trials() > 0) seen.emplace(cell.participant, cell.condition);
  bool several = false;
  for (auto cell = seen.begin(); cell != seen.end(); ++cell)
    several = several || (std::next(cell) != seen.end() && std::next(cell)->first == cell->first);
  const auto status = [](bool asked, bool identified) {
    if (!asked) return SpreadStatus::not_asked;
    return identified ? SpreadStatus::ok : SpreadStatus::not_identified;
  };
  fit_.tu = status(model_.tu, fit_.participants > 1);
  fit_.tw = status(model_.tw, fit_.participants > 1);
  fit_.tv = status(model_.tv, fit_.participants > 1 && several);
}

// Where a search begins from a place whose means the form may move: far, and the criteria there are no longer near the
// best.
HierarchicalMaximum HierarchicalAnalysis::start_of(const HierarchicalForm& form,
                                                   const HierarchicalMaximum& from) const {
  constexpr double kFar = 0.5;
  HierarchicalMaximum start = from;
  start.place = moved(form, from.place);
  bool far = false;
  for (std::size_t c = 0; c < start.place.mu.size(); ++c)
    if (std::abs(start.place.mu[c] - from.place.mu[c]) > kFar) {
      far = true;
      start.place.kappa[c] = pooled_maximum(of_condition(cells_, c), model_.response, from.shared,
                                            {start.place.mu[c], range_.start.criterion, 0}, true)
                                 .criterion;
    }
  return far ? start : moved(form, from, from.shared, range_.criterion_unit);
}

HierarchicalMaximum HierarchicalAnalysis::from_here(const HierarchicalForm& form, const HierarchicalMaximum& from,
                                                    double negligible) {
  return maximise(likelihood_, form, start_of(form, from), range_.criterion_unit, negligible);
}

// at_end(ln s): the largest ln L with that mean. Answers that are as likely at an end of what is searched tell no JND.
template <typename AtEnd>
SlopeStatus HierarchicalAnalysis::status_of(double ln_s, double log_likelihood, const AtEnd& at_end) const {
  constexpr double kAsLikely = 1e-4, kNear = 1.2;  // an end is looked at from so near
  if (ln_s > range_.greatest - kNear && (ln_s > range_.greatest || at_end(form_.highest) > log_likelihood - kAsLikely))
    return SlopeStatus::no_sensitivity;
  if (ln_s < range_.least + kNear && (ln_s < range_.least || at_end(form_.lowest) > log_likelihood - kAsLikely))
    return SlopeStatus::ceiling;
  return SlopeStatus::ok;
}

// Before many searches near the maximum.
void HierarchicalAnalysis::look_closely() {
  likelihood_.set_shared(fit_.maximum.shared);
  if (!looked_closely_) observe_information(likelihood_, form_, fit_.maximum, range_.criterion_unit);
  looked_closely_ = true;
}

std::size_t HierarchicalAnalysis::shared_place(SharedParameter which) const noexcept {
  return 2 * fit_.conditions.size() + 4 + static_cast<std::size_t>(which);
}

// Of a sum of parameters, each by its place in the information, times a number.
double HierarchicalAnalysis::error_of(std::initializer_list<std::pair<std::size_t, double>> parameters) const {
  std::vector<double> times(2 * fit_.conditions.size() + 4 + kSharedParameters.size(), 0);
  for (const auto& [place, number] : parameters) times[place] = number;
  return standard_error(form_, fit_.maximum, times, range_.criterion_unit);
}

// held(value, from, negligible): the maximum with the parameter at that value, from another one; slope(maximum): of ln L
// there, by the parameter. An end is looked for up to so far from the estimate.
template <typename Held, typename Slope>
ProfileEnds HierarchicalAnalysis::ends(double estimate, double error, double furthest, const Held& held,
                                       const Slope& slope) {
  const double best = fit_.maximum.log_likelihood;
  const auto end = [&](double side) {
    HierarchicalMaximum there = fit_.maximum;
    double negligible = kNegligibleAtFirst;
    const auto profile = [&](double value) {
      there = held(value, there, negligible);
      negligible = kNegligibleInProfile;
      return ProfilePoint{best - there.log_likelihood, -slope(there)};
    };
    const double outside = estimate + side * furthest, first = estimate + side * std::min(2 * error, furthest / 2);
    if (error > furthest / 6 && profile(outside).drop < kProfileDrop) return side * kInf;
    return profile_bound(profile, estimate, outside, first, kCloseEnough);
  };
  return {end(-1), end(1)};
}

namespace {

constexpr double kFurthestFactor = 3;  // in ln s: a factor of 20
constexpr double kFurthestBias = 6;    // in units of the criterion, a quarter of the range of levels: 1.5 of them

}  // namespace

ProfileEnds HierarchicalAnalysis::mean_ends(std::size_t condition, double error) {
  const auto by = [&](const HierarchicalMaximum& there) {
    return model_.one_mean ? std::accumulate(there.slope.mu.begin(), there.slope.mu.end(), 0.0)
                           : there.slope.mu[condition];
  };
  const auto held = [&](double value, const HierarchicalMaximum& from, double negligible) {
    HierarchicalForm form = form_;
    if (!model_.one_mean) return from_here(form.with_mean(condition, value), from, negligible);
    std::fill(form.of.begin(), form.of.end(), -1);
    std::fill(form.offset.begin(), form.offset.end(), value);
    return from_here(form, from, negligible);
  };
  return ends(fit_.maximum.place.mu[condition], error, kFurthestFactor, held, by);
}

ProfileEnds HierarchicalAnalysis::criterion_ends(std::size_t condition, double error) {
  HierarchicalForm form = form_;
  form.held_criterion = static_cast<int>(condition);
  const auto held = [&](double value, const HierarchicalMaximum& from, double negligible) {
    HierarchicalMaximum start = from;
    start.place.kappa[condition] = value;
    return maximise(likelihood_, form, start, range_.criterion_unit, negligible);
  };
  return ends(fit_.maximum.place.kappa[condition], error, kFurthestBias * range_.criterion_unit, held,
              [condition](const HierarchicalMaximum& there) { return there.slope.kappa[condition]; });
}

const HierarchicalFit& HierarchicalAnalysis::add_intervals() {
  look_closely();
  const std::size_t conditions = fit_.conditions.size();
  for (std::size_t c = 0; c < conditions; ++c) {
    ConditionMean& one = fit_.conditions[c];
    one.ends = mean_ends(c, error_of({{c, 1}}));
    if (model_.response == ResponseModel::choice && one.status == SlopeStatus::ok)
      one.criterion_ends = criterion_ends(c, error_of({{conditions + c, 1}}));
  }
  return fit_;
}

ConditionDifference HierarchicalAnalysis::difference(std::size_t a, std::size_t b) {
  look_closely();
  ConditionDifference one{a, b, fit_.conditions[a].mu - fit_.conditions[b].mu, {}};
  const auto held = [&](double value, const HierarchicalMaximum& from, double negligible) {
    return from_here(form_.with_difference(a, b, value), from, negligible);
  };
  if (!std::isnan(one.difference))
    one.ends = ends(one.difference, error_of({{a, 1}, {b, -1}}), kFurthestFactor, held,
                    [a](const HierarchicalMaximum& there) { return there.slope.mu[a]; });
  const double without = from_here(form_.with_difference(a, b, 0), fit_.maximum).log_likelihood;
  one.lr = std::max(0.0, 2 * (fit_.maximum.log_likelihood - without));
  one.p = chi2_upper(one.lr, 1);
  return one;
}

std::vector<ConditionDifference> HierarchicalAnalysis::differences() {
  std::vector<ConditionDifference> differences;
  if (model_.one_mean) return differences;
  for (std::size_t a = 0; a < fit_.conditions.size(); ++a)
    for (std::size_t b = a + 1; b < fit_.conditions.size(); ++b) differences.push_back(difference(a, b));
  return differences;
}

// With one of the shared parameters at a value.
HierarchicalMaximum HierarchicalAnalysis::with_shared(SharedParameter held, double value,
                                                      const HierarchicalMaximum& from, double negligible,
                                                      double wanted) {
  HierarchicalForm form = form_;
  form.shared = form.shared.with(held, false);
  SharedParameters shared = from.shared;
  value_of(shared, held) = value;
  return maximise(likelihood_, form, moved(form, from, shared, range_.criterion_unit), range_.criterion_unit,
                  negligible, wanted);
}

// One end of the interval, where ln L falls all the way from the estimate to the limit, or does not fall enough.
double HierarchicalAnalysis::shared_end(const SharedEstimate& estimate, double side) {
  const SharedLimits limits = limits_of(estimate.parameter, range_.criterion_unit);
  const double limit = side < 0 ? limits.low : limits.high;
  const bool least = side < 0 && limits.low >= 0;
  const double open = least ? 0 : side * kInf;
  if (estimate.value == limit) return open;
  const double best = fit_.maximum.log_likelihood;
  const double room = std::abs(limit - estimate.value), error = error_of({{shared_place(estimate.parameter), 1}});
  if (error > room / 6) {
    const double wanted = best - kProfileDrop;
    if (with_shared(estimate.parameter, limit, fit_.maximum, kNegligibleInProfile, wanted).log_likelihood > wanted)
      return open;
  }
  const auto slope = [&estimate](const HierarchicalMaximum& there) {
    return there.slope_by_shared[static_cast<std::size_t>(estimate.parameter)];
  };
  HierarchicalMaximum there = fit_.maximum;
  double negligible = kNegligibleAtFirst;
  const auto profile = [&](double value) {
    there = with_shared(estimate.parameter, value, there, negligible);
    negligible = kNegligibleInProfile;
    there.slope_by_shared = likelihood_.at(there.place, SharedForm{}.with(estimate.parameter)).by_shared;
    return ProfilePoint{best - there.log_likelihood, -slope(there)};
  };
  // Where it would be if ln L were a parabola.
  const double rise = estimate.status == SharedStatus::zero ? std::min(slope(fit_.maximum), 0.0) * error : 0;
  const double reach = (rise + std::sqrt(rise * rise + 2 * kProfileDrop)) * error;
  const double end =
      profile_bound(profile, estimate.value, limit, estimate.value + side * std::min(reach, room / 2), kCloseEnough);
  return std::abs(end - limit) < kCloseEnough ? open : end;
}

std::vector<SharedEstimate> HierarchicalAnalysis::shared_estimates() {
  std::vector<SharedEstimate> estimates;
  look_closely();
  for (const SharedParameter which : kSharedParameters) {
    if (!model_.estimated.has(which)) continue;
    SharedEstimate& one = estimates.emplace_back();
    one.parameter = which;
    one.status = SharedStatus::not_identified;
    if (!fit_.shared.has(which)) continue;
    const SharedLimits limits = limits_of(which, range_.criterion_unit);
    one.value = value_of(fit_.maximum.shared, which);
    one.status = one.value == limits.high || (one.value == limits.low && limits.low != 0) ? SharedStatus::at_limit
                 : one.value == limits.low                                                ? SharedStatus::zero
                                                                                          : SharedStatus::ok;
    one.ends = {shared_end(one, -1), shared_end(one, 1)};
    if (limits.low > 0) continue;  // there is no test of 0
    const double without = with_shared(which, 0, fit_.maximum, kNegligibleInProfile).log_likelihood;
    one.lr = std::max(0.0, 2 * (fit_.maximum.log_likelihood - without));
    one.p = chi2_upper(one.lr, 1);
    if (limits.low == 0) one.p = one.status == SharedStatus::zero ? 1 : one.p / 2;
  }
  return estimates;
}

std::vector<PersonEstimate> HierarchicalAnalysis::people() {
  const std::size_t conditions = fit_.conditions.size();
  std::vector<std::vector<HierarchicalCell>> cells(fit_.participants * conditions);
  for (const HierarchicalCell& cell : cells_)
    cells[static_cast<std::size_t>(cell.participant) * conditions + static_cast<std::size_t>(cell.condition)].push_back(
        cell);
  std::vector<PersonEstimate> people;
  likelihood_.set_shared(fit_.maximum.shared);
  const std::vector<PersonPosterior> posteriors = likelihood_.posteriors(fit_.maximum.place);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    PersonEstimate& one = people.emplace_back();
    one.mean = posteriors[i / conditions].mean[i % conditions];
    one.sd = posteriors[i / conditions].sd[i % conditions];
    one.criterion = fit_.maximum.place.kappa[i % conditions] + posteriors[i / conditions].w;
    one.status = SlopeStatus::missing;
    if (trials_of(cells[i]) == 0) continue;
    const PooledMaximum alone = pooled_maximum(cells[i], model_.response, fit_.maximum.shared, range_.start);
    const auto at_end = [&](double ln_s) {
      return pooled_maximum(cells[i], model_.response, fit_.maximum.shared, {ln_s, range_.start.criterion, 0}, true)
          .log_likelihood;
    };
    one.status = status_of(alone.ln_s, alone.log_likelihood, at_end);
    if (one.status == SlopeStatus::ok) one.alone = alone.ln_s;
  }
  return people;
}

}  // namespace jnd
