// Binomial draws by inversion: one uniform number a draw, so that a seed gives the same counts everywhere.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace jnd {

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

}  // namespace jnd
