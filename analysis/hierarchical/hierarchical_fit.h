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

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/hierarchical/hierarchical_profile.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"

namespace jnd {

// What everyone who reads a number of the model is told.
constexpr std::string_view spreads_assumed(bool own_tv) noexcept {
  return own_tv ? "spreads of each condition's own" : "the same spreads in every condition";
}
std::string hierarchical_assumptions(bool own_tv);

// What is estimated besides the means and criteria of the conditions.
struct HierarchicalModel {
  ResponseModel response = ResponseModel::yes_no;
  SharedParameters shared{};             // those that are held
  SharedForm estimated{};                // the others
  bool tu = true, tv = true, tw = true;  // spreads of persons, of persons by condition, of criteria
  bool rho = false;                      // the correlation of u and w, with tu and tw
  bool own_tv = false;                   // with tv: one of each condition
  bool one_mean = false;                 // one mu for all conditions
};

enum class SharedStatus {
  ok,
  zero,            // lapses, over-dispersion: the likelihood is largest at 0, the least that they can be
  at_limit,        // as large as is searched (shared_parameters.h): the answers set no bound
  not_identified,  // these answers cannot tell it, whatever they are: 0
  not_converged,   // the search with it did not settle
  out_of_work      // it would have taken too long
};
inline constexpr auto kSharedStatusWords = words<SharedStatus>({{"ok", SharedStatus::ok},
                                                                {"zero", SharedStatus::zero},
                                                                {"at_limit", SharedStatus::at_limit},
                                                                {"not_identified", SharedStatus::not_identified},
                                                                {"not_converged", SharedStatus::not_converged},
                                                                {"out_of_work", SharedStatus::out_of_work}});

enum class SpreadStatus {
  ok,
  zero,            // the likelihood is largest at 0: the answers show no such difference between people
  at_limit,        // as large as is searched (hierarchical_search.h): the answers set no bound
  not_identified,  // one participant; or, of persons by condition, nobody in more than one condition: taken as 0
  not_asked,       // not in the model: 0
  by_condition     // each condition has its own
};
inline constexpr auto kSpreadStatusWords = words<SpreadStatus>({{"ok", SpreadStatus::ok},
                                                                {"zero", SpreadStatus::zero},
                                                                {"at_limit", SpreadStatus::at_limit},
                                                                {"not_identified", SpreadStatus::not_identified},
                                                                {"not_asked", SpreadStatus::not_asked},
                                                                {"by_condition", SpreadStatus::by_condition}});

// Of a JND, of the group's in a condition or a person's alone. Without trials, and where the counts alone tell that there
// is none, nothing is searched: a condition is left out of the model.
enum class SlopeStatus {
  ok,
  no_sensitivity,  // above 12 times the largest level, or as likely as there: the answers do not change with the level
  ceiling,         // below a twelfth of the smallest, or as likely as there: a step fits
  missing,         // no trials
  one_answer,      // every answer is the same one
  one_level,       // every trial has the same level
  perfect          // up to some level every answer is negative, above it positive: the JND is 0 or near it
};
inline constexpr auto kSlopeStatusWords = words<SlopeStatus>({{"ok", SlopeStatus::ok},
                                                              {"no_sensitivity", SlopeStatus::no_sensitivity},
                                                              {"ceiling", SlopeStatus::ceiling},
                                                              {"missing", SlopeStatus::missing},
                                                              {"one_answer", SlopeStatus::one_answer},
                                                              {"one_level", SlopeStatus::one_level},
                                                              {"perfect", SlopeStatus::perfect}});
// By the counts alone: ok, missing, one_answer, one_level or perfect.
SlopeStatus counted_status(std::span<const HierarchicalCell> cells);

struct ConditionMean {
  double mu = kNaN;  // NaN without a JND; its interval still has one end, but where the counts tell that there is none
  double criterion = kNaN;  // NaN of a condition that is left out
  SlopeStatus status = SlopeStatus::ok;
  ProfileEnds ends;            // of mu
  ProfileEnds criterion_ends;  // of choices: of the criterion; of other models not computed
  double tv = kNaN;            // where each condition has its own
  SpreadStatus tv_status = SpreadStatus::not_asked;
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
  // Of ln s given everybody's answers, at the estimates of the group; NaN in a condition that is left out.
  double mean = kNaN, sd = kNaN;
  double criterion = kNaN;               // mean of k, given the same
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
  // Of conditions that are left out ln s and criterion are 0, and mean nothing. converged: also where all are left out.
  HierarchicalMaximum maximum;
  bool exact = true;  // denser nodes change ln L by less than 1e-6
  SharedForm shared;  // of those to be estimated the ones that these answers can tell
  SpreadStatus tu = SpreadStatus::ok, tv = SpreadStatus::ok, tw = SpreadStatus::ok, rho = SpreadStatus::not_asked;
  std::vector<ConditionMean> conditions;
  // One mu for all conditions that are not left out, and the likelihood-ratio test of it; df 0 with one of them or with
  // one_mean.
  HierarchicalMaximum common;
  double lr = kNaN, p = kNaN;
  int df = 0;
  // What complete() was asked for.
  std::vector<ConditionDifference> differences;
  std::vector<SharedEstimate> shared_estimates;
};

// How much is searched: of one study all that is worth it; of the thousands that are drawn from a known truth one start,
// with rougher nodes, whose ln L errs by about 1e-4.
enum class SearchEffort { thorough, drawn };

// Of one command's model: about 2 s of processor time. Intervals beyond it are by_curvature; variants may take as much.
inline constexpr double kCommandWork = 1.3e9;

// What complete() adds to a fit.
struct HierarchicalWish {
  bool intervals = false;                                    // of the means, and of choices of the criteria
  bool shared = false;                                       // of each that is to be estimated: interval and test
  std::vector<std::pair<std::size_t, std::size_t>> pairs{};  // of conditions: the difference, its interval and test
  double most_work = 13e9;  // of everything (HierarchicalLikelihood::work), the search for the maximum too
};

class HierarchicalAnalysis {
 public:
  // cells: participants and conditions from 0, without gaps. near: where to begin, such as the truth of a drawn study.
  // Throws std::invalid_argument without cells, Stopped (numerics/stop_request.h).
  HierarchicalAnalysis(std::vector<HierarchicalCell> cells, const HierarchicalModel& model,
                       SearchEffort effort = SearchEffort::thorough, const HierarchicalPlace* near = nullptr);

  const HierarchicalFit& fit() const noexcept { return fit_; }
  double work() const noexcept { return spent_ + search_->work() + completed_; }  // so far, of everything
  // Those of the conditions that are not left out; the others have no trials.
  const std::vector<HierarchicalCell>& cells() const noexcept { return cells_; }

  // What takes longer. Where it comes upon a larger likelihood than the fit's, that is the fit from there on, and all that
  // was asked for, now or before, is computed again. The result does not depend on the number of threads. Tells
  // work_progress() (numerics/stop_request.h). Throws Stopped.
  const HierarchicalFit& complete(const HierarchicalWish& wish, int threads = 1);
  const HierarchicalFit& add_intervals() { return complete({.intervals = true}); }
  const std::vector<ConditionDifference>& differences() { return complete({.pairs = pairs()}).differences; }
  const std::vector<SharedEstimate>& shared_estimates() { return complete({.shared = true}).shared_estimates; }
  // Of all pairs of conditions; none of a model with one_mean.
  std::vector<std::pair<std::size_t, std::size_t>> pairs() const;

  // How far ln L falls where the mean of a condition, or a difference of two, is held at a value: twice that is the
  // likelihood-ratio statistic. NaN of a condition that is left out. A larger likelihood that this comes upon is the fit's
  // from there on.
  double drop_of_mean(std::size_t condition, double mu);
  double drop_of_difference(std::size_t a, std::size_t b, double difference);

  // The likelihood-ratio statistic of one mean for all conditions that are not left out; NaN where there is no such test.
  double equal_lr();
  // Of the means, conditions x conditions, by the observed information; empty where it has no inverse.
  std::vector<double> covariance();
  // By participant, then condition.
  std::vector<PersonEstimate> people();

 private:
  static constexpr int kMostRestarts = 6;  // because a larger likelihood was come upon
  struct Task;

  bool kept(std::size_t condition) const noexcept { return kept_[condition]; }
  void leave_out();
  void find_spreads();
  void search(const HierarchicalPlace* near);
  HierarchicalMaximum climbed(const HierarchicalForm& form, const HierarchicalMaximum& from);
  HierarchicalMaximum first_place(const HierarchicalPlace* near) const;
  HierarchicalMaximum largest(const HierarchicalForm& form, const HierarchicalMaximum& first, bool many);
  void ask_spreads(const HierarchicalForm& form, HierarchicalMaximum& best);
  void search_from(HierarchicalMaximum best);
  void settle();
  HierarchicalForm equal_means() const;
  HierarchicalMaximum start_of(const HierarchicalForm& form, const HierarchicalMaximum& from) const;
  HeldNumber mean_number(std::size_t condition) const;
  HeldNumber criterion_number(std::size_t condition) const;
  HeldNumber difference_number(std::size_t a, std::size_t b) const;
  HeldNumber shared_number(SharedParameter which) const;
  template <typename Number>
  double drop_of(const Number& number, double value);
  std::vector<Task> tasks_of(const HierarchicalWish& wish);
  double complete_one(Task& task, double share) const;
  double complete_all(std::vector<Task>& tasks, double left, int threads);
  void complete_by_curvature(std::vector<Task>& tasks);
  template <typename AtEnd>
  SlopeStatus status_of(double ln_s, double log_likelihood, const AtEnd& at_end) const;

  std::vector<HierarchicalCell> cells_, answered_;  // those kept; all
  HierarchicalModel model_;
  SearchEffort effort_;
  std::vector<bool> kept_;
  HierarchicalForm form_;
  SearchRange range_;
  double fineness_ = 1, spent_ = 0, completed_ = 0;  // the others: work of searches before search_, and of complete()
  std::optional<HierarchicalSearch> search_;
  HierarchicalFit fit_;
  HierarchicalWish wished_;  // all that complete() was asked for
};

}  // namespace jnd
