// One value for every participant under every condition: what all within-subject statistics start from.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace jnd {

// n participants x k conditions. values.size() == n * k, all finite (JNDs in N/m, times in s, ratings, ...).
struct WithinTable {
  std::size_t n = 0, k = 0;
  std::vector<double> values;  // row-major: participant i under condition j is values[i * k + j]

  double at(std::size_t i, std::size_t j) const { return values[i * k + j]; }
  std::span<const double> row(std::size_t i) const { return std::span<const double>(values).subspan(i * k, k); }
  std::vector<double> column(std::size_t j) const {
    std::vector<double> result(n);
    for (std::size_t i = 0; i < n; ++i) result[i] = at(i, j);
    return result;
  }
};

}  // namespace jnd
