#include "analysis/ranks.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace jnd {

Ranks midranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  Ranks result;
  result.ranks.resize(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    const auto equal = static_cast<double>(end - first);
    const double rank = 0.5 * static_cast<double>(first + 1 + end);  // mean of first + 1 .. end
    for (std::size_t place = first; place < end; ++place) result.ranks[order[place]] = rank;
    result.tie_sum += equal * (equal * equal - 1);
    first = end;
  }
  return result;
}

}  // namespace jnd
