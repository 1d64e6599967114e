// The binomial distribution as a table, and Walker's alias table: one random number a draw from any table.
#pragma once

#include <cstddef>
#include <cstdint>
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

}  // namespace jnd
