// Where the points of a column go, so that every one can be seen.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "runner/figures/figure_conditions.h"

namespace jnd {

namespace {

constexpr std::size_t kMostCompared = 2000;  // points a column; the search is quadratic

// Spread evenly over -1..1 whatever the number of points.
double golden_offset(std::size_t index) {
  const double share = std::fmod(0.5 + static_cast<double>(index) * 0.618033988749895, 1.0);
  return 2 * share - 1;
}

}  // namespace

std::vector<double> swarm_offsets(const std::vector<double>& heights, double radius, double half_width) {
  std::vector<std::size_t> order(heights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return heights[a] < heights[b]; });
  std::vector<double> offsets(heights.size(), 0);
  const double apart = 2 * radius + 0.6, step = radius / 2;
  for (std::size_t place = 0; place < order.size(); ++place) {
    const std::size_t here = order[place];
    const auto is_free = [&](double offset) {
      for (std::size_t back = place; back-- > 0;) {
        const std::size_t other = order[back];
        const double down = heights[here] - heights[other];
        if (down >= apart) return true;
        if (std::hypot(down, offset - offsets[other]) < apart) return false;
      }
      return true;
    };
    bool placed = false;
    if (heights.size() <= kMostCompared)
      for (int tried = 0; !placed; ++tried) {
        // Alternately to the right and to the left, the first side alternating too.
        const int steps = (tried + 1) / 2;
        const double out = step * steps;
        if (out > half_width) break;
        const double offset = (tried % 2 == 0) == (place % 2 == 0) ? out : -out;
        if (!is_free(offset)) continue;
        offsets[here] = offset;
        placed = true;
      }
    if (!placed) offsets[here] = half_width * golden_offset(place);
  }
  return offsets;
}

}  // namespace jnd
