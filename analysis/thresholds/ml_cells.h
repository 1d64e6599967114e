// The cells of a joint likelihood: how often "different" was said at each difference, in groups that share a criterion.
#pragma once

#include <span>
#include <vector>

#include "analysis/thresholds/jnd.h"

namespace jnd {

struct MlCell {
  double x = 0;     // difference, N/m; 0: equal stimuli
  double n = 0;     // trials, > 0
  double said = 0;  // of them answered "different"
  double unsaid() const noexcept { return n - said; }
};

struct MlGroup {
  std::vector<MlCell> cells;  // x ascending, each once

  bool all_alike = false;  // one and the same answer throughout: fits every slope perfectly (criterion at infinity)
  // Every "different" was said at differences as large as every "same", or larger: the likelihood grows with m for
  // ever. falls: the other way round. Never both, and neither where all_alike.
  bool rises = false, falls = false;

  // sum of k log(k/n) + (n-k) log(1 - k/n): what no model exceeds, and what a separated group attains at infinity.
  double saturated = 0;
};

// common: one group of all cells; otherwise a group a series, in the order of the series.
std::vector<MlGroup> ml_groups(std::span<const SeriesCounts> series, bool common);

enum class MlMaximum { finite, at_plus_infinity, at_minus_infinity, anywhere };
// Where the likelihood of a model with d' = m x has its maximum. For the yes-no model; with m >= 0, falling groups have
// their maximum at m = 0, which is finite.
MlMaximum ml_maximum(std::span<const MlGroup> groups) noexcept;

// Sum of `saturated` over the groups: the limit of the log-likelihood at infinity where all of them are separated
// alike.
double saturated_log_likelihood(std::span<const MlGroup> groups) noexcept;

}  // namespace jnd
