#include "analysis/hierarchical/hierarchical_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "analysis/hierarchical/corrected_curvature.h"
#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

constexpr double kPooledNegligible = 1e-10;  // ln L of the pooled answers
constexpr double kRoughly = 0.8;             // of the fineness of nodes
constexpr double kLatticesDiffer = 1e-6;     // ln L at places beside each other, on other lattices
constexpr double kRidge = 1e-3;              // least curvature of every variable, in its unit

// Where a search stands.
struct SearchedPlace {
  HierarchicalPlace place;
  SharedParameters shared;
};

// Places as vectors of what is free, and back. Spreads enter squared.
class Variables {
 public:
  Variables(const HierarchicalForm& form, SearchedPlace start, double unit)
      : form_(form), start_(std::move(start)), unit_(unit), conditions_(form.of.size()) {
    for (const int one : form.of) means_ = std::max(means_, static_cast<std::size_t>(one + 1));
    for (const SharedParameter which : kSharedParameters)
      if (form.shared.has(which)) shared_.push_back(which);
  }

  std::size_t means() const noexcept { return means_; }
  std::size_t count() const noexcept {
    return means_ + criteria() + spreads() + static_cast<std::size_t>(form_.rho) + shared_.size();
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
    for (const auto& [spread, unit] : free_spreads(form_, place, unit_)) {
      const double one = std::max(*spread / unit, kSmallestSpread);
      x.push_back(one * one);
    }
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
    for (const auto& [spread, unit] : free_spreads(form_, place, unit_)) *spread = std::sqrt(x[i++]) * unit;
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
    const auto by_spreads = free_spreads(form_, by, unit_), spreads = free_spreads(form_, at, unit_);
    for (std::size_t i = 0; i < spreads.size(); ++i)
      slope.push_back(*by_spreads[i].value * spreads[i].unit * spreads[i].unit / (2 * *spreads[i].value));
    if (form_.rho) slope.push_back(by.rho);
    for (const SharedParameter which : shared_) slope.push_back(of(by_shared, which) * unit_of(which));
    return slope;
  }

  // Of a search that knows nothing yet: what each participant tells at spreads of about a third, and no first step longer
  // than these in any variable.
  std::vector<double> first_curvature(const std::vector<double>& slope, std::size_t participants) const {
    constexpr double kLongest = 0.5, kLongestOfSquares = 0.1, kLongestOfRates = 0.05;
    constexpr double kOfOne = 4, kOfOneSquare = 20;
    const std::size_t n = count();
    std::vector<double> curvature(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t before_shared = n - shared_.size(), squares = means_ + criteria();
      const bool rate = i >= before_shared && at_least_zero(shared_[i - before_shared]);
      const bool square = i >= squares && i < squares + spreads();
      curvature[i * (n + 1)] = std::max((square || rate ? kOfOneSquare : kOfOne) * static_cast<double>(participants),
                                        std::abs(slope[i]) / (rate     ? kLongestOfRates
                                                              : square ? kLongestOfSquares
                                                                       : kLongest));
    }
    return curvature;
  }

  NewtonBox box(const std::vector<double>& x) const {
    NewtonBox box;
    const auto add = [&](double low, double high) {
      const double at = x[box.lower.size()];
      box.lower.push_back(std::min(at, low));
      box.upper.push_back(std::max(at, high));
    };
    for (std::size_t i = 0; i < means_; ++i) {
      double low = kInf, high = -kInf;  // any of what is bound together lies in the range: beyond it all are as likely
      for (std::size_t c = 0; c < conditions_; ++c)
        if (form_.of[c] == static_cast<int>(i)) {
          low = std::min(low, form_.lowest - form_.offset[c]);
          high = std::max(high, form_.highest - form_.offset[c]);
        }
      add(low, high);
    }
    for (std::size_t c = 0; c < criteria(); ++c) add(form_.lowest_criterion / unit_, form_.highest_criterion / unit_);
    for (std::size_t i = 0; i < spreads(); ++i) {
      const double largest = form_.tw && i + 1 == spreads() ? kLargestSpreadOfCriteria : kLargestSpread;
      add(kSmallestSpread * kSmallestSpread, largest * largest);
    }
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
    for (const auto& [spread, unit] : free_spreads(form_, place, unit_))
      if (*spread / unit < kAtBound) *spread = 0;
    return place;
  }

 private:
  bool holds_criterion(std::size_t condition) const noexcept {
    return condition < form_.held_criteria.size() && form_.held_criteria[condition];
  }
  std::size_t spreads() const { return free_spreads(form_, start_.place, unit_).size(); }
  double unit_of(SharedParameter which) const noexcept { return of_criterion(which) ? unit_ : 1; }
  static double of(const OfSharedParameters& numbers, SharedParameter which) noexcept {
    return numbers[static_cast<std::size_t>(which)];
  }
  std::size_t criteria() const noexcept {
    return conditions_ -
           static_cast<std::size_t>(std::count(form_.held_criteria.begin(), form_.held_criteria.end(), true));
  }

  const HierarchicalForm& form_;
  SearchedPlace start_;
  double unit_;
  std::size_t conditions_, means_ = 0;
  std::vector<SharedParameter> shared_;
};

struct OutOfWork {};

// What maximise_in_box asks for. Every step corrects the curvature.
class SearchedLikelihood {
 public:
  SearchedLikelihood(HierarchicalLikelihood& likelihood, const HierarchicalForm& form, const Variables& variables,
                     const std::vector<double>& curvature, double most_work = kInf)
      : likelihood_(likelihood), form_(form), variables_(variables), first_(curvature), most_work_(most_work) {}

  double value(const std::vector<double>& x) const { return look_at(x).log_likelihood; }

  HierarchicalLikelihood::Value look(const SearchedPlace& at) const {
    stop_if_requested();
    if (likelihood_.work() > most_work_ && !best_.empty()) throw OutOfWork();
    likelihood_.set_shared(at.shared);
    return likelihood_.at(at.place, form_.shared);
  }

  void derivatives(const std::vector<double>& x, NewtonDerivatives& at) const {
    const HierarchicalLikelihood::Value& value = look_at(x);
    at.value = value.log_likelihood;
    at.gradient = variables_.slope(value.slope, value.by_shared, variables_.to(x).place);
    const bool known = first_.size() == x.size() * x.size();
    if (!curvature_.empty())
      curvature_.correct(x, at.gradient);
    else
      curvature_.begin(known ? first_ : variables_.first_curvature(at.gradient, likelihood_.participants()), x,
                       at.gradient);
    at.curvature = at.expected = curvature_.matrix();
  }

  void turned_down() const { curvature_.undo(); }

  const std::vector<double>& curvature() const { return curvature_.matrix(); }
  // Of the places that were looked at.
  const std::vector<double>& best() const noexcept { return best_; }
  double best_value() const noexcept { return best_value_; }

  // Of a place that was looked at: the last one, or the one before, which a search comes back to.
  HierarchicalLikelihood::Value found_at(const std::vector<double>& x) const {
    for (const auto& [place, value] : looked_at_)
      if (place == x) return value;
    return likelihood_.at(variables_.to(x).place, form_.shared);
  }

 private:
  const HierarchicalLikelihood::Value& look_at(const std::vector<double>& x) const {
    for (const auto& [place, value] : looked_at_)
      if (place == x) return value;
    if (looked_at_.size() > 1) looked_at_.erase(looked_at_.begin());
    const HierarchicalLikelihood::Value& value = looked_at_.emplace_back(x, look(variables_.to(x))).second;
    if (best_.empty() || value.log_likelihood > best_value_) {
      best_ = x;
      best_value_ = value.log_likelihood;
    }
    return value;
  }

  HierarchicalLikelihood& likelihood_;
  const HierarchicalForm& form_;
  const Variables& variables_;
  const std::vector<double>& first_;
  double most_work_;
  mutable CorrectedCurvature curvature_;
  mutable std::vector<double> best_;
  mutable double best_value_ = -kInf;
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
    at.value = value(x);
    at.gradient = {0, 0};
    for (const HierarchicalCell& cell : cells_) {
      const AnswerSlopes slopes = slopes_of(cell.counts(), model_, cell.level, x[0], x[1] * unit_, shared_);
      at.gradient[0] += slopes.s;
      at.gradient[1] += slopes.k * unit_;
    }
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
  for (int& one : form.of)
    if (one > of[condition]) --one;
  form.of[condition] = -1;
  form.offset[condition] = mean;
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

HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalMaximum& from, double criterion_unit, double negligible,
                             double most_work, double wanted) {
  const Variables variables(form, {from.place, from.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, from.curvature, most_work);
  const std::vector<double> x = variables.start();
  NewtonResult found;
  try {
    found = maximise_in_box(function, x, variables.box(x), wanted, negligible, kLatticesDiffer);
    if (function.best_value() > found.value) found.place = function.best();
  } catch (const OutOfWork&) {
    found.place = function.best();
  }
  HierarchicalMaximum maximum;
  const auto [place, shared] = variables.to(found.place);
  maximum.place = variables.settled(place);
  maximum.shared = shared;
  HierarchicalLikelihood::Value value = function.found_at(found.place);
  likelihood.set_shared(shared);
  // At 0 ln L differs from its value at the smallest spread by its slope in the square, to 1e-10; other slopes by less.
  const auto before = free_spreads(form, place);
  const auto now = free_spreads(form, maximum.place), slopes = free_spreads(form, value.slope);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (*now[i].value == *before[i].value) continue;
    value.log_likelihood -= *slopes[i].value * *before[i].value / 2;
    *slopes[i].value = 0;
  }
  maximum.slope = value.slope;
  maximum.slope_by_shared = value.by_shared;
  maximum.log_likelihood = value.log_likelihood;
  maximum.converged = found.converged && std::isfinite(value.log_likelihood);
  maximum.curvature = function.curvature();
  return maximum;
}

HierarchicalSearch::HierarchicalSearch(std::span<const HierarchicalCell> cells, ResponseModel model,
                                       const SharedParameters& shared, double fineness, double criterion_unit)
    : likelihood_(cells, model, shared, fineness),
      rough_(cells, model, shared, kRoughly * fineness),
      unit_(criterion_unit) {}

HierarchicalMaximum HierarchicalSearch::climbed(const HierarchicalForm& form, const HierarchicalMaximum& from,
                                                double most_work, double negligible) {
  return maximise(likelihood_, form, from, unit_, negligible, most_work - rough_.work());
}

bool HierarchicalSearch::improve(const HierarchicalForm& form, HierarchicalMaximum start, HierarchicalMaximum& best,
                                 double most_work) {
  constexpr double kRoughlyNegligible = 1e-3, kPromising = 1e-4;  // of ln L
  start.curvature.clear();
  rough_.set_shared(best.shared);
  const double known = rough_.at(best.place).log_likelihood;
  const HierarchicalMaximum found =
      maximise(rough_, form, start, unit_, kRoughlyNegligible, most_work - likelihood_.work(), known + kPromising);
  if (std::isfinite(known) && !(found.log_likelihood > known + kPromising)) return false;
  HierarchicalMaximum better = climbed(form, found, most_work);
  if (!(better.log_likelihood > best.log_likelihood + kNegligible) && std::isfinite(best.log_likelihood)) return false;
  best = std::move(better);
  return true;
}

std::vector<double> covariance_of_means(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                        const HierarchicalMaximum& maximum, double criterion_unit) {
  constexpr double kStep = 1e-2, kHeld = 1e12;  // times its curvature: what lies at the end of what it can be
  const Variables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, {});
  const std::vector<double> x = variables.start();
  const NewtonBox box = variables.box(x);
  const auto slope_at = [&](const std::vector<double>& there) {
    const SearchedPlace place = variables.to(there);
    const HierarchicalLikelihood::Value value = function.look(place);
    return variables.slope(value.slope, value.by_shared, place.place);
  };
  const std::size_t n = x.size(), means = variables.means();
  const std::vector<double> here = slope_at(x);
  std::vector<double> information(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> beside = x;
    beside[i] += x[i] + kStep > box.upper[i] ? -kStep : kStep;
    const std::vector<double> slope = slope_at(beside);
    for (std::size_t j = 0; j < n; ++j) {
      const double second = (here[j] - slope[j]) / (beside[i] - x[i]);
      information[i * n + j] += second / 2;
      information[j * n + i] += second / 2;
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    if ((x[i] <= box.lower[i] && here[i] <= 0) || (x[i] >= box.upper[i] && here[i] >= 0))
      information[i * (n + 1)] = std::max(kHeld, kHeld * information[i * (n + 1)]);
  std::vector<double> covariance(means * means);
  for (std::size_t i = 0; i < means; ++i) {
    std::vector<double> factor = information, column(n, 0);
    column[i] = 1;
    if (!solve_positive_definite(factor, column)) return {};
    std::copy_n(column.begin(), means, covariance.begin() + static_cast<std::ptrdiff_t>(i * means));
  }
  return covariance;
}

PooledMaximum pooled_maximum(std::span<const HierarchicalCell> cells, ResponseModel model,
                             const SharedParameters& shared, const SearchRange& range, double held_ln_s) {
  std::map<double, HierarchicalCell> together;  // by level
  for (const HierarchicalCell& cell : cells) {
    HierarchicalCell& one = together[cell.level];
    one.level = cell.level;
    one.positive += cell.positive;
    one.negative += cell.negative;
    one.sure_positive += cell.sure_positive;
    one.sure_negative += cell.sure_negative;
  }
  std::vector<HierarchicalCell> levels;
  for (const auto& [level, cell] : together) levels.push_back(cell);
  const double unit = range.criterion_unit;
  const PooledAnswers function(levels, model, shared, unit);
  const bool held = !std::isnan(held_ln_s);
  const NewtonBox box = {{held ? held_ln_s : range.lowest(), range.lowest_criterion / unit},
                         {held ? held_ln_s : range.highest(), range.highest_criterion / unit}};
  // From the middle of the levels, and from where they are steep and shallow: a step has slopes of next to 0.
  PooledMaximum best;
  best.log_likelihood = -kInf;
  constexpr double kAside = 1.5;
  for (const double aside : {0.0, -kAside, kAside}) {
    const double ln_s = held ? held_ln_s : std::clamp(range.ln_s + aside, box.lower[0], box.upper[0]);
    if (held && aside != 0) break;
    const NewtonResult found = maximise_in_box(function, {ln_s, range.criterion / unit}, box, -kInf, kPooledNegligible);
    if (found.value > best.log_likelihood) best = {found.place[0], found.place[1] * unit, found.value};
  }
  return best;
}

namespace {

// Times the range of levels: beyond it they do not tell a JND.
constexpr double kOutside = 12, kBeyond = 0.2;
constexpr double kRoomOfCriteria = 8;  // z; of choices, units beside the levels

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
  range.ln_s = std::log(largest / (choice ? 4 : 2));
  range.criterion = model == ResponseModel::yes_no ? 0.7 : 0;
  range.criterion_unit = choice ? std::exp(range.ln_s) : 1;
  // A step at the largest level has that criterion where ln s is least.
  const double steepest = kOutside * std::exp(kBeyond) * largest / smallest;
  range.lowest_criterion = -kRoomOfCriteria;
  range.highest_criterion = kRoomOfCriteria + (model == ResponseModel::differencing ? std::log(steepest) : steepest);
  if (choice) {
    range.criterion = std::clamp(0.0, *levels.begin(), *levels.rbegin());
    range.lowest_criterion = *levels.begin() - kRoomOfCriteria * range.criterion_unit;
    range.highest_criterion = *levels.rbegin() + kRoomOfCriteria * range.criterion_unit;
  }
  range.greatest = std::log(kOutside * largest);
  range.least = std::log(smallest / kOutside);
  return range;
}

}  // namespace jnd
