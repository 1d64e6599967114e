// Draws what comes out of one cell: its corrected d' as if its trials had been answered and counted.
#pragma once

#include <memory>
#include <vector>

#include "analysis/numerics/binomial.h"
#include "analysis/numerics/experiment_stream.h"
#include "analysis/precision/cell_distribution.h"

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

}  // namespace jnd
