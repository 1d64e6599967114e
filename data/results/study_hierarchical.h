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
#include "analysis/hierarchical/predictive_check.h"
#include "analysis/numerics/special_values.h"
#include "analysis/numerics/words.h"
#include "data/results/study_analysis.h"
#include "protocols/protocol.h"

namespace jnd {

// Of the model as a whole; where it is not ok nothing else is estimated.
enum class HierarchicalStatus {
  ok,
  no_answers,       // no counted trial with different stimuli
  not_offered,      // of the registered model of d' there is none
  too_many_people,  // above kMostInDetail, where it is not registered
  not_converged     // the search for the largest likelihood did not settle
};
inline constexpr auto kHierarchicalStatusWords =
    words<HierarchicalStatus>({{"ok", HierarchicalStatus::ok},
                               {"no_answers", HierarchicalStatus::no_answers},
                               {"not_offered", HierarchicalStatus::not_offered},
                               {"too_many_people", HierarchicalStatus::too_many_people},
                               {"not_converged", HierarchicalStatus::not_converged}});

// Of everyone, in one condition. JNDs in the study's unit.
struct HierarchicalCondition {
  int condition = 0;     // place in the protocol
  int participants = 0;  // with counted trials there
  SlopeStatus status = SlopeStatus::missing;
  double jnd = kNaN;                     // of the median person, exp(mu); NaN unless ok
  double ci_low = kNaN, ci_high = kNaN;  // 95 % by profile likelihood; 0 or inf where the answers leave it open
  double weber = kNaN;                   // jnd / reference
  double criterion = kNaN;               // NaN where missing
};

// JND of a / JND of b, of all pairs of conditions that have trials.
struct HierarchicalRatio {
  int a = 0, b = 0;                                    // places in the protocol
  int participants = 0;                                // with counted trials in both
  bool defined = false;                                // both have a JND; otherwise ratio and interval are NaN
  double ratio = kNaN, ci_low = kNaN, ci_high = kNaN;  // 95 % by profile likelihood, as above
  double lr = kNaN, p = kNaN;  // likelihood-ratio test of a ratio of 1, chi-square with 1 degree of freedom
};

// Standard deviation between people.
struct HierarchicalSpread {
  SpreadStatus status = SpreadStatus::not_identified;
  double sd = kNaN;  // NaN where it is not identified
};

enum class ShrunkenStatus {
  ok,
  missing,      // no counted trials of the person in the condition
  no_group_jnd  // the group has no JND there to be drawn towards
};
inline constexpr auto kShrunkenStatusWords = words<ShrunkenStatus>(
    {{"ok", ShrunkenStatus::ok}, {"missing", ShrunkenStatus::missing}, {"no_group_jnd", ShrunkenStatus::no_group_jnd}});

// One participant and condition, as in StudyAnalysis::thresholds.
struct HierarchicalPerson {
  std::string participant;
  std::optional<int> group;  // place in Protocol::groups
  int condition = 0;         // place in the protocol
  ShrunkenStatus status = ShrunkenStatus::missing;
  double jnd = kNaN;        // exp of the mean of ln JND given everybody's answers, at the group's estimates
  double ln_sd = kNaN;      // the standard deviation of ln JND, given the same
  double criterion = kNaN;  // mean, given the same; NaN where missing
  // From the answers of this cell alone: by the same model, and the registered estimate.
  SlopeStatus alone_status = SlopeStatus::missing;
  double alone = kNaN;
  JndStatus separate_status = JndStatus::no_information;
  double separate = kNaN;  // NaN unless ok
};

struct StudyHierarchical {
  HierarchicalStatus status = HierarchicalStatus::no_answers;
  std::string reason;                     // in words, where it is not ok
  std::optional<ResponseModel> response;  // none where it is not offered
  int participants = 0;                   // with counted trials
  std::int64_t trials = 0;
  std::vector<HierarchicalCondition> conditions;  // every one of the protocol
  std::vector<HierarchicalRatio> ratios;
  std::vector<HierarchicalPerson> people;    // by participant, condition that they get
  HierarchicalSpread persons, by_condition;  // of ln JND: of persons, of persons by condition
  HierarchicalSpread criteria;               // of the criterion
  // The JNDs of all people in a condition are one: nothing else was found, or could be.
  bool alike() const noexcept { return persons.status != SpreadStatus::ok && by_condition.status != SpreadStatus::ok; }
  // One JND for all conditions, by likelihood ratio; df 0: there is no such test.
  double equal_lr = kNaN, equal_p = kNaN;
  int equal_df = 0;
  // Whether the model draws answers like these; the conditions of its rows are places in the protocol. None over
  // delivered differences, which hardly two people share, nor above kMostInDetail participants.
  std::optional<PredictiveCheck> check;
};

// What a model whose people are alike() says of them.
inline constexpr std::string_view kPeopleAlike =
    "The answers show no difference between people's JNDs: everybody's is the group's.";

// Delivered differences count to so many steps of the largest one.
inline constexpr int kDeliveredSteps = 200;

// The observer of the registered model of d' of same-different; none where there is no hierarchical model of it.
std::optional<ResponseModel> registered_observer(const AnalysisPlan& plan);

// Of the trials that count, by maximum likelihood. A fraction of a second for twenty people, some seconds for the most.
StudyHierarchical study_hierarchical(const StudyAnalysis& analysis, const Protocol& protocol);

// Of a row: why nothing is estimated at all, else what its own JND is.
std::string_view status_word(const StudyHierarchical& model, const HierarchicalCondition& row) noexcept;

}  // namespace jnd
