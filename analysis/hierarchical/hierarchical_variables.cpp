#include "analysis/hierarchical/hierarchical_variables.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace jnd {

SearchedVariables::SearchedVariables(const HierarchicalForm& form, SearchedPlace start, double criterion_unit)
    : form_(form), start_(std::move(start)), unit_(criterion_unit), conditions_(form.of.size()) {
  for (const int one : form.of) means_ = std::max(means_, static_cast<std::size_t>(one + 1));
  for (const SharedParameter which : kSharedParameters)
    if (form.shared.has(which)) shared_.push_back(which);
}

std::size_t SearchedVariables::criteria() const noexcept {
  return conditions_ -
         static_cast<std::size_t>(std::count(form_.held_criteria.begin(), form_.held_criteria.end(), true));
}

std::size_t SearchedVariables::count() const noexcept {
  return means_ + criteria() + spreads() + static_cast<std::size_t>(form_.rho) + shared_.size();
}

std::vector<double> SearchedVariables::start() const {
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

SearchedPlace SearchedVariables::to(const std::vector<double>& x) const {
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

std::vector<double> SearchedVariables::slope(const HierarchicalPlace& by, const OfSharedParameters& by_shared,
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
  for (const SharedParameter which : shared_)
    slope.push_back(by_shared[static_cast<std::size_t>(which)] * unit_of(which));
  return slope;
}

NewtonBox SearchedVariables::box(const std::vector<double>& x) const {
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

HierarchicalPlace SearchedVariables::settled(HierarchicalPlace place) const {
  constexpr double kAtBound = 1.001 * kSmallestSpread;
  for (const auto& [spread, unit] : free_spreads(form_, place, unit_))
    if (*spread / unit < kAtBound) *spread = 0;
  return place;
}

// In the units of a search; spreads, which no number moves, are left out.
std::vector<double> SearchedVariables::in_numbers(const SearchedPlace& at) const {
  std::vector<double> in = at.place.mu;
  for (const double kappa : at.place.kappa) in.push_back(kappa / unit_);
  in.resize(2 * conditions_ + spreads(), 0);
  in.push_back(at.place.rho);
  for (const SharedParameter which : kSharedParameters) {
    const double value = value_of(at.shared, which) / unit_of(which);
    in.push_back(std::isfinite(value) ? value : 0);
  }
  return in;
}

// By variable: which numbers it moves.
std::vector<std::vector<std::size_t>> SearchedVariables::moved_numbers() const {
  std::vector<std::vector<std::size_t>> moved(means_);
  for (std::size_t c = 0; c < conditions_; ++c)
    if (form_.of[c] >= 0) moved[static_cast<std::size_t>(form_.of[c])].push_back(c);
  for (std::size_t c = 0; c < conditions_; ++c)
    if (!holds_criterion(c)) moved.push_back({conditions_ + c});
  const std::size_t rho = 2 * conditions_ + spreads();
  for (std::size_t number = 2 * conditions_; number < rho; ++number) moved.push_back({number});
  if (form_.rho) moved.push_back({rho});
  for (const SharedParameter which : shared_) moved.push_back({rho + 1 + static_cast<std::size_t>(which)});
  return moved;
}

std::vector<double> SearchedVariables::of_numbers(const std::vector<double>& curvature) const {
  const std::vector<std::vector<std::size_t>> moved = moved_numbers();
  const std::size_t n = count(), all = numbers();
  std::vector<double> of(n * n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (const std::size_t a : moved[i])
        for (const std::size_t b : moved[j]) of[i * n + j] += curvature[a * all + b];
  for (std::size_t i = 0; i < n; ++i)
    if (of[i * (n + 1)] <= 0) return {};
  return of;
}

std::vector<double> SearchedVariables::by_number(const std::vector<double>& curvature) const {
  const std::vector<std::vector<std::size_t>> moved = moved_numbers();
  const std::size_t n = count(), all = numbers();
  std::vector<double> by(all * all, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) by[moved[i].front() * all + moved[j].front()] = curvature[i * n + j];
  return by;
}

SearchedVariables::Fall SearchedVariables::fall_towards(const SearchedPlace& there,
                                                        const std::vector<double>& curvature) const {
  const std::vector<double> from = in_numbers(start_), to = in_numbers(there);
  const std::size_t all = numbers();
  std::vector<double> fall(all, 0);
  Fall found;
  for (std::size_t i = 0; i < all; ++i) {
    for (std::size_t j = 0; j < all; ++j) fall[i] += curvature[i * all + j] * (to[j] - from[j]);
    found.along += fall[i] * (to[i] - from[i]);
  }
  for (const std::vector<std::size_t>& one : moved_numbers()) {
    double sum = 0;
    for (const std::size_t number : one) sum += fall[number];
    found.slope.push_back(sum);
  }
  return found;
}

// The expected information of means, criteria and squares of spreads at the start, were what the answers tell of each
// person's ln s and criteria normally distributed; of rho and what is shared about that much.
// Source: McCulloch and Searle 2001, Generalized, Linear, and Mixed Models, chapter 6.
std::vector<double> SearchedVariables::told_together(const HierarchicalLikelihood& likelihood) const {
  constexpr double kRidge = 1e-3;                 // in units of a search
  constexpr double kOfShared = 4, kOfRates = 20;  // what each participant tells
  const HierarchicalPlace& place = start_.place;
  const std::vector<CellInformation> told = likelihood.told_by_one(place);
  const std::size_t n = 2 * conditions_, all = numbers();
  const double tw = place.tw / unit_;
  std::vector<double> variance(n * n, 0);  // of what one person's answers make of them
  for (std::size_t a = 0; a < conditions_; ++a)
    for (std::size_t b = 0; b < conditions_; ++b) {
      variance[a * n + b] = place.tu * place.tu;
      variance[(conditions_ + a) * n + conditions_ + b] = tw * tw;
      variance[a * n + conditions_ + b] = variance[(conditions_ + b) * n + a] = place.rho * place.tu * tw;
    }
  for (std::size_t c = 0; c < conditions_; ++c) {
    const std::size_t k = conditions_ + c;
    const double in_s = told[c].s + kRidge, in_k = told[c].k * unit_ * unit_ + kRidge, both = told[c].both * unit_;
    const double determinant = in_s * in_k - both * both;
    variance[c * (n + 1)] += in_k / determinant + place.tv_of(c) * place.tv_of(c);
    variance[k * (n + 1)] += in_s / determinant;
    variance[c * n + k] -= both / determinant;
    variance[k * n + c] -= both / determinant;
  }
  std::vector<double> precision = inverse_positive_definite(variance, n);
  if (precision.empty()) {
    precision.assign(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) precision[i * (n + 1)] = 1 / variance[i * (n + 1)];
  }
  // Of each spread: the sets of numbers that it moves together.
  std::vector<std::vector<std::vector<std::size_t>>> moved;
  std::vector<std::size_t> means(conditions_), criteria(conditions_);
  std::iota(means.begin(), means.end(), 0);
  std::iota(criteria.begin(), criteria.end(), conditions_);
  if (form_.tu) moved.push_back({means});
  for (std::size_t c = 0; c < conditions_ && form_.tv; ++c)
    if (c == 0 || !place.own_tv.empty())
      moved.push_back({{c}});
    else
      moved.back().push_back({c});
  if (form_.tw) moved.push_back({criteria});
  std::vector<double> information(all * all, 0);
  const auto people = static_cast<double>(likelihood.participants());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) information[i * all + j] = people * precision[i * n + j];
  for (std::size_t i = 0; i < moved.size(); ++i)
    for (std::size_t j = 0; j < moved.size(); ++j)
      for (const std::vector<std::size_t>& one : moved[i])
        for (const std::vector<std::size_t>& other : moved[j]) {
          double sum = 0;
          for (const std::size_t a : one)
            for (const std::size_t b : other) sum += precision[a * n + b];
          information[(n + i) * all + n + j] += people / 2 * sum * sum;
        }
  for (std::size_t number = n + spreads(); number < all; ++number) information[number * (all + 1)] = kOfShared * people;
  for (const SharedParameter which : shared_)
    if (at_least_zero(which))
      information[(n + spreads() + 1 + static_cast<std::size_t>(which)) * (all + 1)] = kOfRates * people;
  return information;
}

std::vector<double> SearchedVariables::first_curvature(const std::vector<double>& slope,
                                                       const HierarchicalLikelihood& likelihood) const {
  constexpr double kLongest = 0.5, kLongestOfSquares = 0.1, kLongestOfRates = 0.05;
  const std::size_t n = count(), before_shared = n - shared_.size(), squares = means_ + criteria();
  std::vector<double> curvature = of_numbers(told_together(likelihood));
  for (std::size_t i = 0; i < n; ++i) {
    const bool rate = i >= before_shared && at_least_zero(shared_[i - before_shared]);
    const bool square = i >= squares && i < squares + spreads();
    double& own = curvature[i * (n + 1)];
    own = std::max(own, std::abs(slope[i]) / (rate ? kLongestOfRates : square ? kLongestOfSquares : kLongest));
  }
  return curvature;
}

}  // namespace jnd
