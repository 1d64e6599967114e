// The conditions of a study against each other, and its groups of participants: slopes or JNDs by the registered plan,
// times and ratings beside them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/group/compare.h"
#include "analysis/group/compare_groups.h"
#include "analysis/group/group.h"
#include "analysis/group/two_way_within.h"
#include "analysis/group/within_table.h"
#include "analysis/numerics/special_values.h"
#include "data/results/adaptive_results.h"
#include "data/results/rating_answers.h"
#include "data/results/study_analysis.h"
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
};

// One quantity compared over the conditions.
struct OutcomeComparison {
  std::string outcome;      // "slope", "jnd", "log_jnd", "trial_time", or a question's id
  std::string title;        // for people: "slope of d'", "time per trial", the question's text
  std::string unit;         // of the values; empty where they have none
  bool registered = false;  // the plan's own test; the others stand beside it
  bool question = false;    // a rating
  // Every participant gets every condition. Where groups get different ones, table has those who get them all, and what
  // is compared within or between groups is taken from everyone.
  bool crossed = true;
  std::vector<ParticipantValues> everyone;
  std::vector<std::string> participants;  // the rows of table, in order
  std::vector<LeftOut> left_out;          // who gets every condition and is not in it, and why
  WithinTable table;                      // participants x the protocol's conditions
  std::string refused;                    // why there is no test; empty where there is one
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
};

// The groups against each other, by the registered test.
struct GroupsCompared {
  std::string outcome, title, unit;  // as OutcomeComparison
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

std::string_view to_string(Outcome outcome) noexcept;   // "slope", "jnd", "log_jnd"
std::string_view to_string(BetweenTest test) noexcept;  // "none", "welch", "mann-whitney", "mixed-anova"
std::string_view to_string(PostHoc test) noexcept;      // "holm-t", "games-howell", "tukey", "wilcoxon"

// How much of a comparison is computed. contrasts: the pairs, each by the registered post-hoc test alone, which is what
// contrast_p() needs; for studies that are simulated by the thousand.
enum class Compared { everything, contrasts };

// Slopes of thresholds, by participant and condition. Tests on the slope leave out whose slope is not finite;
// those on the JND or its logarithm are refused where a participant has none (a mean over the rest would be biased).
OutcomeComparison compare_thresholds(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol,
                                     Outcome outcome, Compared compared = Compared::everything);
// Of an adaptive study; tests are refused where a participant has no threshold. rows: of adaptive_results.
OutcomeComparison compare_adaptive(const std::vector<AdaptiveRow>& rows, const Protocol& protocol,
                                   Compared compared = Compared::everything);
// The registered outcome of a task, by participant its mean over the standards.
OutcomeComparison compare_task(const TaskResults& results, const Protocol& protocol,
                               Compared compared = Compared::everything);
OutcomeComparison compare_times(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol);
// participants: those that the ratings were read for. groups: theirs; empty where there are none.
OutcomeComparison compare_ratings(const RatedQuestion& ratings, const std::vector<std::string>& participants,
                                  const Protocol& protocol, const std::vector<std::optional<int>>& groups = {});
SeriesComparison compare_series(const std::vector<CellResult>& cells, const Protocol& protocol);

// registered: the comparison of the registered outcome. Tests on slopes leave out who has none; those on every other
// outcome are refused where a participant has no value. Of a protocol with groups.
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
