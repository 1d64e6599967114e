// What an analysis makes of one simulated study.
#pragma once

#include <span>
#include <vector>

#include "analysis/hierarchical/hierarchical_fit.h"
#include "analysis/numerics/special_values.h"
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
  std::vector<GroupContrast> contrasts;  // as asked
  bool undefined = false;                // somebody, or of the hierarchical model a condition, has no JND
};

// Immutable: any thread.
class StudyAnalyst {
 public:
  StudyAnalyst(const Protocol& protocol, const PowerQuestion& question, double effect);  // which must outlive it

  // people: of one study, those who dropped out among them.
  StudyOutcome analyse(PowerAnalysis analysis, std::span<const DrawnPerson> people) const;

  // What the estimates of an analysis are of; NaN where the population does not say it.
  double true_jnd(PowerAnalysis analysis, std::size_t condition) const;
  double true_difference(PowerAnalysis analysis, std::size_t contrast) const;

 private:
  StudyOutcome registered(std::span<const DrawnPerson> people) const;
  StudyOutcome median(std::span<const DrawnPerson> people) const;
  StudyOutcome log_ml(std::span<const DrawnPerson> people) const;
  StudyOutcome hierarchical(std::span<const DrawnPerson> people) const;
  void add_cell(std::vector<HierarchicalCell>& cells, const HierarchicalCell& cell) const;
  void add_registered_group(StudyOutcome& outcome, std::span<const DrawnPerson> people) const;

  const Protocol& protocol_;
  const PowerQuestion& question_;
  HierarchicalPlace truth_;
  HierarchicalModel model_;
  double of_noise_ = 1;           // JND, as the protocol means it, of a noise s of 1
  bool known_ = true;             // the truth is: of participants simulated through the rig it is not
  bool task_ = false;             // the protocol's task has estimates of its own; then
  bool compares_jnds_ = true;     // the registered outcome is the JND, or the Weber fraction
  std::size_t task_outcome_ = 0;  // its place
};

// The scale of an analysis's contrasts: "d' per 100 N/m" is the registered slope, "ln JND" that of log-ml and hierarchical.
std::string contrast_scale(PowerAnalysis analysis, const Protocol& protocol);
// Why this analysis is not offered for this protocol; empty where it is.
std::string power_refusal(PowerAnalysis analysis, const Protocol& protocol);

}  // namespace jnd
