// The conditions of a study against each other: slopes or JNDs by the registered plan, times and ratings beside them.
#pragma once

#include <string>
#include <vector>

#include "analysis/group/compare.h"
#include "analysis/group/two_way_within.h"
#include "analysis/group/within_table.h"
#include "data/results/adaptive_results.h"
#include "data/results/rating_answers.h"
#include "data/results/study_analysis.h"
#include "data/task_results/task_results.h"
#include "protocols/protocol.h"

namespace jnd {

struct LeftOut {
  std::string participant, reason;
};

// One quantity compared over the conditions.
struct OutcomeComparison {
  std::string outcome;                    // "slope", "jnd", "log_jnd", "trial_time", or a question's id
  std::string title;                      // for people: "slope of d'", "time per trial", the question's text
  std::string unit;                       // of the values; empty where they have none
  bool registered = false;                // the plan's own test; the others stand beside it
  bool question = false;                  // a rating
  std::vector<std::string> participants;  // the rows of table, in order
  std::vector<LeftOut> left_out;          // who is not in it, and why
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

std::string_view to_string(Outcome outcome) noexcept;  // "slope", "jnd", "log_jnd"

// Slopes of thresholds[participant * conditions + condition]. Tests on the slope leave out whose slope is not finite;
// those on the JND or its logarithm are refused where a participant has none (a mean over the rest would be biased).
OutcomeComparison compare_thresholds(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol,
                                     Outcome outcome);
// Of an adaptive study; tests are refused where a participant has no threshold. rows: of adaptive_results.
OutcomeComparison compare_adaptive(const std::vector<AdaptiveRow>& rows, const Protocol& protocol);
// The registered outcome of a task, by participant its mean over the standards.
OutcomeComparison compare_task(const TaskResults& results, const Protocol& protocol);
OutcomeComparison compare_times(const std::vector<ThresholdResult>& thresholds, const Protocol& protocol);
// participants: one for each session that the ratings were read for.
OutcomeComparison compare_ratings(const RatedQuestion& ratings, const std::vector<std::string>& participants,
                                  const Protocol& protocol);
SeriesComparison compare_series(const std::vector<CellResult>& cells, const Protocol& protocol);

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
