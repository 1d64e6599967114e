// The exact distribution of the least-squares JND of one participant and condition: every combination of what its
// series can give (analysis/precision/cell_distribution.h), nothing drawn. Undefined outcomes are counted by their
// status.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/precision/cell_distribution.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

// How often each status of a JND occurs. Together 1.
struct JndStatusShares {
  double ok = 0, no_sensitivity = 0, ceiling = 0, no_information = 0;
};

class SlopeDistribution {
 public:
  // A cell for each difference (> 0); feasible().
  SlopeDistribution(std::span<const CellDistribution> cells, std::span<const double> differences);

  const JndStatusShares& status() const noexcept { return status_; }
  // The JND below which that share of the estimates lie, 0 < share < 1, among those with information: `ceiling` counts
  // as 0, `no_sensitivity` as +inf, as in the group's median. NaN where no estimate has information.
  double jnd_quantile(double share) const;
  // P(low <= JND <= high), of all; 0 < low < high.
  double jnd_within(double low, double high) const;
  double mean_jnd() const;  // over status ok; NaN where there is none

  // How many sums of d' the constructor's cells have, and whether they are few enough: 3e7 in all, 5e5 without the
  // largest cell (those are written down), and no more than 8 series where classes may be empty.
  static double combinations(std::span<const CellDistribution> cells) noexcept;
  static bool feasible(std::span<const CellDistribution> cells) noexcept;

 private:
  struct Atom {
    double value = 0;
    double probability = 0;  // of this value
    double tail = 0;         // of this value or more
  };
  // The sums head + last, each times `scale` a slope; counted with `sign`.
  struct Part {
    double sign = 1;
    double scale = 1;
    std::vector<Atom> head, last;
  };

  void add_part(std::span<const CellDistribution> cells, std::span<const double> differences, std::uint64_t present,
                bool informative);
  double slope_at_least(double slope) const;  // finite ones; beyond rounding
  double steepest() const noexcept;

  JndStatusShares status_;
  std::vector<Part> parts_;
};

}  // namespace jnd
