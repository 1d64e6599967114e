// One model of everybody's answers: the group's JND in each condition, what conditions differ by, how much people
// differ, and each person's own JND, drawn towards the group's as far as their answers are few.
//
// The model and its likelihood: hierarchical_likelihood.h. Everything is a profile over all that is estimated, lapses,
// over-dispersion and drift included. exp(mu_c) is the JND of the median person (the geometric
// mean), not the mean of the JNDs, which is exp(mu_c + (tu^2 + tv^2)/2).
//
// Sources: Pinheiro and Bates 2000, Mixed-Effects Models in S and S-PLUS; Moscatelli, Mezzetti and Lacquaniti 2012, J Vis
// 12(11):26 (the same for yes-no and 2IFC, by glmer); Venzon and Moolgavkar 1988, Appl Statist 37:87 (profile
// intervals); Self and Liang 1987, J Am Stat Assoc 82:605, case 5 (tests of a parameter at the end of its range). Tests: glmer of lme4 with 25 nodes, two independent implementations, analysis/selftest.
#pragma once

#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/hierarchical/hierarchical_search.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

// What everyone who reads a number of the model is told.
inline constexpr std::string_view kHierarchicalAssumptions =
    "Assumed: ln JND differs between people, and their criteria do, as normal distributions do, by the same spreads in "
    "every condition, and nobody's answers change during the study.";

// What is estimated besides the means and criteria of the conditions.
struct HierarchicalModel {
  ResponseModel response = ResponseModel::yes_no;
  SharedParameters shared{};             // those that are held
  SharedForm estimated{};                // the others
  bool tu = true, tv = true, tw = true;  // spreads of persons, of persons by condition, of criteria
  bool rho = false;                      // the correlation of u and w, with tu and tw
  bool one_mean = false;                 // one mu for all conditions
};

enum class SharedStatus {
  ok,
  zero,            // lapses, over-dispersion: the likelihood is largest at 0, the least that they can be
  at_limit,        // as large as is searched (shared_parameters.h): the answers set no bound
  not_identified,  // these answers cannot tell it, whatever they are: 0
  not_converged    // the search with it did not settle
};
inline constexpr auto kSharedStatusWords = words<SharedStatus>({{"ok", SharedStatus::ok},
                                                                {"zero", SharedStatus::zero},
                                                                {"at_limit", SharedStatus::at_limit},
                                                                {"not_identified", SharedStatus::not_identified},
                                                                {"not_converged", SharedStatus::not_converged}});

enum class SpreadStatus {
  ok,
  zero,            // the likelihood is largest at 0: the answers show no such difference between people
  not_identified,  // one participant; or, of persons by condition, nobody in more than one condition: taken as 0
  not_asked        // not in the model: 0
};
inline constexpr auto kSpreadStatusWords = words<SpreadStatus>({{"ok", SpreadStatus::ok},
                                                                {"zero", SpreadStatus::zero},
                                                                {"not_identified", SpreadStatus::not_identified},
                                                                {"not_asked", SpreadStatus::not_asked}});

// Of a JND, of the group's in a condition or a person's alone.
enum class SlopeStatus {
  ok,
  no_sensitivity,  // above 12 times the largest level, or as likely as there: the answers do not change with the level
  ceiling,         // below a twelfth of the smallest, or as likely as there: a step fits
  missing          // no trials
};
inline constexpr auto kSlopeStatusWords = words<SlopeStatus>({{"ok", SlopeStatus::ok},
                                                              {"no_sensitivity", SlopeStatus::no_sensitivity},
                                                              {"ceiling", SlopeStatus::ceiling},
                                                              {"missing", SlopeStatus::missing}});

// 95 % by profile likelihood, the other parameters at their best; an end that the answers leave open is infinite.
struct ProfileEnds {
  double low = kNaN, high = kNaN;
};

struct ConditionMean {
  double mu = 0;  // NaN without a JND; its interval still has one end
  double criterion = 0;
  SlopeStatus status = SlopeStatus::ok;
  ProfileEnds ends;            // of mu; NaN before add_intervals()
  ProfileEnds criterion_ends;  // of choices: of the criterion, likewise; NaN of other models
};

// mu of condition a less that of b: the logarithm of the ratio of the JNDs. NaN, with its ends, where one has no JND;
// the test is there all the same.
struct ConditionDifference {
  std::size_t a = 0, b = 0;
  double difference = 0;
  ProfileEnds ends;
  double lr = kNaN, p = kNaN;  // likelihood-ratio test of no difference, chi-square with 1 degree of freedom
};

struct PersonEstimate {
  double mean = 0, sd = 0;               // of ln s given everybody's answers, at the estimates of the group
  double criterion = 0;                  // mean of k, given the same
  double alone = kNaN;                   // ln s from the answers of this cell only
  SlopeStatus status = SlopeStatus::ok;  // of that one
};

// What is the same for everybody, estimated.
struct SharedEstimate {
  SharedParameter parameter = SharedParameter::lapse;
  SharedStatus status = SharedStatus::ok;
  double value = kNaN;  // NaN where not identified; at a limit that limit
  ProfileEnds ends;     // an end beyond what is searched is infinite; of lapses and over-dispersion no less than 0
  // Likelihood-ratio test of 0, everything else at its best. Of lapses and over-dispersion, which lie at the end of what
  // they can be, p is half of that of chi-square with 1 degree of freedom, and 1 where the estimate is 0.
  double lr = kNaN, p = kNaN;
};

struct HierarchicalFit {
  std::size_t participants = 0;
  double trials = 0;
  HierarchicalMaximum maximum;
  SharedForm shared;  // of those to be estimated the ones that these answers can tell
  SpreadStatus tu = SpreadStatus::ok, tv = SpreadStatus::ok, tw = SpreadStatus::ok;
  std::vector<ConditionMean> conditions;
  // One mu for all conditions, and the likelihood-ratio test of it; empty with one condition or with one_mean.
  HierarchicalMaximum common;
  double lr = kNaN, p = kNaN;
  int df = 0;
};

class HierarchicalAnalysis {
 public:
  // cells: every condition has trials; participants and conditions from 0, without gaps. Throws std::invalid_argument
  // without cells.
  HierarchicalAnalysis(std::vector<HierarchicalCell> cells, const HierarchicalModel& model);

  const HierarchicalFit& fit() const noexcept { return fit_; }

  // What takes longer, and changes nothing of the fit but adds to it: intervals of the means; all pairs.
  const HierarchicalFit& add_intervals();
  ConditionDifference difference(std::size_t a, std::size_t b);  // not of a model with one_mean
  std::vector<ConditionDifference> differences();
  // Of each that is to be estimated.
  std::vector<SharedEstimate> shared_estimates();
  // By participant, then condition.
  std::vector<PersonEstimate> people();

 private:
  void find_spreads();
  HierarchicalMaximum start_of(const HierarchicalForm& form, const HierarchicalMaximum& from) const;
  HierarchicalMaximum from_here(const HierarchicalForm& form, const HierarchicalMaximum& from,
                                double negligible = kNegligible);
  void look_closely();
  std::size_t shared_place(SharedParameter which) const noexcept;
  double error_of(std::initializer_list<std::pair<std::size_t, double>> parameters) const;
  HierarchicalMaximum with_shared(SharedParameter held, double value, const HierarchicalMaximum& from,
                                  double negligible, double wanted = -kInf);
  double shared_end(const SharedEstimate& estimate, double side);
  template <typename Held, typename Slope>
  ProfileEnds ends(double estimate, double error, double furthest, const Held& held, const Slope& slope);
  ProfileEnds mean_ends(std::size_t condition, double error);
  ProfileEnds criterion_ends(std::size_t condition, double error);
  template <typename AtEnd>
  SlopeStatus status_of(double ln_s, double log_likelihood, const AtEnd& at_end) const;

  std::vector<HierarchicalCell> cells_;
  HierarchicalModel model_;
  HierarchicalForm form_;
  SearchRange range_;
  HierarchicalLikelihood likelihood_;
  HierarchicalFit fit_;
  bool looked_closely_ = false;
};

}  // namespace jnd
