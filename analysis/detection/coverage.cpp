#include "analysis/detection/coverage.h"

#include "analysis/detection/differencing.h"
#include "analysis/detection/dprime_intervals.h"
#include "analysis/numerics/binomial.h"
#include "analysis/numerics/normal.h"

namespace jnd {

namespace {

// Sum of the probabilities of all outcomes; visit(hits, false alarms, probability).
template <typename Visit>
void all_outcomes(int n, double dprime, double criterion, Visit&& visit) {
  const BinomialTable hits = binomial_table(n, normal_cdf(0.5 * dprime - criterion));
  const BinomialTable alarms = binomial_table(n, normal_cdf(-0.5 * dprime - criterion));
  for (std::size_t h = 0; h < hits.probability.size(); ++h)
    for (std::size_t f = 0; f < alarms.probability.size(); ++f)
      visit(hits.first + static_cast<int>(h), alarms.first + static_cast<int>(f),
            hits.probability[h] * alarms.probability[f]);
}

}  // namespace

ProfileCoverage::ProfileCoverage(int trials_a_class) : n_(trials_a_class) {
  for (int hits = 0; hits <= n_; ++hits)
    for (int alarms = 0; alarms <= n_; ++alarms) {
      const DprimeProfile profile = yes_no_profile({n_, hits, n_, alarms});
      intervals_.push_back({profile.ci_low, profile.ci_high});
    }
}

double ProfileCoverage::at(double dprime, double criterion) const {
  double covered = 0;
  all_outcomes(n_, dprime, criterion, [&](int hits, int alarms, double probability) {
    const Interval& interval = intervals_[static_cast<std::size_t>(hits) * (static_cast<std::size_t>(n_) + 1) +
                                          static_cast<std::size_t>(alarms)];
    if (interval.low <= dprime && dprime <= interval.high) covered += probability;
  });
  return covered;
}

TestSizes test_sizes(int trials_a_class, double criterion) {
  TestSizes sizes{0, 0, 0, 0};
  all_outcomes(trials_a_class, 0, criterion, [&](int hits, int alarms, double probability) {
    const Counts counts{trials_a_class, hits, trials_a_class, alarms};
    const double yes_no = yes_no_p_value(counts), differencing = differencing_p_value(counts);
    if (yes_no <= 0.05) sizes.yes_no_05 += probability;
    if (yes_no <= 0.01) sizes.yes_no_01 += probability;
    if (differencing <= 0.05) sizes.differencing_05 += probability;
    if (differencing <= 0.01) sizes.differencing_01 += probability;
  });
  return sizes;
}

}  // namespace jnd
