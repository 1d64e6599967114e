// The conditions of a study against each other, and its groups of participants: slopes or JNDs by the registered plan,
// times and ratings beside them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/group/between_groups.h"
#include "analysis/group/compare.h"
#include "analysis/group/group.h"
#include "analysis/group/repeated_measures.h"
#include "analysis/group/within_table.h"
#include "analysis/numerics/special_values.h"
#include "data/results/rating_answers.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

struct LeftOut {
  std::string participant, reason;
};

// One participant's values of an outcome.
struct ParticipantValues {
  std::string participant;
  std::optional<int> group;    // place in Protocol::groups
  std::vector<double> values;  // by condition; NaN where there is none, or the group does not get the condition
  std::string missing;         // why there is none of a condition that the group gets; empty where all are there
  std::vector<bool> gets{};    // by condition, whether the group gets it; empty: all of them
};

// One quantity compared over the conditions.
struct OutcomeComparison {
  std::string outcome;  // key of the task's outcome, "ln_" before it of logarithms, "trial_time", or a question's id
  std::string title;    // for people: "JND, mean over 3 standards", "time per trial", the question's text
  std::string unit;     // of the values; empty where they have none
  std::string standard = "all";  // at which the values are; all: of all of them together
  bool registered = false;       // the plan's own test; the others stand beside it
  bool may_lack = false;         // TaskOutcome::may_lack
  bool share = false;            // TaskOutcome::share
  bool question = false;         // a rating
  // Every participant gets every condition. Where groups get different ones, table has those who get them all, and what
  // is compared within or between groups is taken from everyone.
  bool crossed = true;
  std::vector<ParticipantValues> everyone;
  std::vector<std::string> participants;  // the rows of table, in order
  std::vector<LeftOut> left_out;          // who gets every condition and is not in it, and why
  WithinTable table;                      // participants x the protocol's conditions
  std::string refused;                    // why there is no test; empty where there is one
  std::vector<ConditionSummary> within;   // by condition, over the rows of table; empty of fewer than 2
  Comparison comparison;                  // empty where refused
};

// d' by condition and series, both within: does what a condition does depend on the series?
struct SeriesComparison {
  int n = 0;                      // participants in it
  std::vector<LeftOut> left_out;  // who is not
  std::string refused;            // why there is no test; empty where there is one
  TwoWayWithin test;              // a: condition, b: series
};

// One group under one of its conditions, or over all of them.
struct GroupMean {
  int group = 0, condition = -1;  // places in the protocol; -1: each participant's mean over the group's conditions
  int participants = 0;           // of the group
  MeanEstimate mean;              // with Student's 95 % interval; of those who have a value
  double median = kNaN;
  ShapiroWilk shapiro{};
};

// The groups against each other, by the registered test.
struct GroupsCompared {
  std::string outcome, title, unit, standard = "all";  // as OutcomeComparison
  BetweenTest test = BetweenTest::none;
  std::vector<GroupMean> means;           // by group, condition; over several conditions last
  std::vector<std::string> participants;  // the rows of table, in order
  std::vector<LeftOut> left_out;          // who has no value under one of their conditions, and why
  // What is tested: of mixed_anova every condition, else one column, each participant's mean over their conditions.
  // Group g is Protocol::groups[g].
  GroupedTable table;
  std::string refused;         // why there is no test; empty where there is one, or none is registered
  GroupComparison comparison;  // empty where there is no test
  bool tested() const noexcept { return test != BetweenTest::none && refused.empty(); }
};

std::string_view to_string(BetweenTest test) noexcept;  // "none", "welch", "mann-whitney", "mixed-anova"
std::string_view to_string(PostHoc test) noexcept;      // "holm-t", "games-howell", "tukey", "wilcoxon"

// How much of a comparison is computed. contrasts: the pairs, each by the registered post-hoc test alone, which is what
// contrast_p() needs; for studies that are simulated by the thousand.
enum class Compared { everything, contrasts };

// An outcome of a task, by participant its mean over the standards; registered: the one that the protocol registers. Tests
// leave out who has none where the outcome may_lack, and are refused otherwise: a mean over the rest would be biased.
OutcomeComparison compare_task(const TaskResults& results, const Protocol& protocol,
                               Compared compared = Compared::everything);
// An outcome's title with the standards that are compared: "JND, mean over 3 standards", "JND at 500".
std::string compared_title(const TaskOutcome& outcome, const Protocol& protocol);
// The name of the standard at which conditions are compared, or "all".
std::string compared_standard(const Protocol& protocol);
// Time per trial, over all standards.
OutcomeComparison compare_times(const TaskResults& results, const Protocol& protocol);
// participants: those that the ratings were read for. groups: theirs; empty where there are none.
OutcomeComparison compare_ratings(const RatedQuestion& ratings, const std::vector<std::string>& participants,
                                  const Protocol& protocol, const std::vector<std::optional<int>>& groups = {});
SeriesComparison compare_series(const std::vector<CellResult>& cells, const Protocol& protocol);

// registered: the comparison of the registered outcome; of a protocol with groups. Who has no value is left out, or the
// test refused, as in compare_task().
GroupsCompared compare_groups(const OutcomeComparison& registered, const Protocol& protocol);

// A registered contrast by itself, over the participants who get both: where groups get different conditions, and where not
// everyone has every value.
struct ContrastWithin {
  int participants = 0;             // who get both
  std::vector<double> differences;  // a - b, of those who have both values
  double p = kNaN;                  // registered, corrected as registered; NaN where there is none
  std::string refused;              // why there is no p; empty where there is one
};
// By contrast. Tukey's test has no error term there, and is refused.
std::vector<ContrastWithin> contrasts_within(const OutcomeComparison& outcome, const Protocol& protocol);

// The registered post-hoc p of a - b within a comparison of all conditions: Holm's over the registered contrasts for
// paired t and Wilcoxon, the test's own for Games-Howell and Tukey. By contrast; NaN where undefined.
std::vector<double> contrast_p(const Comparison& comparison, const AnalysisPlan& plan);
// Of the registered test over all conditions; NaN where none is registered or it is undefined. For the analysis of
// variance with three or more conditions it is the one with the Greenhouse-Geisser correction.
double omnibus_p(const Comparison& comparison, const AnalysisPlan& plan) noexcept;
// a - b of one contrast: a place among Comparison::pairs, and whether its sign turns.
struct PairPlace {
  std::size_t pair = 0;
  bool turned = false;
};
PairPlace pair_of(const Contrast& contrast, std::size_t conditions) noexcept;

}  // namespace jnd
