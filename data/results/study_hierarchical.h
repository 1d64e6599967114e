// One model of everybody's answers beside the registered analysis: the group's JND in each condition, ratios of
// conditions, how much people differ, and each person's JND, drawn towards the group's as far as their answers are few.
// The model and its sources: analysis/hierarchical/hierarchical_fit.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/hierarchical/model_variants.h"
#include "analysis/hierarchical/predictive_check.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "data/results/hierarchical_words.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

// Of the model as a whole; nothing else is estimated unless it is fitted().
enum class HierarchicalStatus {
  ok,
  no_answers,       // no counted trial with different stimuli; of choices, none with another level
  not_offered,      // of the registered model of d', there is none
  too_many_people,  // above kMostInDetail, where it is not registered
  not_converged     // the search for the largest likelihood did not settle
};
inline constexpr auto kHierarchicalStatusWords =
    words<HierarchicalStatus>({{"ok", HierarchicalStatus::ok},
                               {"no_answers", HierarchicalStatus::no_answers},
                               {"not_offered", HierarchicalStatus::not_offered},
                               {"too_many_people", HierarchicalStatus::too_many_people},
                               {"not_converged", HierarchicalStatus::not_converged}});

// Standard deviation between people.
struct HierarchicalSpread {
  SpreadStatus status = SpreadStatus::not_identified;
  double sd = kNaN;  // NaN where it is not identified
};

// Of everyone, in one condition and at one standard. JNDs in the study's unit, as the study means them.
struct HierarchicalCondition {
  int condition = 0, standard = 0;  // places in Protocol::conditions and judged_standards()
  int participants = 0;             // with counted trials there
  SlopeStatus status = SlopeStatus::missing;
  HierarchicalSpread spread{};           // of ln JND over persons, where each condition has its own
  double jnd = kNaN;                     // of the median person, exp(mu) times what makes a JND of s; NaN unless ok
  double ci_low = kNaN, ci_high = kNaN;  // 95 % by profile likelihood; 0 or inf where the answers leave it open
  EndsStatus ci_status = EndsStatus::not_computed;
  double weber = kNaN;  // jnd / standard; NaN of a standard of 0
  // NaN where missing. Of choices it is the bias, PSE less the standard, in the study's unit; NaN unless the JND is ok, and
  // where it is taken as 0.
  double criterion = kNaN;
  double pse = kNaN, pse_low = kNaN, pse_high = kNaN;  // of choices, with its 95 % profile interval, which may be open
  EndsStatus pse_status = EndsStatus::not_computed;
};

// JND of a / JND of b, of all pairs of conditions that have trials, at one standard.
struct HierarchicalRatio {
  int a = 0, b = 0;                                    // places in the protocol
  int standard = 0;                                    // place in judged_standards()
  int participants = 0;                                // with counted trials in both
  bool defined = false;                                // both have a JND; otherwise ratio and interval are NaN
  double ratio = kNaN, ci_low = kNaN, ci_high = kNaN;  // 95 % by profile likelihood, as above
  EndsStatus ci_status = EndsStatus::not_computed;
  // Likelihood-ratio test of a ratio of 1, chi-square with 1 degree of freedom; NaN if a condition is left out, or the
  // search took too long.
  double lr = kNaN, p = kNaN;
};

enum class ShrunkenStatus {
  ok,
  missing,      // no counted trials of the person in the condition
  no_group_jnd  // the group has no JND there to be drawn towards
};
inline constexpr auto kShrunkenStatusWords = words<ShrunkenStatus>(
    {{"ok", ShrunkenStatus::ok}, {"missing", ShrunkenStatus::missing}, {"no_group_jnd", ShrunkenStatus::no_group_jnd}});

// One participant, condition and standard.
struct HierarchicalPerson {
  std::string participant;
  std::optional<int> group;         // place in Protocol::groups
  int condition = 0, standard = 0;  // as in HierarchicalCondition
  ShrunkenStatus status = ShrunkenStatus::missing;
  double jnd = kNaN;    // exp of the mean of ln JND given everybody's answers, at the group's estimates
  double ln_sd = kNaN;  // the standard deviation of ln JND, given the same (kPersonRange); NaN if people are alike()
  double criterion = kNaN;  // mean, given the same; NaN where that of the group is
  // From the answers of this cell alone: by the same model, and the registered estimate, or the former where what is
  // registered is no JND.
  SlopeStatus alone_status = SlopeStatus::missing;
  double alone = kNaN;
  JndStatus separate_status = JndStatus::no_information;
  double separate = kNaN;  // NaN unless ok
};

// The model with one thing more estimated, the same for everybody.
struct HierarchicalVariant {
  VariantKind kind = VariantKind::overdispersion;
  // Drift of the criterion is of choices that of the PSE, in the study's unit, or of several standards a share of them.
  std::vector<SharedEstimate> shared;
  std::vector<HierarchicalCondition> conditions;  // as of StudyHierarchical; without a JND where nothing can be told
};

// Fewer people tell next to nothing of what may be the same for everybody, and the search for it is long.
inline constexpr std::size_t kLeastInVariants = 5;

struct StudyHierarchical {
  HierarchicalStatus status = HierarchicalStatus::no_answers;
  std::string reason;  // in words, where it is not ok
  bool fitted() const noexcept {
    return status == HierarchicalStatus::ok || status == HierarchicalStatus::not_converged;
  }
  std::vector<std::string> cautions;      // hierarchical_cautions(), and of lapses
  bool exact = true;                      // HierarchicalFit::exact
  double log_likelihood = kNaN;           // at the estimates; NaN unless fitted()
  std::optional<ResponseModel> response;  // none where it is not offered
  double lapse = 0;                       // AnswerModel::lapse
  double jnd_of_s = 1;                    // AnswerModel::jnd_of_s
  bool pse_at_standard = false;           // of choices: taken as the standard (AnswerModel::pse_at_standard)
  bool several_standards = false;         // levels, and criteria of choices, count as shares of the standard
  PooledLevels gathered;
  std::string separate;  // how separate JNDs come about, for notes
  int participants = 0;  // with counted trials
  std::int64_t trials = 0;
  std::vector<HierarchicalCondition> conditions;  // every one of the protocol, and standard of it
  std::vector<HierarchicalRatio> ratios;
  std::vector<HierarchicalPerson> people;    // by participant, condition that they get, standard
  HierarchicalSpread persons, by_condition;  // of ln JND: of persons, of persons by condition
  HierarchicalSpread criteria;               // of the criterion; of the PSE in the study's unit, or as shares
  bool alike() const noexcept { return are_alike(persons.status, by_condition.status); }
  // One JND for all conditions, by likelihood ratio; df 0: there is no such test, nor of several standards.
  double equal_lr = kNaN, equal_p = kNaN;
  int equal_df = 0;
  // By kind, what is offered of them; none where the slope of a condition has no end, nor of fewer than kLeastInVariants
  // participants or more than kMostInDetail.
  std::vector<HierarchicalVariant> variants;
  // Whether the model draws answers like these; the conditions of its rows are places in the protocol. None over
  // delivered differences, which hardly two people share, nor above kMostInDetail participants.
  std::optional<PredictiveCheck> check;
};

// What everyone who reads a number of it is told.
std::string hierarchical_assumptions(const StudyHierarchical& model);

// Of the trials that count, by maximum likelihood, of a task with an answer_model(), whatever chose their levels (likelihood
// principle). A fraction of a second for twenty people, some seconds for the most.
StudyHierarchical study_hierarchical(const TaskResults& results, const Protocol& protocol);

// A cell of choices for a model whose PSE is the standard: half of every trial as it was, half mirrored, as what was lost
// at -x was won at x. The likelihood is largest at a bias of 0 then, and there that of the trials themselves. Such a model
// has no spread of criteria.
void add_without_bias(std::vector<HierarchicalCell>& cells, HierarchicalCell cell);

// Of a row: why nothing is estimated at all, else why it has no JND, else whether the search settled.
std::string_view status_word(const StudyHierarchical& model, const HierarchicalCondition& row) noexcept;

// The row of a condition and standard, its place in StudyHierarchical::conditions.
std::size_t row_of(const StudyHierarchical& model, const Protocol& protocol, int condition, int standard) noexcept;

// What tables call the JND: "JND", "JND (75 %)", "threshold".
std::string jnd_title(const Protocol& protocol);

}  // namespace jnd
