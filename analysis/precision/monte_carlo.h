// Monte-Carlo of a whole study from its counts: every participant's cells are drawn, every JND is a least-squares line,
// and every experiment ends in the group means of its conditions, as in the paper. 18 participants x 3 conditions x 3
// series are 162 cells an experiment.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/precision/cell_distribution.h"
#include "analysis/thresholds/jnd.h"

namespace jnd {

// What one series adds to the least-squares slope sum(dK d') / sum(dK^2). A missing series adds nothing.
struct SeriesDraw {
  double product = 0;      // dK d'; infinite or NaN under Correction::none
  double square = 0;       // dK^2
  double variance = 0;     // dK^2 Var(d'), Gourevitch and Galanter; NaN where d' is not finite
  double informative = 0;  // 1, or 0 where every answer was the same
  SeriesDraw& operator+=(const SeriesDraw& other) noexcept {
    product += other.product;
    square += other.square;
    variance += other.variance;
    informative += other.informative;
    return *this;
  }
};

// Draws what comes out of one cell: its corrected d' as if its trials had been answered and counted.
// Immutable after construction: any thread may draw. Cells with at most kMostTabulated different counts are a table of
// all of them, one random number a draw; larger ones draw their class sizes, hits and false alarms, exactly as well.
class CellSampler {
 public:
  CellSampler(const CellProbabilities& cell, double difference);  // difference > 0

  SeriesDraw draw(ExperimentStream& stream) const noexcept {
    return counts_ ? from_counts(stream) : draws_[table_.draw(stream.next())];
  }

  static constexpr std::int64_t kMostTabulated = 50'000;

 private:
  // Binomial(n, p) for every n up to the cell's trials: the sum of draws for the powers of two that make up n.
  class Answers {
   public:
    Answers(int most, double p);
    int draw(int n, ExperimentStream& stream) const noexcept;

   private:
    struct Power {
      int first = 0;
      AliasTable table;
    };
    std::vector<Power> powers_;
  };
  struct Counts {
    CellProbabilities cell;
    double difference = 0;
    BinomialTable same;  // of random class sizes
    AliasTable same_table;
    Answers hits, false_alarms;
  };
  SeriesDraw from_counts(ExperimentStream& stream) const noexcept;

  AliasTable table_;
  std::vector<SeriesDraw> draws_;
  std::shared_ptr<const Counts> counts_;  // of large cells only
};

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
