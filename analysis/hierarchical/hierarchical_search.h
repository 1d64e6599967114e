// The largest marginal likelihood, where some parameters are held or bound together; what is the same for everybody
// (shared_parameters.h) is searched with the others.
#pragma once

#include <vector>

#include "analysis/hierarchical/hierarchical_likelihood.h"
#include "analysis/numerics/special_values.h"

namespace jnd {

// Which parameters are estimated; the others keep the value of the start. The mean of condition c is the free number
// of[c] plus offset[c]; with of[c] < 0 it is offset[c].
struct HierarchicalForm {
  bool tu = true, tv = true, tw = true, rho = false;
  std::vector<int> of;
  std::vector<double> offset;
  double lowest = -kInf, highest = kInf;  // where the free numbers are searched, and criteria
  double lowest_criterion = -kInf, highest_criterion = kInf;
  std::vector<bool> held_criteria;  // by condition: whether its criterion keeps the value of the start
  SharedForm shared;

  // Every condition its own mean; one mean for all; one mean held; the difference of two held (of a, less b).
  static HierarchicalForm separate(std::size_t conditions);
  static HierarchicalForm common(std::size_t conditions);
  HierarchicalForm with_mean(std::size_t condition, double mean) const;
  HierarchicalForm with_difference(std::size_t a, std::size_t b, double difference) const;
};

// Those of a place that the form searches, and what each is measured in: tu, tv or one of each condition, tw the last.
template <typename Place>
auto free_spreads(const HierarchicalForm& form, Place& place, double criterion_unit = 1) {
  struct Spread {
    decltype(&place.tu) value;
    double unit;
  };
  std::vector<Spread> spreads;
  if (form.tu) spreads.push_back({&place.tu, 1});
  if (form.tv && place.own_tv.empty()) spreads.push_back({&place.tv, 1});
  if (form.tv)
    for (auto& one : place.own_tv) spreads.push_back({&one, 1});
  if (form.tw) spreads.push_back({&place.tw, criterion_unit});
  return spreads;
}

struct HierarchicalMaximum {
  HierarchicalPlace place;
  SharedParameters shared;
  HierarchicalPlace slope;  // of ln L, by every parameter, those held included; by tu, tv, tw: 0 where they are 0
  OfSharedParameters slope_by_shared{};  // by those that were free
  double log_likelihood = 0;
  bool converged = false;
  // About minus the second derivatives of ln L, as the search came to know them: another search of the same form, or of one
  // that holds or binds more, may begin with it.
  std::vector<double> curvature;
};

// The place with the means that the form makes of its own.
HierarchicalPlace moved(const HierarchicalForm& form, const HierarchicalPlace& place);

inline constexpr double kNegligible = 1e-8;  // of ln L: differences below it are not told apart

// What is searched: spreads of ln s of up to a factor of e^2 between people a standard deviation apart, of criteria up to 2 of
// their unit, and correlations for which nodes can lie close enough. The smallest: ln L is smooth in the square of a
// spread, which is what is searched, and differs between 0 and here by next to nothing, but only beyond 0 does it have a
// slope in that square.
inline constexpr double kLargestSpread = 2, kLargestSpreadOfCriteria = 2, kLargestCorrelation = 0.95;
inline constexpr double kSmallestSpread = 1e-3;

// A maximum that a search need not find again, in what it searches: the place, ln L, its slope and about minus its second
// derivatives, or none.
struct KnownMaximum {
  std::vector<double> place;
  double log_likelihood = 0;
  std::vector<double> slope{}, curvature{};
};

// From one place, uphill. Spreads that are estimated begin at no less than a small one, and end at 0 where ln L rises
// towards 0. criterion_unit: that of kappa and tw, 1 or a spread. negligible: differences of ln L below this are not told
// apart. A search is given up where it promises no more than what is known, or comes to where ln L is the parabola about
// that; one ends, unconverged, where the likelihood's work() is above most_work. Leaves the likelihood with the shared
// parameters of the maximum. Throws Stopped (numerics/stop_request.h).
HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalMaximum& from, double criterion_unit = 1,
                             double negligible = kNegligible, double most_work = kInf,
                             const KnownMaximum* known = nullptr);

// A likelihood, and one of rougher nodes, which ranks starts: it errs by about 1e-4, and costs half.
class HierarchicalSearch {
 public:
  HierarchicalSearch(std::span<const HierarchicalCell> cells, ResponseModel model, const SharedParameters& shared,
                     double fineness, double criterion_unit);

  HierarchicalLikelihood& likelihood() noexcept { return likelihood_; }
  double unit() const noexcept { return unit_; }
  double work() const noexcept { return likelihood_.work() + rough_.work(); }
  // As maximise(), as far as work() goes.
  HierarchicalMaximum climbed(const HierarchicalForm& form, const HierarchicalMaximum& from, double most_work = kInf,
                              double negligible = kNegligible);
  // Whether other starts lead higher than the best that is known of this form, which it is then.
  bool improve(const HierarchicalForm& form, const std::vector<HierarchicalMaximum>& starts, HierarchicalMaximum& best,
               double most_work = kInf);

 private:
  KnownMaximum on_rough_nodes(const HierarchicalForm& form, const HierarchicalMaximum& best);

  HierarchicalLikelihood likelihood_, rough_;
  double unit_;
};

// About the standard error of a number at a maximum: of which the form holds it, and `beside` has it that much larger. Not a
// number where the curvature there is not known.
double standard_error(const HierarchicalForm& form, const HierarchicalMaximum& maximum,
                      const HierarchicalMaximum& beside, double larger, double criterion_unit);

// The observed information at a maximum, of what the form leaves free: differences of the slopes of ln L, and huge where a
// number lies at the end of what it can be. As the maximum's curvature.
std::vector<double> observed_information(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                         const HierarchicalMaximum& maximum, double criterion_unit = 1);

// Of the free means of the form at a maximum, everything else unknown: by the observed information. Rows by free mean;
// empty where it has no inverse.
std::vector<double> covariance_of_means(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                                        const HierarchicalMaximum& maximum, double criterion_unit = 1);

// What the levels of a study can tell, and where a search of it begins.
struct SearchRange {
  double ln_s = 0, criterion = 0;  // of anybody's answers in one condition, before they are looked at
  double criterion_unit = 1;       // 1, or of choices a spread
  double least = 0, greatest = 0;  // ln s beyond which there is no slope to tell: 12 times beyond the levels
  double lowest_criterion = 0, highest_criterion = 0;
  double lowest() const noexcept;  // of a search, which goes a little further
  double highest() const noexcept;
};
// Throws std::invalid_argument without cells, and where all have one level.
SearchRange search_range(std::span<const HierarchicalCell> cells, ResponseModel model);

// The ln s and criterion that fit answers best as if they were one person's in one condition (participant and condition
// of the cells do not count), within the range; where the answers tell no slope, or a step, at its end. held_ln_s: only
// the criterion, at that ln s.
struct PooledMaximum {
  double ln_s = 0, criterion = 0;
  double log_likelihood = 0;
};
PooledMaximum pooled_maximum(std::span<const HierarchicalCell> cells, ResponseModel model,
                             const SharedParameters& shared, const SearchRange& range, double held_ln_s = kNaN);

}  // namespace jnd
