#include "analysis/hierarchical/hierarchical_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "analysis/hierarchical/corrected_curvature.h"
#include "analysis/hierarchical/hierarchical_information.h"
#include "analysis/numerics/box_newton.h"

namespace jnd {

namespace {

// How far a search goes from its start: a factor of 50 in ln s, criteria of 6, spreads of 2.
constexpr double kFurthestMean = 4, kFurthestCriterion = 6, kLargestSpread = 2, kLargestCorrelation = 0.995;
// The smallest spread of a search. ln L is smooth in the square of a spread, which is what is searched, and differs
// between 0 and here by next to nothing, but only beyond 0 does it have a slope in that square.
constexpr double kSmallestSpread = 1e-3;
constexpr double kPooledNegligible = 1e-10;  // ln L of the pooled answers
constexpr double kRidge = 1e-3;              // least curvature of every variable

// Where a search stands.
struct SearchedPlace {
  HierarchicalPlace place;
  SharedParameters shared;
};

// Of shared parameters: how far a step may go that knows only a slope, and the least curvature.
constexpr double kLongestOfRates = 0.1, kLongestOfOthers = 1, kLeastOfShared = 1e-3;

// Places as vectors of what is free, and back. Spreads enter squared.
class Variables {
 public:
  Variables(const HierarchicalForm& form, SearchedPlace start, double unit)
      : form_(form), start_(std::move(start)), unit_(unit), conditions_(form.of.size()) {
    for (const int one : form.of) means_ = std::max(means_, static_cast<std::size_t>(one + 1));
    for (const SharedParameter which : kSharedParameters)
      if (form.shared.has(which)) shared_.push_back(which);
  }

  std::size_t count() const noexcept {
    return means_ + criteria() + static_cast<std::size_t>(form_.tu + form_.tv + form_.tw + form_.rho) + shared_.size();
  }

  std::vector<double> start() const {
    const HierarchicalPlace& place = start_.place;
    std::vector<double> x(means_, 0);
    std::vector<int> bound(means_, 0);
    for (std::size_t c = 0; c < conditions_; ++c)
      if (form_.of[c] >= 0) {
        x[static_cast<std::size_t>(form_.of[c])] += place.mu[c] - form_.offset[c];
        ++bound[static_cast<std::size_t>(form_.of[c])];
      }
    for (std::size_t i = 0; i < means_; ++i) x[i] /= bound[i];
    for (std::size_t c = 0; c < conditions_; ++c)
      if (!holds_criterion(c)) x.push_back(place.kappa[c] / unit_);
    const auto spread = [&x](double one) {
      x.push_back(std::max(one, kSmallestSpread) * std::max(one, kSmallestSpread));
    };
    if (form_.tu) spread(place.tu);
    if (form_.tv) spread(place.tv);
    if (form_.tw) spread(place.tw / unit_);
    if (form_.rho) x.push_back(place.rho);
    for (const SharedParameter which : shared_) x.push_back(value_of(start_.shared, which) / unit_of(which));
    return x;
  }

  SearchedPlace to(const std::vector<double>& x) const {
    SearchedPlace searched = start_;
    HierarchicalPlace& place = searched.place;
    for (std::size_t c = 0; c < conditions_; ++c)
      place.mu[c] = form_.offset[c] + (form_.of[c] < 0 ? 0 : x[static_cast<std::size_t>(form_.of[c])]);
    std::size_t i = means_;
    for (std::size_t c = 0; c < conditions_; ++c)
      if (!holds_criterion(c)) place.kappa[c] = x[i++] * unit_;
    if (form_.tu) place.tu = std::sqrt(x[i++]);
    if (form_.tv) place.tv = std::sqrt(x[i++]);
    if (form_.tw) place.tw = std::sqrt(x[i++]) * unit_;
    if (form_.rho) place.rho = x[i++];
    for (const SharedParameter which : shared_) value_of(searched.shared, which) = x[i++] * unit_of(which);
    return searched;
  }

  std::vector<double> slope(const HierarchicalPlace& by, const OfSharedParameters& by_shared,
                            const HierarchicalPlace& at) const {
    std::vector<double> slope(means_, 0);
    for (std::size_t c = 0; c < conditions_; ++c)
      if (form_.of[c] >= 0) slope[static_cast<std::size_t>(form_.of[c])] += by.mu[c];
    for (std::size_t c = 0; c < conditions_; ++c)
      if (!holds_criterion(c)) slope.push_back(by.kappa[c] * unit_);
    if (form_.tu) slope.push_back(by.tu / (2 * at.tu));
    if (form_.tv) slope.push_back(by.tv / (2 * at.tv));
    if (form_.tw) slope.push_back(by.tw * unit_ * unit_ / (2 * at.tw));
    if (form_.rho) slope.push_back(by.rho);
    for (const SharedParameter which : shared_) slope.push_back(of(by_shared, which) * unit_of(which));
    return slope;
  }

  // Of a matrix over all parameters (hierarchical_information.h) what concerns the free ones.
  std::vector<double> curvature(const std::vector<double>& full) const {
    const std::vector<FreeParameter> free = free_parameters();
    const std::size_t n = count();
    std::vector<double> out(n * n, 0);
    for (std::size_t i = 0; i < free.size(); ++i)
      for (std::size_t j = 0; j < free.size(); ++j)
        if (free[i].variable >= 0 && free[j].variable >= 0)
          out[static_cast<std::size_t>(free[i].variable) * n + static_cast<std::size_t>(free[j].variable)] +=
              free[i].unit * free[j].unit * full[i * free.size() + j];
    for (std::size_t i = 0; i < n; ++i) out[i * n + i] += kRidge;
    return out;
  }

  // Of numbers, one for each parameter, what each variable brings.
  std::vector<double> sums(const std::vector<double>& full) const {
    const std::vector<FreeParameter> free = free_parameters();
    std::vector<double> out(count(), 0);
    for (std::size_t i = 0; i < free.size(); ++i)
      if (free[i].variable >= 0) out[static_cast<std::size_t>(free[i].variable)] += free[i].unit * full[i];
    return out;
  }

  // What the slope becomes, by that matrix, where the means and shared parameters are no longer those of another place.
  void move_slope(const std::vector<double>& full, const SearchedPlace& from, std::vector<double>& slope) const {
    std::vector<double> less(first_shared() + kSharedParameters.size(), 0);
    for (std::size_t c = 0; c < conditions_; ++c) less[c] = from.place.mu[c] - start_.place.mu[c];
    for (std::size_t i = 0; i < kSharedParameters.size(); ++i) {
      const double before = value_of(from.shared, kSharedParameters[i]),
                   now = value_of(start_.shared, kSharedParameters[i]);
      if (before != now) less[first_shared() + i] = before - now;
    }
    std::vector<double> more(less.size(), 0);
    for (std::size_t i = 0; i < less.size(); ++i)
      for (std::size_t j = 0; j < less.size(); ++j) more[i] += full[i * less.size() + j] * less[j];
    more = sums(more);
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] += more[i];
  }

  // That matrix where nothing is known yet: of a linear mixed model, and of the scores of participants.
  std::vector<double> first_information(const std::vector<double>& mixed_model,
                                        const HierarchicalLikelihood::Value& at) const {
    const std::size_t known = first_shared(), all = known + kSharedParameters.size();
    std::vector<double> full(all * all, 0);
    for (std::size_t i = 0; i < known; ++i)
      for (std::size_t j = 0; j < known; ++j) full[i * all + j] = mixed_model[i * known + j];
    for (const SharedParameter which : shared_) {
      const double unit = unit_of(which);
      const double longest = at_least_zero(which) ? kLongestOfRates : kLongestOfOthers;
      full[(known + static_cast<std::size_t>(which)) * (all + 1)] =
          std::max({of(at.squares_by_shared, which), std::abs(of(at.by_shared, which)) / (longest * unit),
                    kLeastOfShared / (unit * unit)});
    }
    return full;
  }

  // Back: that matrix with what a search has found of the parameters that were free each for itself.
  std::vector<double> information(std::vector<double> full, const std::vector<double>& curvature) const {
    const std::vector<FreeParameter> free = free_parameters();
    const std::size_t n = count();
    const auto alone = [&](std::size_t i) {
      return free[i].variable >= 0 && std::count_if(free.begin(), free.end(), [&](const FreeParameter& one) {
                                        return one.variable == free[i].variable;
                                      }) == 1;
    };
    for (std::size_t i = 0; i < free.size(); ++i)
      for (std::size_t j = 0; j < free.size(); ++j)
        if (alone(i) && alone(j))
          full[i * free.size() + j] =
              (curvature[static_cast<std::size_t>(free[i].variable) * n + static_cast<std::size_t>(free[j].variable)] -
               (i == j ? kRidge : 0)) /
              (free[i].unit * free[j].unit);
    return full;
  }

  NewtonBox box(const std::vector<double>& x) const {
    NewtonBox box;
    const auto add = [&](double low, double high) {
      const double at = x[box.lower.size()];
      box.lower.push_back(std::min(at, low));
      box.upper.push_back(std::max(at, high));
    };
    const auto about = [&](double reach) { add(x[box.lower.size()] - reach, x[box.lower.size()] + reach); };
    for (std::size_t i = 0; i < means_; ++i)
      add(std::max(form_.lowest, x[i] - kFurthestMean), std::min(form_.highest, x[i] + kFurthestMean));
    for (std::size_t c = 0; c < criteria(); ++c) about(kFurthestCriterion);
    for (int i = 0; i < form_.tu + form_.tv + form_.tw; ++i)
      add(kSmallestSpread * kSmallestSpread, kLargestSpread * kLargestSpread);
    if (form_.rho) add(-kLargestCorrelation, kLargestCorrelation);
    for (const SharedParameter which : shared_) {
      const SharedLimits limits = limits_of(which, unit_);
      add(limits.low / unit_of(which), limits.high / unit_of(which));
    }
    return box;
  }

  // A spread that the search left as small as it may be is 0.
  HierarchicalPlace settled(HierarchicalPlace place) const {
    constexpr double kAtBound = 1.001 * kSmallestSpread;
    if (form_.tu && place.tu < kAtBound) place.tu = 0;
    if (form_.tv && place.tv < kAtBound) place.tv = 0;
    if (form_.tw && place.tw / unit_ < kAtBound) place.tw = 0;
    return place;
  }

 private:
  struct FreeParameter {
    int variable = -1;  // -1: held
    double unit = 1;
  };
  // In the order of a matrix over all parameters.
  std::vector<FreeParameter> free_parameters() const {
    std::vector<FreeParameter> free;
    for (const int one : form_.of) free.push_back({one});
    int next = static_cast<int>(means_);
    for (std::size_t c = 0; c < conditions_; ++c) free.push_back({holds_criterion(c) ? -1 : next++, unit_});
    for (const bool spread : {form_.tu, form_.tv}) free.push_back({spread ? next++ : -1});
    free.push_back({form_.tw ? next++ : -1, unit_ * unit_});
    free.push_back({form_.rho ? next++ : -1});
    for (const SharedParameter which : kSharedParameters)
      free.push_back({form_.shared.has(which) ? next++ : -1, unit_of(which)});
    return free;
  }
  bool holds_criterion(std::size_t condition) const noexcept {
    return form_.held_criterion == static_cast<int>(condition);
  }
  std::size_t first_shared() const noexcept { return 2 * conditions_ + 4; }
  double unit_of(SharedParameter which) const noexcept { return of_criterion(which) ? unit_ : 1; }
  static double of(const OfSharedParameters& numbers, SharedParameter which) noexcept {
    return numbers[static_cast<std::size_t>(which)];
  }
  std::size_t criteria() const noexcept { return conditions_ - (form_.held_criterion >= 0 ? 1 : 0); }

  const HierarchicalForm& form_;
  SearchedPlace start_;
  double unit_;
  std::size_t conditions_, means_ = 0;
  std::vector<SharedParameter> shared_;
};

// What maximise_in_box asks for. The curvature begins as what is known, or as that of a linear mixed model, and is
// corrected by every step.
class SearchedLikelihood {
 public:
  SearchedLikelihood(HierarchicalLikelihood& likelihood, const HierarchicalForm& form, const Variables& variables,
                     std::vector<double> information)
      : likelihood_(likelihood), form_(form), variables_(variables), information_(std::move(information)) {}

  double value(const std::vector<double>& x) const { return look_at(x).log_likelihood; }

  HierarchicalLikelihood::Value look(const SearchedPlace& at) const {
    likelihood_.set_shared(at.shared);
    return likelihood_.at(at.place, form_.shared);
  }

  void derivatives(const std::vector<double>& x, NewtonDerivatives& at) const {
    const HierarchicalLikelihood::Value& value = look_at(x);
    const HierarchicalPlace place = variables_.to(x).place;
    at.value = value.log_likelihood;
    at.gradient = variables_.slope(value.slope, value.by_shared, place);
    if (curvature_.empty()) {
      if (information_.empty())
        information_ =
            variables_.first_information(marginal_information(likelihood_.cell_information(place), place), value);
      curvature_.begin(variables_.curvature(information_), x, at.gradient);
    } else {
      curvature_.correct(x, at.gradient);
    }
    at.curvature = at.expected = curvature_.matrix();
  }

  void turned_down() const { curvature_.undo(); }

  std::vector<double> information() const { return variables_.information(information_, curvature_.matrix()); }

  // Of a place that was looked at: the last one, or the one before, which a search comes back to.
  std::optional<HierarchicalLikelihood::Value> found_at(const std::vector<double>& x) const {
    for (const auto& [place, value] : looked_at_)
      if (place == x) return value;
    return std::nullopt;
  }

 private:
  const HierarchicalLikelihood::Value& look_at(const std::vector<double>& x) const {
    for (const auto& [place, value] : looked_at_)
      if (place == x) return value;
    if (looked_at_.size() > 1) looked_at_.erase(looked_at_.begin());
    return looked_at_.emplace_back(x, look(variables_.to(x))).second;
  }

  HierarchicalLikelihood& likelihood_;
  const HierarchicalForm& form_;
  const Variables& variables_;
  mutable std::vector<double> information_;
  mutable CorrectedCurvature curvature_;
  mutable std::vector<std::pair<std::vector<double>, HierarchicalLikelihood::Value>> looked_at_;
};

// The likelihood of answers with one ln s and one criterion, this in `unit`.
class PooledAnswers {
 public:
  PooledAnswers(std::span<const HierarchicalCell> cells, ResponseModel model, const SharedParameters& shared,
                double unit)
      : cells_(cells), model_(model), shared_(shared), unit_(unit) {
    for (const HierarchicalCell& cell : cells) design_.push_back({cell.level, cell.counts().trials()});
  }

  double value(const std::vector<double>& x) const {
    double value = 0;
    for (const HierarchicalCell& cell : cells_)
      value += log_likelihood_of(cell.counts(), model_, cell.level, x[0], x[1] * unit_, shared_);
    return value;
  }

  void derivatives(const std::vector<double>& x, NewtonDerivatives& at) const {
    constexpr double kNudge = 1e-5;
    at.value = value(x);
    at.gradient = {(value({x[0] + kNudge, x[1]}) - value({x[0] - kNudge, x[1]})) / (2 * kNudge),
                   (value({x[0], x[1] + kNudge}) - value({x[0], x[1] - kNudge})) / (2 * kNudge)};
    const CellInformation told = expected_information(model_, design_, x[0], x[1] * unit_, shared_);
    at.curvature =
        at.expected = {told.s + kRidge, told.both * unit_, told.both * unit_, told.k * unit_ * unit_ + kRidge};
  }

 private:
  std::span<const HierarchicalCell> cells_;
  ResponseModel model_;
  const SharedParameters& shared_;
  double unit_;
  std::vector<LevelTrials> design_;
};

}  // namespace

HierarchicalForm HierarchicalForm::separate(std::size_t conditions) {
  HierarchicalForm form;
  form.of.resize(conditions);
  std::iota(form.of.begin(), form.of.end(), 0);
  form.offset.assign(conditions, 0);
  return form;
}

HierarchicalForm HierarchicalForm::common(std::size_t conditions) {
  HierarchicalForm form;
  form.of.assign(conditions, 0);
  form.offset.assign(conditions, 0);
  return form;
}

HierarchicalForm HierarchicalForm::with_mean(std::size_t condition, double mean) const {
  HierarchicalForm form = *this;
  form.of[condition] = -1;
  form.offset[condition] = mean;
  for (std::size_t c = condition + 1; c < of.size(); ++c) --form.of[c];
  return form;
}

HierarchicalForm HierarchicalForm::with_difference(std::size_t a, std::size_t b, double difference) const {
  HierarchicalForm form = *this;
  form.of[a] = form.of[b];
  form.offset[a] = difference;
  for (int& one : form.of)
    if (one > of[a]) --one;
  return form;
}

HierarchicalPlace moved(const HierarchicalForm& form, const HierarchicalPlace& place) {
  const Variables variables(form, {place, {}}, 1);
  HierarchicalPlace out = place;
  out.mu = variables.to(variables.start()).place.mu;
  return out;
}

HierarchicalMaximum moved(const HierarchicalForm& form, const HierarchicalMaximum& from, const SharedParameters& held,
                          double criterion_unit) {
  HierarchicalMaximum out = from;
  out.place = moved(form, from.place);
  out.shared = held;
  const Variables variables(form, {out.place, out.shared}, criterion_unit);
  std::vector<double> x = variables.start(), step;
  NewtonDerivatives at;
  at.gradient = variables.slope(from.slope, from.slope_by_shared, variables.to(x).place);
  variables.move_slope(from.information, {from.place, from.shared}, at.gradient);
  at.curvature = at.expected = variables.curvature(from.information);
  const NewtonBox box = variables.box(x);
  if (!newton_direction(at, box, x, step)) return out;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::clamp(x[i] + step[i], box.lower[i], box.upper[i]);
  const SearchedPlace there = variables.to(x);
  out.place = variables.settled(there.place);
  out.shared = there.shared;
  return out;
}

HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalMaximum& from, double criterion_unit, double negligible, double wanted) {
  const Variables variables(form, {from.place, from.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, from.information);
  const std::vector<double> x = variables.start();
  const NewtonResult found = maximise_in_box(function, x, variables.box(x), wanted, negligible);
  HierarchicalMaximum maximum;
  const auto [place, shared] = variables.to(found.place);
  maximum.place = variables.settled(place);
  maximum.shared = shared;
  likelihood.set_shared(shared);
  const std::optional<HierarchicalLikelihood::Value> known = function.found_at(found.place);
  HierarchicalLikelihood::Value value = known ? *known : function.look({place, shared});
  // At 0 ln L differs from its value at the smallest spread by its slope in the square, to 1e-10; other slopes by less.
  for (double HierarchicalPlace::*spread : {&HierarchicalPlace::tu, &HierarchicalPlace::tv, &HierarchicalPlace::tw}) {
    if (maximum.place.*spread == place.*spread) continue;
    value.log_likelihood -= value.slope.*spread * place.*spread / 2;
    value.slope.*spread = 0;
  }
  maximum.slope = value.slope;
  maximum.slope_by_shared = value.by_shared;
  maximum.log_likelihood = value.log_likelihood;
  maximum.converged = found.converged && std::isfinite(value.log_likelihood);
  maximum.information = function.information();
  return maximum;
}

HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalPlace& start, double criterion_unit, double negligible,
                             const std::vector<double>& information) {
  HierarchicalMaximum from;
  from.place = start;
  from.shared = likelihood.shared();
  from.information = information;
  return maximise(likelihood, form, from, criterion_unit, negligible);
}

HierarchicalMaximum maximise_by_way_of(HierarchicalLikelihood& rough, HierarchicalLikelihood& likelihood,
                                       const HierarchicalForm& form, const HierarchicalMaximum& from,
                                       double criterion_unit, double negligible) {
  constexpr double kNear = 1e-5;  // of ln L
  const HierarchicalMaximum near = maximise(rough, form, from, criterion_unit, kNear);
  likelihood.begin_like(rough);
  return maximise(likelihood, form, near, criterion_unit, negligible);
}

void observe_information(HierarchicalLikelihood& likelihood, const HierarchicalForm& form, HierarchicalMaximum& maximum,
                         double criterion_unit) {
  constexpr double kStep = 0.05;  // standard errors
  const Variables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, {});
  const std::vector<double> x = variables.start(), expected = variables.curvature(maximum.information);
  const NewtonBox box = variables.box(x);
  const auto slope_at = [&](const std::vector<double>& there) {
    const SearchedPlace place = variables.to(there);
    const HierarchicalLikelihood::Value value = function.look(place);
    return variables.slope(value.slope, value.by_shared, place.place);
  };
  const std::size_t n = x.size();
  const std::vector<double> here = slope_at(x);
  std::vector<double> observed(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> beside = x;
    const double step = kStep / std::sqrt(expected[i * n + i]);
    beside[i] += x[i] + step > box.upper[i] ? -step : step;
    const std::vector<double> slope = slope_at(beside);
    for (std::size_t j = 0; j < n; ++j) {
      const double second = (here[j] - slope[j]) / (beside[i] - x[i]);
      observed[i * n + j] += second / 2;
      observed[j * n + i] += second / 2;
    }
  }
  likelihood.set_shared(maximum.shared);
  std::vector<double> factored = observed, unused(n, 0);
  if (solve_positive_definite(factored, unused))
    maximum.information = variables.information(maximum.information, observed);
}

double standard_error(const HierarchicalForm& form, const HierarchicalMaximum& maximum,
                      const std::vector<double>& times, double criterion_unit) {
  constexpr double kHeld = 1e12;  // times its curvature: what else lies at the end of what it can be
  const Variables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  const std::vector<double> x = variables.start(), wanted = variables.sums(times),
                            slope = variables.slope(maximum.slope, maximum.slope_by_shared, variables.to(x).place);
  const NewtonBox box = variables.box(x);
  std::vector<double> curvature = variables.curvature(maximum.information), moves = wanted;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (wanted[i] == 0 && ((x[i] <= box.lower[i] && slope[i] <= 0) || (x[i] >= box.upper[i] && slope[i] >= 0)))
      curvature[i * (x.size() + 1)] *= kHeld;
  if (!solve_positive_definite(curvature, moves)) return kInf;
  return std::sqrt(std::inner_product(wanted.begin(), wanted.end(), moves.begin(), 0.0));
}

PooledMaximum pooled_maximum(std::span<const HierarchicalCell> cells, ResponseModel model,
                             const SharedParameters& shared, const PooledMaximum& start, bool hold_ln_s) {
  std::map<double, HierarchicalCell> together;  // by level
  for (const HierarchicalCell& cell : cells) {
    HierarchicalCell& one = together[cell.level];
    one.level = cell.level;
    one.positive += cell.positive;
    one.negative += cell.negative;
    one.sure_positive += cell.sure_positive;
    one.sure_negative += cell.sure_negative;
  }
  const double unit = model == ResponseModel::choice ? std::exp(start.ln_s) : 1;
  std::vector<HierarchicalCell> levels;
  for (const auto& [level, cell] : together) levels.push_back(cell);
  const PooledAnswers function(levels, model, shared, unit);
  const std::vector<double> x = {start.ln_s, start.criterion / unit};
  const double reach = hold_ln_s ? 0 : kFurthestMean;
  const NewtonBox box = {{x[0] - reach, x[1] - kFurthestCriterion}, {x[0] + reach, x[1] + kFurthestCriterion}};
  const NewtonResult found = maximise_in_box(function, x, box, -kInf, kPooledNegligible);
  return {found.place[0], found.place[1] * unit, found.value};
}

namespace {

// Times the range of levels: beyond it they do not tell a JND.
constexpr double kOutside = 12, kBeyond = 0.2;

}  // namespace

double SearchRange::lowest() const noexcept {
  return least - kBeyond;
}

double SearchRange::highest() const noexcept {
  return greatest + kBeyond;
}

SearchRange search_range(std::span<const HierarchicalCell> cells, ResponseModel model) {
  if (cells.empty()) throw std::invalid_argument("a hierarchical analysis needs answers");
  std::set<double> levels;
  for (const HierarchicalCell& cell : cells) levels.insert(cell.level);
  const bool choice = model == ResponseModel::choice;
  double smallest = kInf, largest = 0;
  if (!choice) {
    for (const double level : levels)
      if (level != 0) smallest = std::min(smallest, std::abs(level));
    largest = std::max(std::abs(*levels.begin()), std::abs(*levels.rbegin()));
  } else {
    for (auto next = std::next(levels.begin()); next != levels.end(); ++next)
      smallest = std::min(smallest, *next - *std::prev(next));
    largest = *levels.rbegin() - *levels.begin();
  }
  if (!(largest > 0)) throw std::invalid_argument("a hierarchical analysis needs levels that differ");
  SearchRange range;
  range.start.ln_s = std::log(largest / (choice ? 4 : 2));
  range.start.criterion = model == ResponseModel::yes_no ? 0.7 : 0;
  range.criterion_unit = choice ? std::exp(range.start.ln_s) : 1;
  range.greatest = std::log(kOutside * largest);
  range.least = std::log(smallest / kOutside);
  return range;
}

}  // namespace jnd
