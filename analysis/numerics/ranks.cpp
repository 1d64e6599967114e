#include "analysis/numerics/ranks.h"

#include <cstddef>

#include "analysis/numerics/decimal_order.h"

namespace jnd {

Ranks midranks(std::span<const double> values) {
  return midranks_of_places(decimal_places(values));
}

Ranks midranks_of_places(std::span<const int> places) {
  std::vector<std::size_t> equal;  // how many values have each place
  for (const int place : places) {
    if (static_cast<std::size_t>(place) >= equal.size()) equal.resize(static_cast<std::size_t>(place) + 1, 0);
    ++equal[static_cast<std::size_t>(place)];
  }
  Ranks result;
  std::vector<double> rank_of;
  std::size_t before = 0;
  for (const std::size_t size : equal) {
    const auto ties = static_cast<double>(size);
    rank_of.push_back(static_cast<double>(before) + 0.5 * (ties + 1));  // mean of before + 1 .. before + size
    result.tie_sum += ties * (ties * ties - 1);
    before += size;
  }
  result.ranks.reserve(places.size());
  for (const int place : places) result.ranks.push_back(rank_of[static_cast<std::size_t>(place)]);
  return result;
}

}  // namespace jnd
