// Monte-Carlo of a whole study from its counts: every participant's cells are drawn, every JND is a least-squares line,
// and every experiment ends in the group means of its conditions, as in the paper. 18 participants x 3 conditions x 3
// series are 162 cells an experiment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/precision/cell_sampler.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

struct StudyModel {
  CountsDesign design;
  std::vector<double> jnds;  // the true one of each condition, > 0, in the differences' unit
  int participants = 1;
  // Spread of the true JNDs: each participant's are the conditions' times one log-normal factor with median 1 and this
  // coefficient of variation, in 32 equally likely steps. 0: all participants have the same.
  double between_cv = 0;
};

// What came out of one condition of one experiment.
struct MeanJnd {
  double mean = 0;  // over status ok; NaN for n = 0
  int n = 0;        // status ok
  int no_sensitivity = 0, ceiling = 0, no_information = 0;
};

// Immutable after construction: any thread may simulate. Experiment i of a seed is the same in every thread and in any
// order.
class StudySimulator {
 public:
  explicit StudySimulator(StudyModel model);

  std::size_t conditions() const noexcept { return model_.jnds.size(); }
  std::size_t participants() const noexcept { return static_cast<std::size_t>(model_.participants); }
  // One experiment's slopes, d' per unit: slopes[condition * participants + participant]; NaN: no information. Of that
  // size.
  void slopes(std::uint64_t seed, std::uint64_t experiment, std::span<double> slopes) const noexcept;
  // One experiment's group means, one a condition.
  void means(std::uint64_t seed, std::uint64_t experiment, std::span<MeanJnd> means) const noexcept;
  // One participant's sums in one condition. stratum: of the spread between participants, 0 without one.
  SeriesDraw draw(std::size_t stratum, std::size_t condition, ExperimentStream& stream) const noexcept {
    const std::size_t series = model_.design.differences.size();
    const CellSampler* cell = &cells_[(stratum * conditions() + condition) * series];
    SeriesDraw sums = cell->draw(stream);
    for (std::size_t i = 1; i < series; ++i) sums += cell[i].draw(stream);
    return sums;
  }
  std::size_t strata() const noexcept { return strata_; }

 private:
  template <typename Call>
  void for_slopes(std::uint64_t seed, std::uint64_t experiment, Call call) const noexcept;

  StudyModel model_;
  std::size_t strata_ = 1;
  std::vector<CellSampler> cells_;  // by stratum, condition, series
};

// The status of a slope, by the rules of analysis/thresholds/jnd.h.
JndStatus status_of_slope(double slope) noexcept;

}  // namespace jnd
