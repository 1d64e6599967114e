#include "analysis/hierarchical/hierarchical_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "analysis/hierarchical/hierarchical_variables.h"
#include "analysis/numerics/box_newton.h"
#include "analysis/numerics/stop_request.h"

namespace jnd {

namespace {

constexpr double kPooledNegligible = 1e-10;  // ln L of the pooled answers
constexpr double kRoughly = 0.8;             // of the fineness of nodes
constexpr double kLatticesDiffer = 1e-6;     // ln L at places beside each other, on other lattices
constexpr double kPromising = 1e-4;          // more than what is known, on rough nodes

// The curvature of a function whose slopes are known, corrected by every step of a search.
// Minus the second derivatives, positive definite: a square matrix by rows. Of one search, from its first place on.
// Source: Broyden, Fletcher, Goldfarb and Shanno; Nocedal and Wright 2006, Numerical Optimization, equation 6.19.
class CorrectedCurvature {
 public:
  bool empty() const noexcept { return matrix_.empty(); }
  const std::vector<double>& matrix() const noexcept { return matrix_; }

  // At the first place, whose slope is `gradient`: any positive definite matrix near the curvature there.
  void begin(std::vector<double> matrix, const std::vector<double>& place, const std::vector<double>& gradient) {
    matrix_ = std::move(matrix);
    place_ = place;
    gradient_ = gradient;
  }

  // The last correction was of a step that was not taken: from so far off a slope tells little of the curvature here.
  void undo() { std::tie(matrix_, place_, gradient_) = before_; }

  void correct(const std::vector<double>& place, const std::vector<double>& gradient) {
    before_ = {matrix_, place_, gradient_};
    constexpr double kLeastFall = 1e-3;  // of what was expected: else the curvature would not stay positive
    const std::size_t n = place.size();
    std::vector<double> step(n), fall(n), predicted(n, 0);
    double along = 0, expected = 0;
    for (std::size_t i = 0; i < n; ++i) {
      step[i] = place[i] - place_[i];
      fall[i] = gradient_[i] - gradient[i];
      along += step[i] * fall[i];
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) predicted[i] += matrix_[i * n + j] * step[j];
    for (std::size_t i = 0; i < n; ++i) expected += step[i] * predicted[i];
    place_ = place;
    gradient_ = gradient;
    if (!(expected > 0) || along < kLeastFall * expected) return;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        matrix_[i * n + j] += fall[i] * fall[j] / along - predicted[i] * predicted[j] / expected;
  }

 private:
  std::vector<double> matrix_, place_, gradient_;
  std::tuple<std::vector<double>, std::vector<double>, std::vector<double>> before_;  // the same before the last one
};

struct OutOfWork {};

// What maximise_in_box asks for. Every step corrects the curvature.
class SearchedLikelihood {
 public:
  SearchedLikelihood(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                     const SearchedVariables& variables, const std::vector<double>& curvature, double most_work = kInf,
                     const KnownMaximum* known = nullptr)
      : likelihood_(likelihood),
        form_(form),
        variables_(variables),
        first_(curvature),
        most_work_(most_work),
        known_(known) {}

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
    if (!curvature_.empty()) {
      curvature_.correct(x, at.gradient);
    } else {
      std::vector<double> known;
      if (!first_.empty()) known = variables_.of_numbers(first_);
      if (known.empty()) known = variables_.first_curvature(at.gradient, likelihood_);
      curvature_.begin(std::move(known), x, at.gradient);
    }
    at.curvature = at.expected = curvature_.matrix();
  }

  void turned_down() const { curvature_.undo(); }

  // Whether ln L lies where the parabola about the known maximum does, and near it: the search leads there.
  bool is_known(const std::vector<double>& x, double value) const {
    constexpr double kNear = 0.5, kLike = 0.2;  // of ln L, and of its fall
    if (known_ == nullptr || known_->curvature.empty()) return false;
    const double fall = known_->log_likelihood - value;
    if (!(fall < kNear)) return false;
    double expected = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double step = x[i] - known_->place[i];
      expected -= known_->slope[i] * step;
      for (std::size_t j = 0; j < x.size(); ++j)
        expected += known_->curvature[i * x.size() + j] * step * (x[j] - known_->place[j]) / 2;
    }
    return std::abs(fall - expected) < kLike * std::abs(expected);
  }

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
  const SearchedVariables& variables_;
  const std::vector<double>& first_;
  double most_work_;
  const KnownMaximum* known_;
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
    constexpr double kRidge = 1e-3;  // least curvature
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
  const SearchedVariables variables(form, {place, {}}, 1);
  HierarchicalPlace out = place;
  out.mu = variables.to(variables.start()).place.mu;
  return out;
}

HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalMaximum& from, double criterion_unit, double negligible,
                             double most_work, const KnownMaximum* known) {
  const SearchedVariables variables(form, {from.place, from.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, from.curvature, most_work, known);
  const double wanted = known == nullptr ? -kInf : known->log_likelihood + kPromising;
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
  maximum.curvature = variables.by_number(function.curvature());
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

KnownMaximum HierarchicalSearch::on_rough_nodes(const HierarchicalForm& form, const HierarchicalMaximum& best) {
  const SearchedVariables variables(form, {best.place, best.shared}, unit_);
  KnownMaximum known{.place = variables.start()};
  const SearchedPlace there = variables.to(known.place);
  rough_.set_shared(there.shared);
  const HierarchicalLikelihood::Value value = rough_.at(there.place, form.shared);
  known.log_likelihood = value.log_likelihood;
  known.slope = variables.slope(value.slope, value.by_shared, there.place);
  if (!best.curvature.empty()) known.curvature = variables.of_numbers(best.curvature);
  return known;
}

bool HierarchicalSearch::improve(const HierarchicalForm& form, const std::vector<HierarchicalMaximum>& starts,
                                 HierarchicalMaximum& best, double most_work) {
  constexpr double kRoughlyNegligible = 1e-3;  // of ln L
  bool improved = false;
  KnownMaximum known = on_rough_nodes(form, best);
  for (HierarchicalMaximum start : starts) {
    start.curvature.clear();
    const HierarchicalMaximum found =
        maximise(rough_, form, start, unit_, kRoughlyNegligible, most_work - likelihood_.work(), &known);
    if (std::isfinite(known.log_likelihood) && !(found.log_likelihood > known.log_likelihood + kPromising)) continue;
    HierarchicalMaximum better = climbed(form, found, most_work);
    if (!(better.log_likelihood > best.log_likelihood + kNegligible) && std::isfinite(best.log_likelihood)) continue;
    best = std::move(better);
    known = on_rough_nodes(form, best);
    improved = true;
  }
  return improved;
}

double standard_error(const HierarchicalForm& form, const HierarchicalMaximum& maximum,
                      const HierarchicalMaximum& beside, double larger, double criterion_unit) {
  const SearchedVariables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  if (maximum.curvature.empty()) return kNaN;
  const auto [slope, along] = variables.fall_towards({beside.place, beside.shared}, maximum.curvature);
  std::vector<double> curvature = variables.of_numbers(maximum.curvature), step = slope;
  if (curvature.empty() || !solve_positive_definite(curvature, step)) return kNaN;
  const double fall = along - std::inner_product(slope.begin(), slope.end(), step.begin(), 0.0);
  return fall > 0 ? larger / std::sqrt(fall) : kNaN;
}

std::vector<double> observed_information(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                         const HierarchicalMaximum& maximum, double criterion_unit) {
  constexpr double kStep = 1e-2, kHeld = 1e12;  // times its curvature: what lies at the end of what it can be
  const SearchedVariables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  const SearchedLikelihood function(likelihood, form, variables, {});
  const std::vector<double> x = variables.start();
  const NewtonBox box = variables.box(x);
  const auto slope_at = [&](const std::vector<double>& there) {
    const SearchedPlace place = variables.to(there);
    const HierarchicalLikelihood::Value value = function.look(place);
    return variables.slope(value.slope, value.by_shared, place.place);
  };
  const std::size_t n = x.size();
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
  return variables.by_number(information);
}

std::vector<double> covariance_of_means(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                        const HierarchicalMaximum& maximum, double criterion_unit) {
  const SearchedVariables variables(form, {maximum.place, maximum.shared}, criterion_unit);
  const std::size_t n = variables.start().size(), means = variables.means();
  const std::vector<double> information =
      variables.of_numbers(observed_information(likelihood, form, maximum, criterion_unit));
  if (information.empty()) return {};
  const std::vector<double> covariance = inverse_positive_definite(information, n);
  std::vector<double> of_means;
  for (std::size_t i = 0; i < means && !covariance.empty(); ++i)
    of_means.insert(of_means.end(), covariance.begin() + static_cast<std::ptrdiff_t>(i * n),
                    covariance.begin() + static_cast<std::ptrdiff_t>(i * n + means));
  return of_means;
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
