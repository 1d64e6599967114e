// Items answered for each condition, tested in pairs; and the interval of a median.
//
// Source: Wilcoxon 1945 with midranks and exact permutation p (rank_tests.h); Holm and Benjamini-Hochberg over the
// family (p_adjust.h); Conover 1999, section 3.2, for the distribution-free interval of a median.
// Accuracy: rank_tests.h; coverage 1e-14. Tests: R 4.2.2 (wilcox.test), exactRankTests, binomial tables.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/group/rank_tests.h"
#include "analysis/group/within_table.h"
#include "analysis/numerics/statistic_status.h"

namespace jnd {

// The median with an interval between two order statistics, x(r) .. x(n + 1 - r). Right whatever the distribution;
// with ties, as in ratings, the interval covers at least this often.
struct MedianInterval {
  int n = 0;
  double median = 0;
  double ci_low = 0, ci_high = 0;  // the narrowest such interval that covers at least `confidence`
  double coverage = 0;             // how often it covers: 1 - 2 P(Binomial(n, 1/2) < r)
  // else too_few: n = 0 (all NaN), or min .. max covers less than asked (n < 6 at 95 %): it stands, with its coverage
  StatisticStatus status = StatisticStatus::ok;
};
MedianInterval median_interval(std::span<const double> values, double confidence = 0.95);

// An item that every participant answered after each condition: n x k ratings, NaN where an answer is missing.
struct PairedItem {
  std::string id;
  WithinTable ratings;
};

struct ItemPair {
  std::size_t a = 0, b = 0;      // conditions, a < b
  SignedRank test;               // a - b, over the participants who answered both
  double median_difference = 0;  // of a - b; NaN without a complete pair
  double p = 0;                 // what enters the family: exact permutation p, or the normal one beyond 200 differences
  bool exact = false;           // which
  double p_holm = 0, p_bh = 0;  // over all pairs of all items; NaN where p is
};

struct PairedItemResult {
  std::string id;
  std::vector<MedianInterval> conditions;  // k, each over those who answered it
  Friedman friedman;                       // over complete participants; not_applicable for k = 2
  std::vector<ItemPair> pairs;             // (0,1), (0,2), ..., (1,2), ...
};

struct PairedQuestionnaire {
  std::vector<PairedItemResult> items;
  std::size_t family = 0;  // tests that Holm and Benjamini-Hochberg count: those with a p
};
PairedQuestionnaire paired_questionnaire(std::span<const PairedItem> items);

}  // namespace jnd
