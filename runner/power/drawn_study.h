// What an analysis makes of one simulated study.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/special_values.h"
#include "data/results/study_comparisons.h"
#include "runner/power/drawn_people.h"
#include "runner/power/power_question.h"

namespace jnd {

// NaN where the study has none.
struct GroupJnd {
  double jnd = kNaN, low = kNaN, high = kNaN;  // with its 95 % interval
};
struct GroupContrast {
  double difference = kNaN, low = kNaN, high = kNaN;  // on the scale of the analysis, with its 95 % interval
  double p = kNaN;                                    // with the correction for several contrasts
};
struct StudyOutcome {
  std::vector<GroupJnd> group;           // by condition
  std::vector<GroupContrast> contrasts;  // as PowerQuestion::tests() has them: of conditions, then of groups
  bool undefined = false;                // somebody, or of the hierarchical model a condition, has no JND
};

// Immutable: any thread.
class StudyAnalyst {
 public:
  StudyAnalyst(const Protocol& protocol, const PowerQuestion& question, double effect);  // which must outlive it

  // people: of one study, those who dropped out among them.
  StudyOutcome analyse(PowerAnalysis analysis, std::span<const DrawnPerson> people) const;

  // What the estimates of an analysis are of; NaN where the population does not say it. test: place in
  // PowerQuestion::tests().
  double true_jnd(PowerAnalysis analysis, std::size_t condition) const;
  double true_difference(PowerAnalysis analysis, std::size_t test) const;
  // Whether the analysis has such a test; and an estimate beside its p.
  bool has_test(PowerAnalysis analysis, std::size_t test) const;
  bool has_estimate(PowerAnalysis analysis, std::size_t test) const;

 private:
  StudyOutcome registered(std::span<const DrawnPerson> people) const;
  StudyOutcome median(std::span<const DrawnPerson> people) const;
  StudyOutcome log_ml(std::span<const DrawnPerson> people) const;
  StudyOutcome hierarchical(std::span<const DrawnPerson> people) const;
  void add_cell(std::vector<HierarchicalCell>& cells, const HierarchicalCell& cell) const;
  void add_registered_group(StudyOutcome& outcome, std::span<const DrawnPerson> people) const;
  OutcomeComparison compared(std::span<const DrawnPerson> people) const;
  void add_group_tests(StudyOutcome& outcome, const GroupComparison& comparison, BetweenTest test) const;
  void add_median_groups(StudyOutcome& outcome, std::span<const DrawnPerson> people) const;
  bool is_level(PowerAnalysis analysis) const;
  template <typename Of>
  double mean_over_groups(const Of& of) const;
  GroupTest::Kind group_kind(std::size_t test) const;
  double truth(PowerAnalysis analysis, std::size_t condition, std::optional<int> group, bool of_groups) const;

  const Protocol& protocol_;
  const PowerQuestion& question_;
  double effect_;
  HierarchicalPlace truth_;
  HierarchicalModel model_;
  double of_noise_ = 1;        // JND, as the protocol means it, of a noise s of 1
  bool known_ = true;          // the truth is: of participants simulated through the rig it is not
  Evidence evidence_;          // of an estimate
  TaskResults measured_;       // outcomes, and which of them is registered
  std::size_t jnd_ = 0;        // place of the JND, or of what stands for it
  bool compares_jnds_ = true;  // the registered outcome moves with the JND
};

// The scale of an analysis's contrasts, or tests of groups: "d' per N/m" is the registered slope, "ln JND" that of log-ml
// and hierarchical.
std::string contrast_scale(PowerAnalysis analysis, const Protocol& protocol, bool of_groups);
// Why this analysis is not offered for this protocol; empty where it is.
std::string power_refusal(PowerAnalysis analysis, const Protocol& protocol);

}  // namespace jnd
