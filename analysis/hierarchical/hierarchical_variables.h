// What a search varies: a place, and what is shared, as a vector of what is free; and what is known of the curvature of ln L
// there.
//
// Spreads enter squared, criteria and their spreads in units of a search. Curvatures, minus second derivatives as square
// matrices by rows, are kept by number: mu and kappa of each condition, the free spreads, rho, and what is shared; so that
// one search can begin with what another of the same answers found, with fewer numbers free.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/hierarchical/hierarchical_search.h"
#include "analysis/numerics/box_newton.h"

namespace jnd {

// Where a search stands.
struct SearchedPlace {
  HierarchicalPlace place;
  SharedParameters shared;
};

// Of one form, which outlives it.
class SearchedVariables {
 public:
  SearchedVariables(const HierarchicalForm& form, SearchedPlace start, double criterion_unit);

  std::size_t means() const noexcept { return means_; }
  std::size_t count() const noexcept;  // of what is free: means, criteria, spreads, rho, what is shared

  // The start; spreads no less than the smallest.
  std::vector<double> start() const;
  SearchedPlace to(const std::vector<double>& x) const;
  std::vector<double> slope(const HierarchicalPlace& by, const OfSharedParameters& by_shared,
                            const HierarchicalPlace& at) const;
  NewtonBox box(const std::vector<double>& x) const;
  // A spread that the search left as small as it may be is 0.
  HierarchicalPlace settled(HierarchicalPlace place) const;

  // Curvature by number of a form that binds some of them or holds them; empty where it frees one that was held.
  std::vector<double> of_numbers(const std::vector<double>& curvature) const;
  // And back: of what is bound, as if only the first of it were there.
  std::vector<double> by_number(const std::vector<double>& curvature) const;
  // Of a search that knows nothing yet: what everybody's answers tell together, and no first step longer than half a unit.
  std::vector<double> first_curvature(const std::vector<double>& slope, const HierarchicalLikelihood& likelihood) const;

  // Minus the slope of ln L in what is free, and along it, where from the start of these all goes to another place, by that
  // curvature by number.
  struct Fall {
    std::vector<double> slope;
    double along = 0;
  };
  Fall fall_towards(const SearchedPlace& there, const std::vector<double>& curvature) const;

 private:
  bool holds_criterion(std::size_t condition) const noexcept {
    return condition < form_.held_criteria.size() && form_.held_criteria[condition];
  }
  std::size_t criteria() const noexcept;
  std::size_t spreads() const { return free_spreads(form_, start_.place, unit_).size(); }
  std::size_t numbers() const { return 2 * conditions_ + spreads() + 1 + kSharedParameters.size(); }
  double unit_of(SharedParameter which) const noexcept { return of_criterion(which) ? unit_ : 1; }
  std::vector<double> in_numbers(const SearchedPlace& at) const;
  std::vector<std::vector<std::size_t>> moved_numbers() const;
  std::vector<double> told_together(const HierarchicalLikelihood& likelihood) const;

  const HierarchicalForm& form_;
  SearchedPlace start_;
  double unit_;
  std::size_t conditions_, means_ = 0;
  std::vector<SharedParameter> shared_;
};

}  // namespace jnd
