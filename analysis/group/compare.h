// Everything that a paper reports about one value per participant and condition: descriptives, assumptions, the test
// over all conditions, and every pair.
//
// Source: science of each part in its own header. Cousineau 2005 with the correction of Morey 2008, Tutorials in
// Quantitative Methods for Psychology 4, 61-64, for the within-subject interval. Tests: R 4.2.2 with car and afex.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/group/post_hoc.h"
#include "analysis/group/rank_tests.h"
#include "analysis/group/repeated_measures.h"
#include "analysis/group/shapiro_wilk.h"
#include "analysis/group/within_table.h"
#include "analysis/numerics/statistic_status.h"

namespace jnd {

struct ConditionSummary {
  int n = 0;
  double mean = 0, sd = 0, median = 0;           // sd: n - 1 in the denominator
  double ci_low = 0, ci_high = 0;                // 95 %, Student t, of this condition alone
  double ci_within_low = 0, ci_within_high = 0;  // 95 %, Cousineau-Morey: for comparing conditions
  ShapiroWilk shapiro;
  StatisticStatus status = StatisticStatus::ok;  // else too_few (n < 2): sd and intervals are NaN
};

struct PairComparison {
  std::size_t a = 0, b = 0;    // columns of the table, a < b
  double mean_difference = 0;  // a - b
  PairedT t;
  double t_p_holm = 0, t_p_bh = 0, t_p_bonferroni = 0;  // over the pairs of this table; NaN where t.p is
  GamesHowell games_howell;
  Tukey tukey;
  SignedRank wilcoxon;
  double wilcoxon_p_holm = 0, wilcoxon_p_bh = 0;
};

struct Comparison {
  std::size_t n = 0, k = 0;
  std::vector<ConditionSummary> conditions;  // k
  ShapiroWilk residuals;                     // of the analysis of variance: the assumption that matters
  RepeatedMeasures anova;                    // with Mauchly, epsilons, effect sizes
  Friedman friedman;
  std::vector<PairComparison> pairs;  // (0,1), (0,2), ..., (1,2), ...: k (k - 1) / 2
  // else too_few (n < 2 or k < 2). Every part has a status of its own; what is undefined is NaN.
  StatisticStatus status = StatisticStatus::ok;
};

// table.k = 1..1000, table.n >= 0, here and below. The conditions alone:
std::vector<ConditionSummary> summaries_of(const WithinTable& table);
Comparison compare(const WithinTable& table);

// One test of every pair and nothing else, for studies that are simulated by the thousand: of the comparison n, k and the
// pairs, and of these the differences and that test, as compare() has them.
enum class PairTest { paired_t, games_howell, tukey, wilcoxon };
Comparison compare_pairs(const WithinTable& table, PairTest test);

}  // namespace jnd
