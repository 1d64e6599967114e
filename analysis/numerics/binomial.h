// The binomial distribution: as a table, drawn from, and the exact interval of a proportion. And Walker's alias table: one
// random number a draw from any table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace jnd {

// P(K = first + i) of n trials with probability p. What is below 1e-30 of the largest probability is left out; the
// rest adds up to 1.
struct BinomialTable {
  int first = 0;
  std::vector<double> probability;
};
BinomialTable binomial_table(int n, double p);  // n >= 0; p in 0..1

// Draws an index with given probabilities. Walker 1977 (ACM Trans Math Softw 3:253), set up as in Vose 1991 (IEEE Trans
// Softw Eng 17:972). Immutable after construction: any thread may draw.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(std::span<const double> probability);  // not empty, >= 0, of any positive sum

  // bits: uniform over all 64-bit values. Its product with the number of slots is a slot (upper half) and a uniform
  // fraction within it (lower half).
  std::size_t draw(std::uint64_t bits) const noexcept {
    const Wide product = static_cast<Wide>(bits) * slots_.size();
    const auto place = static_cast<std::size_t>(product >> 64U);
    const Slot& slot = slots_[place];
    return static_cast<std::uint64_t>(product) < slot.keep ? place : slot.alias;
  }
  std::size_t size() const noexcept { return slots_.size(); }

 private:
  __extension__ using Wide = unsigned __int128;
  struct Slot {
    std::uint64_t keep = 0;  // below it the slot itself, in units of 2^-64
    std::size_t alias = 0;
  };
  std::vector<Slot> slots_;
};

// Binomial draws by inversion: one uniform number a draw, so that a seed gives the same counts everywhere.
class BinomialSampler {
 public:
  BinomialSampler(int n, double p);  // n >= 0, 0 <= p <= 1

  // The count at which the distribution function passes u, 0 < u < 1.
  int at(double u) const noexcept;

 private:
  int first_ = 0;
  std::vector<double> cumulative_;  // P(count <= first_ + i), from where a probability exceeds 1e-20 of the largest
};

// Uniform in the open interval (0, 1) from the generator's upper 53 bits; the standard's own distributions differ
// between libraries.
double open_uniform(std::mt19937_64& generator);
double open_uniform(std::uint64_t bits);  // the same of 64 random bits

// A proportion with the exact binomial interval of Clopper and Pearson.
//
// Source: Clopper and Pearson 1934, Biometrika 26, 404-413; its bounds as quantiles of the beta distribution, by
// Boost.Math's inverse of the incomplete beta function. Accuracy: 1e-12. Tests: closed forms at k = 0 and k = n,
// R 4.2.2 (binom.test).
struct ExactProportion {
  int k = 0, n = 0;
  double share = 0;                // k / n; NaN for n = 0
  double ci_low = 0, ci_high = 0;  // covers at least `confidence`; 0 .. 1 for n = 0
};
ExactProportion exact_proportion(int k, int n, double confidence = 0.95);  // 0 <= k <= n; confidence in 0..1

// Two-sided exact p of k of n against the rate p, 0 < p < 1: twice the smaller tail, so that it is below .05 just where p lies
// outside the interval above. (binom.test of R adds up the outcomes that are no likelier, and its p and interval can disagree.)
// 1 for n = 0.
double binomial_exact_p(int k, int n, double p);

}  // namespace jnd
