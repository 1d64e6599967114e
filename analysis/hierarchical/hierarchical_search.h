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
  double lowest = -kInf, highest = kInf;  // where the free numbers are searched
  int held_criterion = -1;                // the condition whose criterion keeps the value of the start; none: -1
  SharedForm shared;

  // Every condition its own mean; one mean for all; one mean held; the difference of two held (of a, less b).
  static HierarchicalForm separate(std::size_t conditions);
  static HierarchicalForm common(std::size_t conditions);
  HierarchicalForm with_mean(std::size_t condition, double mean) const;
  HierarchicalForm with_difference(std::size_t a, std::size_t b, double difference) const;
};

struct HierarchicalMaximum {
  HierarchicalPlace place;
  SharedParameters shared;
  HierarchicalPlace slope;  // of ln L, by every parameter, those held included; by tu, tv, tw: 0 where they are 0
  OfSharedParameters slope_by_shared{};  // by those that were free
  double log_likelihood = 0;
  bool converged = false;
  // About minus the second derivatives of ln L, as the search came to know them, in the order of marginal_information
  // (hierarchical_information.h), then of kSharedParameters, 0 of those that were held: what another search from here
  // may begin with.
  std::vector<double> information;
};

// The place with the means that the form makes of its own.
HierarchicalPlace moved(const HierarchicalForm& form, const HierarchicalPlace& place);
// The place with those means and these values of the shared parameters that are held, everything else of the form moved
// to where ln L would be largest then, were it a parabola with the slope and information of the maximum.
HierarchicalMaximum moved(const HierarchicalForm& form, const HierarchicalMaximum& from, const SharedParameters& held,
                          double criterion_unit = 1);

inline constexpr double kNegligible = 1e-8;  // of ln L: differences below it are not told apart

// From a place, moved, with its shared parameters, and its information where it has one: else with that of a linear
// mixed model. Spreads that are estimated begin at no less than a small one, and
// end at 0 where ln L rises towards 0. criterion_unit: that of kappa and tw, 1 or a spread. negligible: differences of
// ln L below this are not told apart. A search that promises no ln L as large as wanted is given up. Leaves the likelihood
// with the shared parameters of the maximum.
HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalMaximum& from, double criterion_unit = 1,
                             double negligible = kNegligible, double wanted = -kInf);
// With the likelihood's own shared parameters.
HierarchicalMaximum maximise(HierarchicalLikelihood& likelihood, const HierarchicalForm& form,
                             const HierarchicalPlace& start, double criterion_unit = 1, double negligible = kNegligible,
                             const std::vector<double>& information = {});

// Minus the second derivatives of ln L at a maximum, as differences of its slopes, in the place of its information. It
// takes an evaluation per free parameter, and makes searches near by about twice as short.
void observe_information(HierarchicalLikelihood& likelihood, const HierarchicalForm& form, HierarchicalMaximum& maximum,
                         double criterion_unit = 1);

// The standard error by the information of a maximum, everything else of the form unknown, of the sum of the parameters
// times these numbers, in the order of that information. Infinite where it has no inverse.
double standard_error(const HierarchicalForm& form, const HierarchicalMaximum& maximum,
                      const std::vector<double>& times, double criterion_unit = 1);

// The ln s and criterion that fit answers best as if they were one person's in one condition (participant and condition
// of the cells do not count). Within a factor of 50 of the start; where the answers tell no slope, or a step, at its end.
// hold_ln_s: only the criterion, at the start's ln s.
struct PooledMaximum {
  double ln_s = 0, criterion = 0;
  double log_likelihood = 0;
};
PooledMaximum pooled_maximum(std::span<const HierarchicalCell> cells, ResponseModel model,
                             const SharedParameters& shared, const PooledMaximum& start, bool hold_ln_s = false);

// What the levels of a study can tell, and where a search of it begins.
struct SearchRange {
  PooledMaximum start;             // of anybody's answers in one condition
  double criterion_unit = 1;       // 1, or of choices a spread
  double least = 0, greatest = 0;  // ln s beyond which there is no slope to tell: 12 times beyond the levels
  double lowest() const noexcept;  // of a search, which goes a little further
  double highest() const noexcept;
};
// Throws std::invalid_argument without cells, and where all have one level.
SearchRange search_range(std::span<const HierarchicalCell> cells, ResponseModel model);

// A likelihood of that fineness errs by a few 1e-4 of ln L, and by much less in its slopes: enough for drawn studies.
inline constexpr double kRoughFineness = 0.75, kRoughlyNegligible = 1e-3;

// As maximise(), most of the way with a rougher likelihood of the same cells, which costs half.
HierarchicalMaximum maximise_by_way_of(HierarchicalLikelihood& rough, HierarchicalLikelihood& likelihood,
                                       const HierarchicalForm& form, const HierarchicalMaximum& from,
                                       double criterion_unit = 1, double negligible = kNegligible);

}  // namespace jnd
